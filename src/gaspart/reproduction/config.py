"""Validation of a config before any job starts.

Errors are single lines with file, key, value and rule.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import chdir, contextmanager, suppress
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaspart.errors import SceneError, unknown_word
from gaspart.files import resolve_path, whole_file
from gaspart.keys import TEXT, Kind, choice, describe, names, positive, record, require
from gaspart.keys.values import finite, size
from gaspart.reproduction import registry
from gaspart.reproduction.claims.table import fill_caption, place_fault
from gaspart.reproduction.points import jobs, point_keys
from gaspart.reproduction.points import points as config_keys
from gaspart.reproduction.points.point import TRAJECTORIES, Point
from gaspart.reproduction.points.points import POINT, effort_of, figure_points, points
from gaspart.reproduction.report.page import split_caption
from gaspart.yaml_text import DEEPEST, MOST_VALUES, dump_yaml, is_exponential, read_yaml

if TYPE_CHECKING:
    from gaspart.inspection.checks import Check

# The files of a config. They are merged as by Snakemake; `origin` finds the file that holds a key.


def merged_with_default(path: Path, base: Path | None = None) -> tuple[dict[str, Any], list[Path]]:
    """Merge a config over its base and its families, as the workflow does; return it with its files. By
    default `base` is the `config.yaml` in the same folder. If that does not exist, it is `config/config.yaml`
    below this folder, which the workflow in this folder uses. Raises SceneError for a file that cannot be
    read.
    """
    path = resolve_path(path)
    defaults = (path.parent / "config.yaml", path.parent / "config/config.yaml")
    bases = [resolve_path(base)] if base else [file for file in defaults if file.exists()]
    files = [*(file for file in bases[:1] if file.exists() and file != path), path]
    merged: dict[str, Any] = {}
    for file in files:
        merged = _merge(merged, _read_mapping(file))
    return merged, [*add_families(merged, files[0].parent / FAMILIES), *files]


FAMILIES = "figures"
"""Folder beside a config, with a file for each family of figures."""
_SECTIONS = {"experiments", "figures", "animations"}


def add_families(config: dict[str, Any], folder: Path) -> list[Path]:
    """Merge a config, in place, over the files of its families, and return these files. The key `families`
    names files of the folder, or is `all`. The key `sizes` names a block in these files, which is merged over
    the rest.
    """
    named, sizes = config.pop("families", None), config.get("sizes")
    if named is None:
        return []
    if named == "all":
        named = sorted(path.stem for path in folder.glob("*.yaml"))
    if not isinstance(named, list) or not all(re.fullmatch(r"[a-z][a-z0-9_]*", str(name)) for name in named):
        raise SceneError("families", named, f"must be all, or a list of names of files in {folder}")
    files = [folder / f"{name}.yaml" for name in named]
    below: dict[str, Any] = {}
    for file in files:
        content = _read_mapping(file)
        for key in content.keys() - _SECTIONS:
            if not isinstance(content[key], dict) or content[key].keys() - _SECTIONS:
                rule = f"must be {', '.join(sorted(_SECTIONS))}, or a block of sizes with such keys"
                raise SceneError(key, content[key], rule, str(file))
        for part in ({key: content[key] for key in content.keys() & _SECTIONS}, content.get(str(sizes), {})):
            below = _merge(below, part)
    merged = _merge(below, config)
    config.clear()
    config.update(merged)
    return files


EFFORTS = "efforts.yaml"
"""File beside the points: the effort with which each experiment was made."""


def keep_efforts(config: dict[str, Any], points: str | Path) -> dict[str, float]:
    """Raise the efforts of a merged config, in place, to those of the points in a folder, and return these. A
    run of less effort would replace what was paid for. Raises SceneError for efforts that cannot be read.
    """
    return raise_efforts(config, read_efforts(Path(points)))


def raise_efforts(config: dict[str, Any], efforts: Mapping[str, float]) -> dict[str, float]:
    """Raise the efforts of experiments of a merged config, in place, and return those that changed."""
    raised = {name: effort for name, effort in efforts.items() if effort > effort_of(config, name)}
    for name, effort in raised.items():
        config["experiments"][name]["effort"] = effort
    return raised


def read_efforts(points: Path) -> dict[str, float]:
    """Return the effort of each experiment with points in a folder. Raises SceneError."""
    file = points / EFFORTS
    content = _read_mapping(file) if file.exists() else {}
    for name, effort in content.items():
        try:
            require(positive("", maximum=100), effort, str(name))
        except SceneError as error:
            raise SceneError(error.key, error.value, error.rule, str(file)) from None
    return content


def write_efforts(points: Path, efforts: Mapping[str, float]) -> None:
    """Write the efforts of experiments with points in a folder; those of others stay."""
    efforts = dict(sorted((read_efforts(points) | dict(efforts)).items()))
    points.mkdir(parents=True, exist_ok=True)
    with whole_file(points / EFFORTS) as partial:
        partial.write_text(dump_yaml(efforts), encoding="utf-8")


def _read_mapping(file: Path) -> dict[str, Any]:
    content = read_yaml(file)
    if not isinstance(content, dict):
        raise SceneError("config", content, "must be a mapping of keys to values", str(file))
    return content


def _contents(config: Any, files: Sequence[str | Path]) -> list[tuple[str, Any]]:
    """Return the contents of the files of a config, in the order of merging, with their blocks of `sizes`."""
    sizes = config.get("sizes") if isinstance(config, dict) else None
    contents: list[tuple[str, Any]] = []
    for file in files:
        content = read_yaml(file)
        contents.append((str(file), content))
        if isinstance(content, dict) and isinstance(sizes, str) and sizes in content:
            contents.append((str(file), content[sizes]))
    return contents


def _merge(below: dict[str, Any], above: dict[str, Any]) -> dict[str, Any]:
    """Merge nested mappings key by key; other values of `above` replace the values of `below`."""
    both = {key: value for key, value in above.items() if isinstance(value, dict)}
    both = {key: value for key, value in both.items() if isinstance(below.get(key), dict)}
    return {**below, **above, **{key: _merge(below[key], value) for key, value in both.items()}}


def remove_null(config: dict) -> None:
    """Remove the keys of a merged config whose value is null."""
    for key, value in list(config.items()):
        if value is None:
            del config[key]
        elif isinstance(value, dict):
            remove_null(value)


def _error_of_removal(config: dict, contents: list[tuple[str, Any]]) -> SceneError | None:
    """Return the error of an experiment, a figure or a film that is removed but is in no file."""
    for section in ("experiments", "figures", "animations"):
        named = config.get(section)
        for name, value in named.items() if isinstance(named, dict) else ():
            blocks = [
                part for _, part in contents if isinstance(part, dict) and isinstance(part.get(section), dict)
            ]
            known = {key for part in blocks for key, block in part[section].items() if block is not None}
            if value is None and contents and name not in known:
                rule = unknown_word(name, sorted(known), "name to remove")
                return SceneError(f"{section}.{name}", None, rule)
    return None


def read_numbers(config: dict, files: Sequence[str | Path]) -> None:
    """Convert numbers such as 1e3 in a merged config; Snakemake reads them as text. `files` are the merged
    files, in the order of merging. Text in quotes stays text. Raises SceneError for a file that cannot be
    read.
    """
    _read_numbers(config, [content for _, content in _contents(config, files)])


def _read_numbers(block: Any, held: list[Any]) -> None:
    """Convert the numbers of a block. `held` lists the same block of each file."""
    for key, value in block.items() if isinstance(block, dict) else enumerate(block):
        below = []
        for part in held:
            with suppress(LookupError, TypeError):  # in this file the value has another type, or is missing
                below.append(part[key])
        if isinstance(value, dict | list):
            _read_numbers(value, below)
        elif isinstance(value, str) and is_exponential(value) and value not in below:
            block[key] = float(value)


def origin(key: str, config: dict, contents: list[tuple[str, Any]]) -> str | None:
    """Return the last file that contains a key, or the longest beginning of the key. If no file contains the
    value, it is the option of Snakemake.
    """
    parts = key.replace("[", ".").split(".")
    # the key `scene.` and its remainder are one key
    dotted = parts.index("scene") if "scene" in parts else len(parts)
    parts[dotted:] = [".".join(parts[dotted:])]

    def content_below(block: Any) -> tuple[int, Any]:
        reached = 0
        for part in parts:
            if not isinstance(block, dict) or part not in block:
                break
            block, reached = block[part], reached + 1
        return reached, block

    depth, value = content_below(config)
    if contents and depth and not isinstance(value, dict):
        # compared as written, because nan differs from itself
        if repr((depth, value)) not in [repr(content_below(content)) for _, content in contents]:
            return "--config"
    return max(reversed(contents), key=lambda content: content_below(content[1])[0])[0] if contents else None


# The JSON schemas of a config and of a scene file, from the declarations of their keys.


_DRAFT = "https://json-schema.org/draft/2020-12/schema"
_EXPERIMENTS = names("the experiments whose points the figure is made of, in this order")
MODULE = describe(
    {**TEXT, "pattern": r"^(?!.*\.\.)[A-Za-z0-9_][A-Za-z0-9_./-]*\.py$(?!\n)", "maxLength": 200},
    "the path of a Python module that has the figure in its FIGURES",
)


@cache
def schema(modules: tuple[tuple[str, str], ...] = ()) -> Kind:
    """Return the JSON schema of a config. Scenes and engines are not part of the schema: they are validated
    when the points are made. `modules` are the user's figures with a module, and its path.
    """
    figures = {
        figure: record({"experiments": _EXPERIMENTS, **settings})
        for figure, settings in registry.settings().items()
    }
    for figure, module in modules:
        keys = {"module": MODULE, "experiments": _EXPERIMENTS, **registry.settings_in(module, figure)}
        figures[figure] = record(keys)
    ((kind, keys),) = registry.kinds().items()
    stated = choice("the kind of a figure with a name of one's own", kind)
    own = record({"kind": stated, "experiments": _EXPERIMENTS, **keys})
    return Kind({"$schema": _DRAFT, **record(config_keys.config(figures, own))})


def scene_schema() -> Kind:
    """Return the JSON schema of a scene file. Rules that concern several keys are left out."""
    from gaspart.keys import schema_of
    from gaspart.scene.scene import Scene

    return Kind({"$schema": _DRAFT, **schema_of(Scene)})


@contextmanager
def open_config(path: str | Path) -> Iterator[tuple[dict[str, Any], dict[str, dict[str, Point]]]]:
    """Yield the valid config of a file and its points. The working directory is changed to the folder of the
    scenes. For a config in a folder named `config`, this is the parent folder; otherwise it is the folder of
    the file.
    """
    merged, files = merged_with_default(Path(path))
    folder = files[-1].parent
    with chdir(folder.parent if folder.name == "config" else folder):
        try:
            keep_efforts(merged, str(merged.get("points")))
            planned = check(merged, files)
        except SceneError as error:
            raise error if "experiments" in merged else explain_error(error, merged, False) from None
        yield merged, planned


def check(config: dict, files: Sequence[str | Path] = ()) -> dict[str, dict[str, Point]]:
    """Validate a merged config against the schema, then the parameters of every point's job. `files` are the
    merged YAML files, in the order of merging. An error names the last file that contains the key. Returns
    all points, by experiment and name.
    """
    contents = _contents(config, files)
    try:
        check_values(config)
        removal = _error_of_removal(config, contents)
        remove_null(config)
        _check_names(config)
        require(schema(_user_modules(config)), config, "")
        if removal:
            raise removal
        planned = {experiment: checked_points(config, experiment) for experiment in config["experiments"]}
        for figure, block in config["figures"].items():
            points = figure_points(config, figure, planned)
            registry.validate(figure, block, points)
            if is_own(block):
                _check_caption(figure, block)
        for animation, block in config.get("animations", {}).items():
            _animation(config, animation, block)
        return planned
    except SceneError as error:
        raise error.inside("", error.file or origin(error.key, config, contents)) from None


def check_values(config: object) -> None:
    """Raise SceneError unless a config is a tree of limited size with valid values. The tree consists of
    mappings, lists and plain values. Its depth and size are limited. Its numbers are finite, and neither too
    large nor too small to compute with.
    """
    stack = [("", config, 0)]  # an explicit stack, so that a deep config does not overflow Python's stack
    for count in range(MOST_VALUES):
        if not stack:
            return
        where, value, depth = stack.pop()
        if depth > DEEPEST:
            raise SceneError(where, count, f"values may be nested {DEEPEST} deep")
        if isinstance(value, dict):
            for key in value:
                if not isinstance(key, str):
                    rule = "a key must be text: write it in quotes"
                    raise SceneError(f"{where}.{key!s:.100}".lstrip("."), key, rule)
            stack += [(f"{where}.{key}".lstrip("."), item, depth + 1) for key, item in value.items()]
        elif isinstance(value, list):
            stack += [(where, item, depth + 1) for item in value]
        elif isinstance(value, int | float) and not isinstance(value, bool):
            number = finite(value)
            if number is None:
                raise SceneError(where, value, "must be a finite number")
            size(where, number)
        elif value is not None and not isinstance(value, str | bool):
            raise SceneError(where, value, "must be text, a number, a list or a mapping: quotes make it text")
    raise SceneError("config", len(stack), f"there may be {MOST_VALUES} values")


def is_own(entry: Mapping[str, Any]) -> bool:
    """Return True for the entry of a user's figure, whose name and caption are in the config."""
    return "kind" in entry or "module" in entry


def _check_names(config: object) -> None:
    """Raise SceneError unless a figure has either a name of the package, or a kind, or a module."""
    figures = config.get("figures") if isinstance(config, dict) else None
    for figure, block in figures.items() if isinstance(figures, dict) else ():
        if not isinstance(block, dict):
            continue  # the schema reports this
        where = f"figures.{figure}"
        if is_own(block) and figure in registry.families():
            rule = "is a figure of gaspart, without kind and module: a figure of one's own needs another name"
            raise SceneError(where, block.get("kind", block.get("module")), rule)
        if not is_own(block) and figure not in registry.families():
            rule = unknown_word(figure, registry.families())
            raise SceneError(where, block, f"{rule} (one's own has a kind: observable, or a module)")
        if "module" in block:
            require(MODULE, block["module"], f"{where}.module")


def _user_modules(config: dict) -> tuple[tuple[str, str], ...]:
    """Return (figure, path) of each figure with a module."""
    figures = config.get("figures")
    figures = figures if isinstance(figures, dict) else {}
    own = {figure: block for figure, block in figures.items() if isinstance(block, dict)}
    return tuple((figure, block["module"]) for figure, block in own.items() if "module" in block)


def _check_caption(figure: str, block: dict) -> None:
    """Raise SceneError for a caption that the report cannot show, if docutils is installed to parse it."""
    text = registry.caption(block)
    fault = place_fault(text)
    if not fault and find_spec("docutils"):
        try:
            split_caption(fill_caption(text, []))
        except ValueError as error:
            fault = str(error)
    if fault:
        raise SceneError(f"figures.{figure}.caption", text, fault)


def _animation(config: dict, animation: str, block: dict) -> None:
    """Raise SceneError for a film whose experiment is missing, or has no trajectories."""
    experiment = block["experiment"]
    kinds = {name: definition.get("job", "simulate") for name, definition in config["experiments"].items()}
    if kinds.get(experiment) != TRAJECTORIES:
        rule = "must be the name of an experiment that makes trajectories"
        raise SceneError(f"animations.{animation}.experiment", experiment, rule)
    figure = block.get("figure")
    if figure is not None and figure not in config["figures"]:
        raise SceneError(f"animations.{animation}.figure", figure, unknown_word(figure, config["figures"]))


def checked_points(config: dict, experiment: str) -> dict[str, Point]:
    """Return the points of an experiment, by name, after a check of every point and value of the grid."""
    points = gridded_points(config, experiment)
    for point in points.values():
        check_point(point)
    return points


def gridded_points(config: dict, experiment: str) -> dict[str, Point]:
    """Return the points of an experiment, by name, after each value of its grid is checked alone."""
    where = f"experiments.{experiment}"
    for key, value in _grid_values(config["experiments"][experiment].get("grid")):
        if key.startswith(point_keys.PREFIX):  # a value of a scene file; the scene validates it
            continue
        if key not in POINT:
            raise SceneError(f"{where}.grid.{key}", value, unknown_word(key, POINT))
        require(POINT[key], value, f"{where}.grid.{key}")
    return {point.name: point for point in points(config, experiment)}


def check_point(point: Point) -> None:
    """Make the parameters of a point's job. Raises SceneError if its settings contradict each other."""
    where = f"experiments.{point.experiment}"
    try:
        jobs.validate(point)
    except SceneError as error:
        located = error.file or error.key.startswith(where)
        raise error if located else error.inside(f"{where}[{point.name}]") from None


def _grid_values(block: Any) -> Iterator[tuple[str, object]]:
    """Yield every (key, value) of a grid. An empty list yields nothing; the points report it."""
    if isinstance(block, list):
        for part in block:
            yield from _grid_values(part)
        return
    for key, values in (block or {}).items():
        for value in values if isinstance(values, list) else [values]:
            yield key, value


def explain_error(error: SceneError, config: dict, module: bool) -> SceneError:
    """Return an error of a config; add an explanation if all keys are missing. `config` is the merged config.
    `module` is True if another workflow uses this one as a module.
    """
    if error.rule != "is required" or Path("config/config.yaml").exists() or (module and config):
        return error
    if module:
        rule = 'is empty: the Snakefile that has the module states `configfile: "..."` above it'
        return SceneError("config", config, rule)
    rule = "has no config/config.yaml, over which others are laid: run this in the project's folder"
    return SceneError("folder", str(Path.cwd()), rule)


# Validation of configs of the workflow.


def judge_config(path: Path) -> list[Check]:
    """Check every point of every grid, and every figure. A config next to `config.yaml` is merged over it, as
    in the workflow. Raises SceneError for a config that cannot be run.
    """
    from gaspart.inspection.checks import Check  # takes 0.5 s, and planning does not need it

    with open_config(path) as (merged, planned):
        counts = [point.extents.particles for points in planned.values() for point in points.values()]
    text = f"{len(planned)} experiments of {len(counts)} points, up to {max(counts)} particles; "
    return [Check("config", True, text + f"{len(merged['figures'])} figures")]
