"""`gaspart measure`: observables of a trajectory, with uncertainties and theory."""

from __future__ import annotations

import argparse
import io
import json
import os
from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from gaspart.analysis.measuring import measure
from gaspart.analysis.observable import remark_of
from gaspart.analysis.observables import ALIASES, OBSERVABLES, observable_name, selecting, selections
from gaspart.analysis.run import until_time
from gaspart.analysis.run_data import ABOUT
from gaspart.cli.arguments import (
    Parser,
    UsageError,
    add_trajectory,
    list_names,
    print_line,
    real,
    set_command,
    several,
)
from gaspart.cli.progress import waiting
from gaspart.engines import engine_from_dict
from gaspart.errors import SceneError
from gaspart.files import FileKind, begins_with, output_path, writing
from gaspart.scene.scene import Scene
from gaspart.yaml_text import parse_yaml

if TYPE_CHECKING:
    from gaspart.analysis.observable import Observable

_FIELD = "field"
"""Word on the command line that requests a field (a property in cells) instead of an observable."""
_SEEDS = "seeds"
"""Attribute that contains the remark about the energy of a single run."""
_ROWS = 12  # maximum number of printed points of a curve
_TITLE = "# gaspart measure"
_TABLE = FileKind("a table written by gaspart measure", begins_with(_TITLE.encode()))
_EXAMPLES = """examples:
  gaspart measure run.nc Z msd
  gaspart measure run.nc vacf -o vacf.png
  gaspart measure run.nc msd -o msd.csv --start 10
  gaspart measure run-1.nc run-2.nc run-3.nc D   # replicas: mean and scatter
  gaspart measure run.nc D          # the same, of a run with --replicas
  gaspart measure run.nc D --per-axis
  gaspart measure run.nc D --particles 0 --lag 2    # of one tracer, at a lag
  gaspart measure run.nc density --axis x
  gaspart measure run.nc velocity --axis x --species 0 --start 10 --end 20
  gaspart measure run.nc field --of temperature --axes xz -o field.png"""


def add_measure(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = "Observables of a trajectory. Uncertainties are one standard deviation; of curves a few rows are "
    text += "printed. Several files are runs of one scene with other seeds or initial states: their mean and "
    text += "scatter are given."
    set_command(parser, _measure, text, _EXAMPLES)
    meanings = {name: observable.listed for name, observable in OBSERVABLES.items()}
    meanings[_FIELD] = "density, flow or temperature in cells along some axes"
    parser.description = f"{parser.description}\n\nobservables:\n{list_names(meanings)}"
    add = parser.add_argument
    add_trajectory(parser)
    words = (*OBSERVABLES, _FIELD)
    add("words", nargs="+", choices=_Words(words), metavar="NAME", help="one of the observables above")
    text = "time from which frames count; default: a quarter of the run"
    add("--start", type=real(least=0.0), metavar="T", help=text)
    add("--end", type=real(least=0.0), metavar="T", help="time until which frames count; default: the end")
    text = "of one species only, by its number in the scene, from 0 (single particles: after the last): "
    add("--species", type=int, metavar="N", help=text + ", ".join(selecting("species")))
    text = "of these particles only, by their numbers in the file, from 0: "
    names = ", ".join(selecting("particles"))
    add("--particles", type=several(int), metavar="N[,N...]", help=text + names)
    text = "along each axis instead of their sum or mean: "
    add("--per-axis", action="store_true", default=None, help=text + ", ".join(selecting("per_axis")))
    text = "along this axis instead of the last one: "
    add("--axis", choices=("x", "y", "z"), help=text + ", ".join(selecting("axis")))
    text = "of a field: density, velocity or temperature"
    add("--of", metavar="WHAT", help=f"{text}; default: density")
    add("--axes", metavar="AXES", help="of the cells of a field, such as xz; default: xy")
    text = "number of cells of a field along each of its axes; default: 20"
    add("--cells", type=several(int), metavar="N[,N...]", help=text)
    text = "through the plane at this place, by default in the middle: "
    add("--at", type=real(), metavar="X", help=text + ", ".join(selecting("at")))
    text = "about the local flow of the gas, by default, or about rest: "
    add("--about", choices=ABOUT, help=text + ", ".join(selecting("about")))
    text = "at or until this lag, a time: "
    add("--lag", type=real(), metavar="T", help=text + ", ".join(selecting("lag")))
    add("-o", "--output", metavar="FILE", help="all rows of one observable as .csv, or a plot as .png")
    add("--force", action="store_true", help="replace a table or a picture")
    usage = parser.format_usage().partition(": ")[2]
    parser.usage = usage.replace("FILE NAME", "FILE [FILE ...] NAME").strip()


class _Words(tuple):
    """Names of observables as completions for a shell; names of files are accepted, too."""

    def __contains__(self, argument: object) -> bool:
        return super().__contains__(argument) or argument in ALIASES or _is_file(str(argument))


def _is_file(argument: str) -> bool:
    """Return True if a word with a suffix or a folder names a file. Names of observables have neither a
    suffix nor a folder.
    """
    return "." in argument or os.sep in argument


def _split_words(options: argparse.Namespace) -> tuple[list[str], list[str]]:
    """Return the files and the names of observables of a command line. Files must precede the names. Raises
    UsageError.
    """
    names = list(options.words)
    files = [options.trajectory]
    while names and _is_file(names[0]):
        files.append(names.pop(0))
    if not names:
        raise UsageError(
            f"NAME is missing after the files: one or more of {', '.join((*OBSERVABLES, _FIELD))}"
        )
    if late := [argument for argument in names if _is_file(argument)]:
        raise UsageError(f"{late[0]!r}: files stand before the names of observables")
    return files, [name if name == _FIELD else observable_name(name) for name in names]


def _measure(options: argparse.Namespace) -> None:
    from gaspart.trajectory.replicas import run_files

    stated, names = _split_words(options)
    files = [file for name in stated for file in run_files(name)]
    write = _writer(options, names)
    selected = {key: getattr(options, key) for key in selections()}
    selection = {key: value for key, value in selected.items() if value is not None}
    remarks: set[str] = set()
    for name, observable in _measure_each(
        files, names, (options.start, options.end), selection, _field_of(options)
    ):
        if name == _FIELD:
            _print_field(observable)
        elif observable.estimate.ndim:
            _print_curve(name, observable)
        else:
            _print_scalar(name, observable)
        for note in (observable.attrs[key] for key in ("note", _SEEDS) if key in observable.attrs):
            print_line(f"({note})")
        if (remark := remark_of(observable)) and remark not in remarks:
            print_line(remark)
        remarks.add(remark)
        write(observable)
    for remark in _of_engine(files[0]):
        print_line(f"({remark})")


def _field_of(options: argparse.Namespace) -> dict[str, Any]:
    """Return the arguments of a field. Raises UsageError for arguments without a field."""
    stated = {
        key: getattr(options, key) for key in ("of", "axes", "cells") if getattr(options, key) is not None
    }
    if stated and _FIELD not in options.words:
        raise UsageError(f"--{next(iter(stated))} is defined only for {_FIELD}")
    if len(stated.get("cells", [])) == 1:
        (stated["cells"],) = stated["cells"]
    return stated


def _measure_each(
    files: list[str],
    names: list[str],
    times: tuple[float | None, float | None],
    selection: dict[str, Any],
    field: dict[str, Any],
) -> Iterator[tuple[str, Observable]]:
    """Measure each observable in one file, or as the mean over several files. `times`: start and end of the
    time interval whose frames are used. `field`: arguments of `gaspart.analysis.field`.
    """
    from gaspart.analysis.combination import replicas
    from gaspart.trajectory.reading import open_trajectory

    if len(files) > 1:
        if _FIELD in names:
            raise UsageError(f"{_FIELD}: requires one file; give one file at a time")
        for name in names:
            with waiting(f"measuring {name} of {len(files)} files"):
                observable = replicas(name, files, *times, **selection)
            yield name, observable
        return
    with open_trajectory(files[0]) as trajectory:
        for name in names:
            with waiting(f"measuring {name}"):
                if name == _FIELD:
                    observable = _measure_field(trajectory, times, selection | field)
                else:
                    observable = measure(trajectory, name, *times, **selection)
                    observable.attrs |= _of_seeds(trajectory, name)
            yield name, observable


def _of_engine(file: str) -> list[str]:
    """Return remarks about notable errors of the engine of a run."""
    from gaspart.trajectory.reading import open_trajectory

    with open_trajectory(file) as trajectory:
        if "engine" not in trajectory.attrs:
            return []
        engine = engine_from_dict(json.loads(trajectory.attrs["engine"]))
        return engine.remarks(Scene.from_dict(parse_yaml(trajectory.attrs["scene"])))


def _of_seeds(trajectory: Any, name: str) -> dict[str, str]:
    """Return a remark if runs with other seeds have other energies."""
    from gaspart.accuracy.scatter import scatter_of_run
    from gaspart.cli.options import other_seeds

    if not OBSERVABLES[name].power:
        return {}
    scatter = scatter_of_run(trajectory, name).value
    return {_SEEDS: other_seeds(scatter)} if scatter else {}


def _measure_field(
    trajectory: Any, times: tuple[float | None, float | None], chosen: dict[str, Any]
) -> Observable:
    """Measure a field. Raises SceneError for a selection that does not apply to fields, and under the same
    conditions as `gaspart.analysis.field`.
    """
    from gaspart.analysis.drift import drift_of
    from gaspart.analysis.fields import field

    for key in set(chosen) - {"of", "axes", "cells", "species"}:
        raise SceneError(key, chosen[key], f"cannot be chosen for {_FIELD}, whose cells are along --axes")
    with until_time(trajectory, times[1]) as part:
        result, drift = field(part, start=times[0], **chosen), drift_of(part, start=times[0])
    result.attrs |= {"drift": drift} if drift else {}
    return result


def _print_field(observable: Observable) -> None:
    """Print a field along one axis as a curve, and the range of any other field. The line for a range
    contains the number of cells, the minimum and the maximum.
    """
    along = [str(dim) for dim in observable.estimate.dims if dim != "component"]
    name = str(observable.attrs["quantity"])
    if len(along) == 1:
        _print_curve(name, observable)
        return
    cells = " x ".join(str(observable.sizes[dim]) for dim in along)
    units = observable.estimate.attrs["units"]
    for label, part in _parts(observable) if "component" in observable.estimate.dims else [("", observable)]:
        low, high = float(part.estimate.min()), float(part.estimate.max())
        text = f"{name} {label}".rstrip()
        print_line(f"{text} in {cells} cells along {', '.join(along)}: {low:.5g} to {high:.5g} {units}")
    print_line("(-o field.csv writes all, -o field.png draws them)")


def _print_scalar(name: str, observable: Observable) -> None:
    units = observable.estimate.attrs["units"]
    line = (
        f"{name} = {_with_error(observable.estimate, observable.error)}{'' if units == '1' else f' {units}'}"
    )
    if observable.theory is not None and observable.deviation is not None:
        unsure = observable[f"{observable.estimate.name}_theory_error"]
        line += f", theory {_with_error(observable.theory, unsure)}"
        if np.isfinite(observable.deviation):
            line += f": {float(observable.deviation):+.1f} standard deviations"
        line += f" ({observable.attrs['source']})"
    print_line(line)


def _with_error(value: Any, error: Any) -> str:
    return f"{float(value):.6g} +- {float(error):.1g}" if float(error) > 0.0 else f"{float(value):.6g}"


def _print_curve(name: str, observable: Observable) -> None:
    along = observable.estimate.dims[-1]
    rows = observable.sizes[along]
    stride = max(1, -(-rows // _ROWS))
    heads, columns = [str(along)], [observable[along]]
    for label, part in _parts(observable):
        theory = _theory_columns(part)
        columns += [part.estimate, part.error, *theory.values()]
        heads += [f"{name} {label}".rstrip(), "error", *theory]
    wide = [max(14, len(head) + 2) for head in heads]
    print_line("".join(f"{head:>{width}}" for head, width in zip(heads, wide, strict=True)))
    for row in range(0, rows, stride):
        cells = [column.values[row] for column in columns]
        texts = [cell if isinstance(cell, str) else f"{cell:.5g}" for cell in cells]
        print_line("".join(f"{text:>{width}}" for text, width in zip(texts, wide, strict=True)))
    if observable.theory is not None:
        unsure = observable[f"{observable.estimate.name}_theory_error"]
        unknown = "" if np.isfinite(unsure).any() else "; its uncertainty is unknown"
        print_line(f"(theory: {observable.attrs['source']}{unknown})")
    if stride > 1:
        printed = -(-rows // stride)
        print_line(f"({printed} of {rows} rows; -o {name}.csv writes all, -o {name}.png draws them)")


def _theory_columns(part: Observable) -> dict[str, Any]:
    """Return the columns of theory and of its uncertainty, as far as they exist."""
    if part.theory is None:
        return {}
    unsure = part[f"{part.estimate.name}_theory_error"]
    return {"theory": part.theory} | ({"its error": unsure} if (unsure > 0.0).any() else {})


def _parts(observable: Observable) -> list[tuple[str, Observable]]:
    """Return the curves of an observable with their names, "" for a single curve."""
    if observable.estimate.ndim == 1:
        return [("", observable)]
    over = observable.estimate.dims[0]
    return [(str(text), observable.sel({over: text})) for text in observable[over].values]


def _writer(options: argparse.Namespace, names: list[str]) -> Callable[[Observable], None]:
    """Check the arguments, and return the function that writes the result."""
    if options.output is None:
        return lambda observable: None
    path = output_path(options.output)
    if len(names) > 1:
        raise UsageError("-o takes one observable; give one, or leave -o out")
    if path.suffix == ".csv":
        return partial(_write_table, path, options.force)
    if path.suffix == ".png":
        return partial(_write_plot, path, options.force)
    raise SceneError("output", options.output, "must end in .csv or .png")


def _write_table(path: Any, overwrite: bool, observable: Observable) -> None:
    with writing(path, _TABLE, overwrite) as scratch:
        observable = _with_columns(observable)
        units = {name: variable.attrs.get("units", "1") for name, variable in observable.variables.items()}
        title = f"{_TITLE}: units " + ", ".join(f"{name}: {unit}" for name, unit in units.items())
        title += f"; theory: {observable.attrs['source']}" if observable.theory is not None else ""
        scratch.write_text(f"{title}\n{observable.to_dataframe().to_csv()}", encoding="utf-8")
    print_line(path)


def _with_columns(observable: Observable) -> Observable:
    """Convert values of replicas, if there are several, to variables."""
    each = f"{observable.attrs['quantity']}_replicas"
    if each not in observable:
        return observable
    if not observable.estimate.ndim:  # stored there as `stretches`
        return observable.drop_vars(each).rename(time="replica")
    columns = {f"{each}_{n}": replica for n, replica in enumerate(observable[each], 1)}
    return observable.drop_vars(each).assign(columns)


def _write_plot(path: Any, overwrite: bool, observable: Observable) -> None:
    from gaspart.rendering import style
    from gaspart.rendering.pictures import PICTURE

    with writing(path, PICTURE, overwrite) as scratch, style.use_style("journal"):
        figure, (axis,) = style.new((2.6,))
        observable.plot(theory=observable.theory is not None, axis=axis)
        picture = io.BytesIO()
        figure.savefig(picture, format="png", metadata={"Software": None})
        scratch.write_bytes(picture.getvalue())
    print_line(path)
