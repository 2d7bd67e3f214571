"""`gaspart.sweep`: observables over a grid of scenes or settings, without a workflow.

The grid is an experiment of a config, with the points, seeds and jobs of the workflow. Trajectories are
stored, so that an interrupted sweep can be continued. A sweep with further values or observables simulates
only the missing points.
"""

from __future__ import annotations

import inspect
import json
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import fields, replace
from itertools import count, islice
from math import nan
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import xarray as xr

from gaspart.accuracy.conditions import keeps_energy
from gaspart.analysis.drift import drift_of
from gaspart.analysis.observables import OBSERVABLES, observable_name
from gaspart.engines import Engine, engine_to_dict, resolve_engine
from gaspart.errors import SceneError, SimulationError, unknown_word
from gaspart.files import only_process
from gaspart.kernels.compile.cache import load_numba
from gaspart.keys.values import count_of, positive_number
from gaspart.reproduction.config import check_values, gridded_points
from gaspart.reproduction.figures.own import measure_point
from gaspart.reproduction.jobs.replicas import replica_paths, write_replicas
from gaspart.reproduction.jobs.simulate import recipes, record
from gaspart.reproduction.points import jobs
from gaspart.reproduction.points.measurable import distinct, require_observable
from gaspart.reproduction.points.point import Point, compile_kernels, compile_task, variant
from gaspart.reproduction.points.point_keys import ENGINE_KEYS, EXTENTS, GAS, PREFIX
from gaspart.reproduction.points.points import MOST_POINTS, POINT
from gaspart.reproduction.sweep_table import SweepTable, columns, coordinate, table
from gaspart.runs.ending import Accuracy
from gaspart.scene.scene import Scene, require_scene
from gaspart.trajectory.correlator import Correlations
from gaspart.trajectory.recipe import multiple
from gaspart.trajectory.run_options import Until, required_contents
from gaspart.workers import in_processes
from gaspart.yaml_text import dump_yaml

EXPERIMENT = "points"
"""Folder of the trajectories in the folder of a sweep. With each point's name it determines the seeds."""
_SAMPLES = 128
_KEPT = ("radius", "packing_fraction", "count", "side")
"""Extents of a gas, in the order in which they stay constant when others vary."""
_KEPT_OF_SIZES = ("radius", "count", "packing_fraction", "side")
"""Keys of a polydisperse species, whose radii follow from their number."""
Progress: TypeAlias = Callable[[int, int, str], None]


def sweep(
    scene: Scene,
    over: Mapping[str, Sequence[Any]],
    observables: Iterable[str],
    *,
    folder: str | Path,
    engine: Engine | str | None = None,
    duration: float | None = None,
    until: Accuracy | Sequence[Accuracy] | None = None,
    at_most: float | None = None,
    samples: int | None = None,
    equilibration: float | None = None,
    correlations: Correlations | None = None,
    replicas: int = 1,
    seed: int = 0,
    workers: int = 1,
    progress: Progress | None = None,
    overwrite: bool = False,
) -> SweepTable:
    """Run a scene for each combination of parameter values, and measure observables of each run.

    Trajectories are stored. A repeated call simulates only what is missing in `folder`.

    If some of radius, packing fraction and count vary, the others keep their values as far as possible. If
    runs conserve their energy, species with a `temperature` have exactly this temperature at the start;
    otherwise each point would have another energy. A complete trajectory is not simulated again. An
    interrupted trajectory is continued.

    Parameters
    ----------
    scene : Scene
        The scene whose parameters are varied.
    over : mapping of str to sequence
        Values of each varied key; without any key there is one point. A key is one of three kinds. For a
        single species in a container, the parameter is named by a key of a gas in a config, such as
        "packing_fraction", "count", "radius", "side" or "temperature". It may be a setting of the engine,
        such as "time_step". Otherwise it is the position of a value in a scene file, such as "gravity" or
        "species.0.mass".
    observables : iterable of str
        Names of observables as in `gaspart measure`.
    folder : str or Path
        Folder of the trajectories, ``points/<name>/replica-<k>.nc``. Several sweeps may use the same folder,
        even simultaneously.
    engine : Engine or {"event", "step", "dsmc"}, optional
        The engine; a name selects its default settings. Default: event-driven.
    duration : float, [time], optional
        Length of each run. Excludes `until`.
    until : Accuracy or sequence of Accuracy, optional
        Each run ends when these standard errors are reached (see `run`).
    at_most : float, [time], optional
        Maximum length of each run with `until`.
    samples : int, optional
        Number of samples of each run. Default: 128. With `until`, it is the number of samples in the time
        `at_most`; by default, there is one sample per collision of a particle.
    equilibration : float, [time], optional
        Time before the measurement. Default: the first quarter of each run is discarded.
    correlations : Correlations, optional
        Time correlations that each run accumulates. Viscosities and the conductivity require ``stress=True``.
    replicas : int, default 1
        Number of independent runs of each point; their mean is measured.
    seed : int, default 0
        Seed of the sweep. With the names of point and replica it determines each random stream.
    workers : int, default 1
        Number of processes that run points at the same time. No bit of the results depends on it.
    progress : callable, optional
        Function that is called as ``progress(done, points, name)`` when a point is complete. By default, a
        line is written to the standard error.
    overwrite : bool, default False
        Replace trajectories of other settings.

    Returns
    -------
    SweepTable
        A Dataset with a method to plot itself (`SweepTable.plot`), and a dimension for each key. Variables
        are each observable, its standard uncertainty (suffix _error), its theoretical value and the
        uncertainty of this value if known (suffixes _theory and _theory_error), `duration`, `failure` and
        `drift`. `failure` is the reason why a result is NaN, and `drift` states which quantities drift in the
        measured part of the run; both are "" otherwise. A curve has its own dimension, such as
        `rdf_distance`; if positions differ between points, they are in `rdf_distance_places`. All observables
        share the dimensions `face` and `component`.

    Raises
    ------
    SceneError
        If settings contradict each other, if the folder has trajectories of another sweep, if no point can
        have an observable, or if no point of the grid can be run.

    See Also
    --------
    run : A single run.

    Examples
    --------
    >>> import gaspart as gp
    >>> box = gp.Container((10.0, 10.0), boundary="periodic")
    >>> gas = gp.Scene(box, [gp.Species(32, 0.5, temperature=1.0)])
    >>> quiet = lambda done, points, name: None
    >>> values = {"packing_fraction": [0.05, 0.1]}
    >>> table = gp.sweep(gas, values, ["Z"], folder="swept", duration=10.0, progress=quiet)
    >>> table.Z.dims, table.Z_theory.values.round(2)
    (('packing_fraction',), array([1.11, 1.23]))
    """
    require_scene(scene)
    engine = resolve_engine(engine)
    axes = _axes(over, engine)
    names = _names(observables, axes)
    point = _length(duration, until, at_most, samples, equilibration)
    point |= {**_settings(_with_equal_energies(scene), axes, engine), **_contents(names, correlations, point)}
    point["replicas"] = POINT["replicas"].check("replicas", replicas)
    varied = {key if key in _point_keys(engine) else PREFIX + key: values for key, values in axes.items()}
    config: dict[str, Any] = {
        "experiments": {EXPERIMENT: {"job": "simulate", "point": point, "grid": varied}},
        "points": _root(folder),
        "seed": count_of("seed", seed),
    }
    points, failures = _plan(config)
    able = [point for point in points if point.name not in failures]
    _require_measurable(names, able)
    done = count(1)

    def report(point: Point, reason: str) -> None:
        if reason:
            failures[point.name] = reason
            _complain(point.name, reason)
        (progress or _print)(next(done), len(points), point.name)

    workers = count_of("workers", workers, least=1)
    for name, reason in failures.items():
        next(done)
        _complain(name, reason)
    try:
        Path(config["points"], EXPERIMENT).mkdir(parents=True, exist_ok=True)
    except (OSError, UnicodeEncodeError) as error:
        reason = getattr(error, "strerror", None) or "its name is not UTF-8"
        raise SceneError("folder", config["points"], f"cannot be made: {reason}") from None
    make_all(able, workers, bool(overwrite), report)
    rows = [_row(point, names, equilibration is None, failures.get(point.name, "")) for point in points]
    about = {"scene": dump_yaml(scene.to_dict()), "engine": json.dumps(engine_to_dict(engine)), "seed": seed}
    return table(rows, names, axes).assign_attrs(about)


# The request of a sweep as settings of points: plain values, checked as the keys of a config.


def _with_equal_energies(scene: Scene) -> Scene:
    """Return the scene with exact temperatures if a run conserves the energy of its drawn velocities."""
    drawn = [kind for kind in scene.species if kind.temperature is not None and not kind.fixed]
    if not keeps_energy(scene) or sum(kind.count for kind in drawn) < 2:
        return scene
    exact = [replace(kind, exact_temperature=kind in drawn) for kind in scene.species]
    return replace(scene, species=exact)


def _axes(over: object, engine: Engine) -> dict[str, list]:
    """Return the values of each varying key, as Python numbers, words and lists."""
    if not isinstance(over, Mapping):
        rule = "must be a mapping from each key that varies to its values, such as {'count': [50, 100]}"
        raise SceneError("over", over, rule)
    axes = {key: _values(values) for key, values in over.items()}
    check_values({"over": axes})
    keys, parts = _point_keys(engine), {field.name for field in fields(Scene)}
    for key, values in axes.items():
        if key in inspect.signature(sweep).parameters:
            rule = "is an argument of a sweep and the same for all points"
            rule += "; replicas= makes runs of several seeds" if key == "seed" else ""
            raise SceneError(f"over.{key}", values, rule)
        if key not in keys and key.partition(".")[0] not in parts:
            raise SceneError(f"over.{key}", values, unknown_word(key, keys | parts))
        if key not in keys and None in values:
            raise SceneError(f"over.{key}", None, "replaces no value of a scene: vary one that it can have")
        if len({*map(coordinate, values)}) < len(values):  # 1 and 1.0 are equal
            raise SceneError(f"over.{key}", values, "every point of a grid must be different")
    return axes


def _values(values: Any) -> list:
    """Return the values of a key; a single value counts as a list of one value."""
    plain = _plain(values)
    if isinstance(plain, str | bytes | Mapping) or not isinstance(plain, Iterable):
        return [plain]
    return [_plain(value) for value in islice(plain, MOST_POINTS + 1)]


def _plain(value: Any) -> Any:
    """Convert numpy numbers and arrays, also inside containers, to Python values."""
    if hasattr(value, "__array__"):
        value = np.asarray(value).tolist()
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    return [_plain(item) for item in value] if isinstance(value, list | tuple) else value


def _names(observables: object, axes: Mapping[str, list]) -> list[str]:
    """Return the distinct names of the observables; a single name counts as a list of one name."""
    listed = [observables] if isinstance(observables, str) else observables
    if not isinstance(listed, Iterable) or isinstance(listed, bytes | Mapping):
        raise SceneError("observables", observables, "must be the names of observables")
    names = list(dict.fromkeys(map(observable_name, listed)))
    for name in names:
        if name in axes:
            rule = f"is also a key that varies: vary species.0.{name} instead"
            raise SceneError("observables", name, rule)
    return names


def _length(
    duration: float | None,
    until: Accuracy | Sequence[Accuracy] | None,
    at_most: float | None,
    samples: int | None,
    equilibration: float | None,
) -> dict[str, Any]:
    """Return the keys for the length of a point."""
    if (duration is None) == (until is None):
        raise SceneError("duration", duration, "must be given, or until, but not both")
    if until is None and at_most is not None:
        raise SceneError("at_most", at_most, "needs until")
    key, value = ("duration", duration) if until is None else ("at_most", at_most)
    settings: dict[str, Any] = {"duration": positive_number(key, value)}
    for key, value in {"samples": samples, "equilibration": equilibration}.items():
        if value is not None:
            settings[key] = POINT[key].check(key, value)
    if until is None:
        return {"samples": _SAMPLES, **settings}
    accuracies = tuple(until) if isinstance(until, list | tuple) else (until,)
    for accuracy in Until(accuracies, settings["duration"]).accuracies:  # raises SceneError for other objects
        if accuracy.start is not None:
            raise SceneError("until.start", accuracy.start, "is the equilibration of a sweep")
    return {**settings, "until": {accuracy.name: accuracy.accuracy for accuracy in accuracies}}


def _contents(names: list[str], correlations: Correlations | None, length: dict[str, Any]) -> dict[str, Any]:
    """Return the keys for the contents of a point's files."""
    stored: dict[str, Any] = required_contents({OBSERVABLES[name].needs for name in names})
    if "until" in length:
        del stored["pairs"]
    if correlations is None:
        return stored
    if "until" in length:
        raise SceneError("correlations", correlations, "need a duration, not until")
    if not isinstance(correlations, Correlations):
        raise SceneError("correlations", correlations, "must be a gaspart.Correlations")
    if correlations.start:
        raise SceneError("correlations.start", correlations.start, "is the equilibration of a sweep")
    intervals = multiple("duration", length["duration"], "correlations.interval", correlations.interval)
    if 2 * correlations.lags > intervals + 1:
        raise SceneError("correlations.lags", correlations.lags, f"must be at most half of {intervals}")
    frames = next(n for n in range(min(intervals, length["samples"]), 0, -1) if intervals % n == 0)
    stored |= {"samples": intervals, "frames": frames, "lags": correlations.lags}
    return stored | {"stress": correlations.stress}


def _point_keys(engine: Engine) -> set[str]:
    """Return the keys of gas and engine that a sweep may vary."""
    return {*EXTENTS, *GAS, *ENGINE_KEYS[engine.name]}


def _settings(scene: Scene, axes: Mapping[str, list], engine: Engine) -> dict[str, Any]:
    """Return the keys of a point's scene and engine that do not vary. If a key of a gas varies, the scene is
    described by such keys, and must be one species in a container.
    """
    settings = {"engine" if key == "name" else key: value for key, value in engine_to_dict(engine).items()}
    varied = next((key for key in axes if key in EXTENTS or key in GAS), None)
    if varied is None:
        settings["scene"] = scene.to_dict()
        return {key: value for key, value in settings.items() if key not in axes}
    rule = "varies one species alone in a container; of other scenes vary a value, such as species.0.count"
    if len(scene.species) != 1:
        raise SceneError(f"over.{varied}", axes[varied], rule)
    (species,), lengths = scene.species, list(scene.container.lengths)
    parts = scene, scene.container, species
    gas = {key: getattr(part, key) for key in GAS for part in parts if hasattr(part, key)}
    extents = {"count": species.count, "radius": species.radius, "side": lengths}
    explicit = {key: value for key, value in (gas | extents).items() if value is not None}
    if Point(EXPERIMENT, "", "simulate", explicit, "", 0).scene != scene:
        raise SceneError(f"over.{varied}", axes[varied], rule)
    order = _KEPT if species.alike else _KEPT_OF_SIZES
    kept = [key for key in order if key not in axes][: 3 - sum(key in axes for key in EXTENTS)]
    if "side" not in axes and "side" not in kept and len(set(lengths)) > 1:
        raise SceneError(f"over.{varied}", axes[varied], "needs a container with equal sides")
    extents["packing_fraction"] = scene.packing_fraction
    if "side" not in kept and "side" not in axes:
        stated = " and ".join(f"{key} = {extents[key]:.6g}" for key in kept)
        print(f"over.{varied}: the container's side follows; kept: {stated}", file=sys.stderr, flush=True)
    settings |= gas | {key: extents[key] for key in kept}
    return {key: value for key, value in settings.items() if key not in axes}


def _root(folder: Any) -> str:
    """Return the absolute path of the folder of a sweep; raise SceneError for another value."""
    if not isinstance(folder, str | Path) or not str(folder) or "\0" in str(folder):
        raise SceneError("folder", folder, "must be the path of a folder")
    return str(Path(folder).absolute())


# The points: which of them can be run, their trajectories, and their results.


def _plan(config: dict) -> tuple[list[Point], dict[str, str]]:
    """Return the points in order, and the reasons, by name, why points cannot be run, unless none can."""
    try:
        points = list(gridded_points(config, EXPERIMENT).values())
    except SceneError as error:
        raise _of_sweep(error) from None
    errors = {}
    for point in points:
        try:
            jobs.validate(point)
            recipes(**point.arguments)
        except SceneError as error:
            errors[point.name] = _of_sweep(error)
    if len(errors) == len(points):
        raise errors[points[0].name]
    return points, {name: str(error) for name, error in errors.items()}


def _of_sweep(error: SceneError) -> SceneError:
    """Return an error of a config with the sweep's name of the key."""
    key = error.key.removeprefix(f"experiments.{EXPERIMENT}").lstrip(".")
    key = f"over{key.removeprefix('grid')}" if key.startswith("grid") else key
    return SceneError(key or "over", error.value, error.rule, error.file)


def _require_measurable(names: list[str], points: list[Point]) -> None:
    """Raise SceneError for an observable that none of the points can have."""
    kinds = distinct(points)
    for name in names:
        refused: list[SceneError] = []
        for point in kinds:
            try:
                require_observable(name, point)
                break
            except SceneError as error:
                refused.append(error)
        else:
            rule = f"cannot be measured: {refused[0].key}: {refused[0].rule}"
            raise SceneError("observables", name, rule)


def make_all(
    points: Sequence[Point], workers: int, overwrite: bool, report: Callable[[Point, str], None]
) -> None:
    """Make the trajectories of all points, and call report(point, reason of a failure or "") for each. Points
    with existing trajectories come first, so that a conflict is found before any run. Raises SceneError for
    files that cannot be written, or belong to another sweep.
    """
    ordered = sorted(points, key=lambda point: not Path(point.path).exists())
    if workers == 1:
        for point in ordered:
            report(point, _make(point, overwrite))
        return
    for representative in {variant(point): point for point in ordered}.values():
        with suppress(SceneError, SimulationError):  # an error of this point only
            compile_kernels(compile_task(representative))  # otherwise each process would compile them
    calls = [(point.to_dict(), point.path, overwrite) for point in ordered]
    in_processes(_make_in_process, calls, workers, lambda n, reason: report(ordered[n], str(reason)))


def _make_in_process(tell: Callable[[Any], None], values: dict, path: str, overwrite: bool) -> str:
    """Make a point from its dictionary in a separate process; see `_make`."""
    load_numba(ours=True)
    return _make(Point.from_dict(values, path), overwrite)


def _make(point: Point, overwrite: bool) -> str:
    """Make the trajectories of a point, or check existing ones; return the reason of a failure, or ""."""
    folder = Path(point.path)
    try:
        all_recipes = recipes(**point.arguments)
        with only_process(folder, wait=True):
            if not folder.exists():
                write_replicas(record, all_recipes, folder, None, overwrite)
                return ""
            for path, recipe in zip(replica_paths(folder, len(all_recipes)), all_recipes, strict=True):
                record(recipe, path, overwrite)
    except OSError as error:
        rule = f"cannot be written: {error.strerror}"
        raise SceneError(f"{EXPERIMENT}[{point.name}].path", str(folder), rule) from None
    except (SceneError, SimulationError) as error:
        if isinstance(error, SceneError) and error.key == "path":
            raise error.inside(f"{EXPERIMENT}[{point.name}]") from None
        return str(error)
    except MemoryError:
        return "there is not enough memory"
    return ""


def _row(point: Point, names: list[str], part: bool, failure: str) -> xr.Dataset:
    """Return the results of a point, or the reason for its failure; see `measure_point`."""
    if failure:
        return xr.Dataset({"duration": nan, "failure": failure, "drift": ""})
    results, duration, refused = measure_point(point, names, part)
    for name, error in refused.items():
        _complain(point.name, str(error), name)
    drift = ""
    if results:
        drift = drift_of(*point.replica_paths, start=None if part else point.schedule.equilibration)
    if drift:
        print(f"{EXPERIMENT}[{point.name}] is not steady: {drift}", file=sys.stderr, flush=True)
    failures = "; ".join(map(str, refused.values()))
    row = xr.Dataset({"duration": duration, "failure": failures, "drift": drift})
    return row.assign({key: value for name in results for key, value in columns(name, results[name])})


def _print(done: int, points: int, name: str) -> None:
    print(f"{done} of {points} points: {name}", file=sys.stderr, flush=True)


def _complain(point: str, reason: str, observable: str = "") -> None:
    subject = f": {observable}" if observable else ""
    print(f"{EXPERIMENT}[{point}]{subject} is NaN: {reason}", file=sys.stderr, flush=True)
