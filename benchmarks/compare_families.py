"""Whether two versions of this project state the same claims and draw the same data from the same numbers.

python benchmarks/compare_families.py record <folder> <tests>...
    keeps the made-up data sets that these tests of families judge and draw
python benchmarks/compare_families.py compare <before> <after> <data>... [--measure <project>]
    before, after: folders of the two versions; data: folders of data sets, which were recorded so, or are
    results/measurements of a reproduction; figures can be chosen by --figures. With --measure, figures of the
    config (of each version, config/config.yaml by default, or config/smoke.yaml) are measured again, from the
    points kept in <project>/results/points, where all of them are there.

It prints every difference beyond 1e-9 of a number, and how many arrays differ in their last bits; exit code 1
if there is a difference.
"""

from __future__ import annotations

import argparse
import os
import pickle
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import fields, is_dataclass
from functools import wraps
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

PARTS = ("claims", "figure")
TOLERANCE = 1e-9
_FRAME = ("Spine", "XAxis", "YAxis")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    recording = commands.add_parser("record")
    recording.add_argument("folder", type=Path)
    recording.add_argument("tests", nargs="+")
    for name in ("compare", "state"):
        comparing = commands.add_parser(name)
        if name == "compare":
            comparing.add_argument("before", type=Path)
            comparing.add_argument("after", type=Path)
        else:  # what one version makes of the data, in its own process
            comparing.add_argument("out", type=Path)
        comparing.add_argument("data", nargs="*", type=Path)
        comparing.add_argument("--figures", nargs="+", default=[])
        comparing.add_argument("--measure", type=Path)
        comparing.add_argument("--config", default="config/config.yaml")
    options = parser.parse_args()
    return {"record": _record, "compare": _compare, "state": _state}[options.command](options)


def _record(options: argparse.Namespace) -> int:
    import pytest

    from gaspart.reproduction.families import registry

    folder = options.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    for family in registry.titles():
        package = import_module(f"gaspart.reproduction.families.{family}")
        names = [*package.FIGURES, *getattr(package, "KINDS", {})]
        for part in PARTS:
            module = import_module(registry.module(family, part))
            for name in filter(lambda name: hasattr(module, name), names):
                setattr(module, name, _recording(getattr(module, name), folder, family, name))
    return int(pytest.main(["-q", "-n", "0", "-p", "no:cacheprovider", *options.tests]))


def _recording(function: Any, folder: Path, family: str, name: str) -> Any:
    @wraps(function)
    def recorded(*arguments: Any) -> Any:
        number = len(list(folder.glob(f"{name}-*.pickle")))
        stored = (family, name, list(deepcopy(arguments)))
        (folder / f"{name}-{number:03}.pickle").write_bytes(pickle.dumps(stored))
        return function(*arguments)

    return recorded


def _compare(options: argparse.Namespace) -> int:
    stated = []
    for tree in (options.before, options.after):
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "stated.pickle"
            command = [sys.executable, __file__, "state", str(out), *map(str, _absolute(options.data))]
            if options.measure:
                command += ["--measure", str(options.measure.resolve())]
            if options.figures:
                command += ["--figures", *options.figures]
            command += ["--config", options.config]
            paths = os.pathsep.join([str(tree.resolve() / "src")])
            subprocess.run(
                command, cwd=tree, check=True, env={**os.environ, "PYTHONPATH": paths, "OMP_NUM_THREADS": "1"}
            )
            stated.append(pickle.loads(out.read_bytes()))
    before, after = stated
    faults = bits = 0
    for name in dict.fromkeys([*before, *after]):
        found, last = _differences(before.get(name), after.get(name))
        faults, bits = faults + len(found), bits + last
        for line in found[:12]:
            print(f"{name}: {line}")
        if len(found) > 12:
            print(f"{name}: and {len(found) - 12} more")
    for name in (name for name, one in before.items() if isinstance(one, Exception)):
        print(f"{name}: not compared, fails before: {before[name]}")
    print(f"{len(before)} results, {faults} differences, {bits} arrays differ within {TOLERANCE:g}")
    return int(faults > 0)


def _absolute(paths: list[Path]) -> list[Path]:
    return [path.resolve() for path in paths]


def _differences(before: Any, after: Any) -> tuple[list[str], int]:
    """Lines about numbers and words that differ, and the number of arrays that do in their last bits."""
    if isinstance(before, Exception) or before is None:
        same = type(before) is type(after)
        return ([] if same else [f"before: {before!r}; now {'it works' if after else after!r}"]), 0
    if isinstance(after, Exception) or after is None:
        return [f"now: {after!r}\n{getattr(after, 'where', '')}"], 0
    old, new = dict(_flat("", before)), dict(_flat("", after))
    lines = [f"{key}: not before: {_short(new[key])}" for key in new if key not in old]
    lines += [f"{key}: no more: {_short(old[key])}" for key in old if key not in new]
    bits = 0
    for key in (key for key in old if key in new):
        if not _close(old[key], new[key]):
            lines.append(f"{key}: {_short(old[key])} -> {_short(new[key])}")
        elif not _same(old[key], new[key]):
            bits += 1
    return lines, bits


def _flat(where: str, value: Any) -> Iterator[tuple[str, np.ndarray]]:
    nested = (dict, list, tuple, np.ndarray)
    if isinstance(value, dict):
        for key, part in value.items():
            yield from _flat(f"{where}.{key}", part)
    elif isinstance(value, (list, tuple)) and any(isinstance(part, nested) for part in value):
        yield f"{where}.length", np.asarray(len(value))
        for number, part in enumerate(value):
            yield from _flat(f"{where}[{number}]", part)
    else:
        yield where, np.asarray(value)


def _close(before: np.ndarray, after: np.ndarray) -> bool:
    if before.shape != after.shape or (before.dtype.kind in "fiub") != (after.dtype.kind in "fiub"):
        return False
    if before.dtype.kind not in "fiub":
        return bool(np.all(before == after))
    known = np.abs(before[np.isfinite(before)])
    least = 1e-14 * float(known.max()) if known.size else 0.0  # where a difference of large numbers is 0
    return bool(np.allclose(after, before, rtol=TOLERANCE, atol=least, equal_nan=True))


def _same(before: np.ndarray, after: np.ndarray) -> bool:
    return np.array_equal(before, after, equal_nan=before.dtype.kind in "fiub")


def _short(value: np.ndarray) -> str:
    text = np.array2string(value, threshold=6, precision=12).replace("\n", " ")
    return text if len(text) < 160 else f"{text[:160]} ..."


def _state(options: argparse.Namespace) -> int:
    """Write what this version makes of the data: by name, claims, drawn data, and measurements."""
    import gaspart

    assert Path(gaspart.__file__).is_relative_to(Path.cwd()), gaspart.__file__
    stated: dict[str, Any] = {}
    config = _config(options.config)
    for name, family, function, arguments in _data(options.data, options.figures, config):
        for part, describe in zip(PARTS, (_claims, _drawn), strict=True):
            given = arguments if part == "claims" else arguments[:1]
            stated[f"{name} {part}"] = _result(describe, family, part, function, given)
    if options.measure:
        stated |= _measured(options.measure, options.figures, config)
    options.out.write_bytes(pickle.dumps(stated))
    return 0


def _result(describe: Any, family: str, part: str, function: str, arguments: list) -> Any:
    from gaspart.reproduction.families import registry

    try:
        made = getattr(import_module(registry.module(family, part)), function)
        return describe(made, *deepcopy(arguments))
    except Exception as error:
        failure = RuntimeError(f"{type(error).__name__}: {error}")
        failure.where = traceback.format_exc()  # type: ignore[attr-defined]
        return failure


def _config(path: str) -> dict:
    from gaspart.reproduction.config_files import merged_with_default, read_numbers

    config, files = merged_with_default(Path(path))
    read_numbers(config, files)
    return config


def _data(folders: list[Path], figures: list[str], config: dict) -> Iterator[tuple[str, str, str, list]]:
    """(name, family, function, arguments) of each data set."""
    import xarray as xr

    from gaspart.reproduction.families import registry

    for folder in folders:
        for path in sorted(folder.glob("*.pickle")):
            family, function, arguments = pickle.loads(path.read_bytes())
            if not figures or function in figures:
                yield f"{folder.name}/{path.stem}", family, function, arguments
        for path in sorted(folder.glob("*.nc")):
            if figures and path.stem not in figures:
                continue
            block = config["figures"][path.stem]
            family, function = registry.functions(path.stem, block)
            stated = [block.get("claims", [])] if "kind" in block else []
            yield f"{folder.name}/{path.stem}", family, function, [xr.load_dataset(path), *stated]


def _measured(project: Path, figures: list[str], config: dict) -> dict[str, Any]:
    from gaspart.reproduction.families import registry
    from gaspart.reproduction.points.points import all_points, figure_points

    planned, stated, tree = all_points(config), {}, Path.cwd()
    for figure, block in config["figures"].items():
        family, function = registry.functions(figure, block)
        points = [] if figure in registry.of_claims() else figure_points(config, figure, planned)
        there = [(project / point.path).exists() for point in points]
        if (figures and figure not in figures) or not points or not all(there):
            continue
        settings = {key: block[key] for key in block if key not in ("claims", "caption", "experiments")}
        os.chdir(project)
        stated[f"measured/{figure}"] = _result(_variables, family, "measure", function, [points, settings])
        os.chdir(tree)
    return stated


def _variables(measure: Any, points: list, settings: dict) -> dict:
    dataset = measure(points, settings)
    columns = {
        name: {
            "over": " ".join(map(str, one.dims)),
            "units": one.attrs.get("units", ""),
            "values": one.values,
        }
        for name, one in dataset.variables.items()
    }
    return {"columns": columns, "attributes": {key: str(value) for key, value in dataset.attrs.items()}}


def _claims(function: Any, *arguments: Any) -> list[dict]:
    return [_fields(claim) for claim in function(*arguments)]


def _fields(one: Any) -> dict[str, Any]:
    values = {field.name: getattr(one, field.name) for field in fields(one)}
    return {key: _fields(value) if is_dataclass(value) else _worded(value) for key, value in values.items()}


def _worded(value: Any) -> Any:
    return "None" if value is None else value


def _drawn(function: Any, *arguments: Any) -> dict:
    from gaspart.rendering import style

    with style.applied("page"):
        figure = function(*arguments)
        panels = [_panel(axis) for axis in figure.axes]
        others = [_artist(one) for one in [*figure.texts, *figure.legends, *figure.lines, *figure.patches]]
        return {"size": figure.get_size_inches(), "panels": panels, "others": others}


def _panel(axis: Any) -> dict:
    described = {
        name: getattr(axis, f"get_{name}")()
        for name in ("xlabel", "ylabel", "xscale", "yscale", "xlim", "ylim", "xticks", "yticks")
    }
    described |= {
        name: [label.get_text() for label in getattr(axis, f"get_{name}")()]
        for name in ("xticklabels", "yticklabels")
    }
    frame = [axis.patch, *axis.child_axes]
    artists = [
        _artist(one)
        for one in axis.get_children()
        if type(one).__name__ not in _FRAME and not any(one is part for part in frame)
    ]
    insets = [_panel(inset) for inset in axis.child_axes]
    return {**described, "place": axis.get_position().bounds, "artists": artists, "insets": insets}


def _artist(one: Any) -> dict:
    """What can be seen of a line, a collection, a patch, a text, an image or a legend."""
    from matplotlib.colors import to_rgba

    kind = type(one).__name__
    described = {"kind": kind, "label": str(one.get_label()), "zorder": one.get_zorder()}
    described["visible"] = one.get_visible()
    if kind == "Legend":
        looks = [_artist(handle) for handle in one.legend_handles if handle is not None]
        texts = [text.get_text() for text in one.get_texts()]
        return {**described, "texts": texts, "columns": one._ncols, "loc": str(one._loc), "looks": looks}
    if hasattr(one, "get_xdata"):
        x, y = (np.asarray(values(), dtype=float) for values in (one.get_xdata, one.get_ydata))
        names = ("color", "markerfacecolor", "markeredgecolor")
        look = {name: to_rgba(getattr(one, f"get_{name}")()) for name in names}
        look |= {name: str(getattr(one, f"get_{name}")()) for name in ("marker", "linestyle", "linewidth")}
        return {**described, "x": x, "y": y, **look, "markersize": one.get_markersize()}
    if hasattr(one, "get_text"):
        place = {"place": one.get_position(), "color": to_rgba(one.get_color()), "xy": getattr(one, "xy", "")}
        return {**described, "text": one.get_text(), **place, "ha": one.get_ha(), "va": one.get_va()}
    if hasattr(one, "get_offsets"):
        paths = {str(n): path.vertices for n, path in enumerate(one.get_paths())}
        look = {name: getattr(one, f"get_{name}")() for name in ("facecolor", "edgecolor", "linewidth")}
        values = np.ma.filled(one.get_array(), np.nan) if one.get_array() is not None else "None"
        return {
            **described,
            "paths": paths,
            "offsets": np.asarray(one.get_offsets()),
            "values": values,
            **look,
        }
    if hasattr(one, "get_path"):
        vertices = one.get_patch_transform().transform(one.get_path().vertices)
        return {**described, "vertices": vertices, "face": one.get_facecolor(), "edge": one.get_edgecolor()}
    if hasattr(one, "get_extent"):
        values = np.ma.filled(np.ma.asarray(one.get_array(), dtype=float), np.nan)
        return {**described, "values": values, "extent": one.get_extent()}
    return described


if __name__ == "__main__":
    sys.exit(main())
