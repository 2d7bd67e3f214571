"""`gaspart.sweep`: observables over a grid of scenes or settings, without a workflow.

The grid is an experiment of a config, with the points, seeds and jobs of the workflow. Trajectories are
stored, so that an interrupted sweep is continued, and a sweep with more values or observables simulates only
what is missing.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from gaspart.analysis.observables import OBSERVABLES
from gaspart.engines import Engine, engine_to_dict, resolve_engine
from gaspart.errors import SceneError, unknown_word
from gaspart.keys.values import count_of, number
from gaspart.reproduction.config import check_point, gridded_points
from gaspart.reproduction.jobs.simulate import recipes
from gaspart.reproduction.points.measurable import distinct, require_observable
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.points.point_keys import ENGINE_KEYS, EXTENTS, GAS, PREFIX
from gaspart.reproduction.sweep_points import axes_of, make_all, names_of
from gaspart.reproduction.sweep_table import Measured, SweepTable, measure_point, table
from gaspart.runs.ending import Accuracy
from gaspart.scene.scene import Scene, require_scene
from gaspart.trajectory.correlator import Correlations
from gaspart.trajectory.recipe import multiple
from gaspart.trajectory.run_options import required_contents
from gaspart.trajectory.until import Until

if TYPE_CHECKING:
    pass

EXPERIMENT = "points"
"""Folder of the trajectories within the folder of a sweep; with each point's name it makes the seeds."""
_SAMPLES = 128
_KEPT = ("radius", "packing_fraction", "count", "side")
"""The extents of a gas in the order in which they keep their values where others vary."""
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

    Parameters
    ----------
    scene : Scene
        The scene whose parameters are varied.
    over : mapping of str to sequence
        Values of each varied key; without any key there is one point. A key is one of a config: of one
        species alone in a container "packing_fraction", "count", "radius", "side", "temperature" and the
        others of a gas; a setting of the engine, such as "time_step"; or the position of a value in a scene
        file, such as "gravity" or "species.0.mass".
    observables : iterable of str
        Names of observables as in `gaspart measure`.
    folder : str or Path
        Folder of the trajectories, ``points/<name>/replica-<k>.nc``. Several sweeps may use it, also at the
        same time.
    engine : Engine or {"event", "step", "dsmc"}, optional
        The engine; a name selects its default settings. Default: event-driven.
    duration : float, [time], optional
        Length of each run. Excludes `until`.
    until : Accuracy or sequence of Accuracy, optional
        Each run ends when these standard errors are reached (see `run`).
    at_most : float, [time], optional
        Maximum length of each run with `until`.
    samples : int, optional
        Number of samples of each run. Default: 128; with `until`, those until `at_most`, by default one for
        each collision of a particle.
    equilibration : float, [time], optional
        Time before the measurement. Default: the first quarter of each run is discarded.
    correlations : Correlations, optional
        Time correlations that each run accumulates. Viscosities and the conductivity require ``stress=True``.
    replicas : int, default 1
        Number of independent runs of each point; their mean is measured.
    seed : int, default 0
        Seed of the sweep. With the names of point and replica it determines each random stream.
    workers : int, default 1
        Number of processes that run points at the same time. It changes no bit.
    progress : callable, optional
        Called as ``progress(done, points, name)`` when a point is complete. Default: write a line to the
        standard error.
    overwrite : bool, default False
        Replace trajectories of other settings.

    Returns
    -------
    SweepTable
        A Dataset that plots itself (`SweepTable.plot`), with a dimension for each key. Variables: each
        observable; its standard uncertainty (suffix _error); its value by theory, if there is one (suffix
        _theory); `duration`; and `failure`, the reason why a result is NaN, otherwise "". A curve has its own
        dimension, such as `rdf_distance` (where positions differ `rdf_distance_places`); all observables
        share `face` and `component`.

    Raises
    ------
    SceneError
        If settings contradict each other, trajectories are of another sweep, no point can have an observable,
        or no point of the grid can be run.

    See Also
    --------
    run : A single run.

    Notes
    -----
    If some of radius, packing fraction and count are varied, the others keep their values as far as possible.
    A complete trajectory is not simulated again, and an interrupted one is continued.

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
    axes = axes_of(over)
    names = names_of(observables, axes)
    length = _length(duration, until, at_most, samples, equilibration)
    point = {**length, **_settings(scene, axes, engine), **_contents_settings(names, correlations, length)}
    point["replicas"] = count_of("replicas", replicas, least=1)
    plan = _make_plan(_experiment(point, axes, engine), _root(folder), count_of("seed", seed))
    _require_measurable(names, plan.able)
    _make(plan, count_of("workers", workers, least=1), bool(overwrite), progress or _print)
    rows = [
        _row(point, names, equilibration is None, plan.failures.get(point.name, "")) for point in plan.points
    ]
    return table(rows, names, axes, {"scene": scene, "engine": engine, "seed": seed})


@dataclass(frozen=True)
class _Plan:
    """Points of a sweep, and reasons why some cannot be run, by names."""

    points: list[Point]
    failures: dict[str, str]

    @property
    def able(self) -> list[Point]:
        """Points that can be run."""
        return [point for point in self.points if point.name not in self.failures]


def _experiment(point: dict[str, Any], axes: Mapping[str, list], engine: Engine) -> dict[str, Any]:
    """Return the experiment of a config, with the settings that its points share."""
    grid = {key if key in point_keys(engine) else PREFIX + key: values for key, values in axes.items()}
    return {"job": "simulate", "point": point, "grid": grid}


def _make(plan: _Plan, workers: int, overwrite: bool, progress: Progress) -> None:
    """Run the points, and add the reasons why some failed to the plan."""
    done = count(len(plan.failures) + 1)
    for name, reason in plan.failures.items():
        _complain(name, reason)

    def report(point: Point, reason: str) -> None:
        if reason:
            plan.failures[point.name] = reason
            _complain(point.name, reason)
        progress(next(done), len(plan.points), point.name)

    _make_folder(plan.points[0].root)
    make_all(plan.able, workers, overwrite, report)


def _root(folder: Any) -> str:
    """Return the absolute path of the folder of a sweep, or raise SceneError."""
    if not isinstance(folder, str | Path) or not str(folder) or "\0" in str(folder):
        raise SceneError("folder", folder, "must be the path of a folder")
    return str(Path(folder).absolute())


def _make_folder(root: str) -> None:
    """Make the folder of the points, unless it exists, or raise SceneError."""
    try:
        Path(root, EXPERIMENT).mkdir(parents=True, exist_ok=True)
    except (OSError, UnicodeEncodeError) as error:
        reason = getattr(error, "strerror", None) or "its name is not UTF-8"
        raise SceneError("folder", root, f"cannot be made: {reason}") from None


def _length(
    duration: float | None,
    until: Accuracy | Sequence[Accuracy] | None,
    at_most: float | None,
    samples: int | None,
    equilibration: float | None,
) -> dict[str, Any]:
    """Return the keys of the length of a point, or raise SceneError."""
    if (duration is None) == (until is None):
        raise SceneError("duration", duration, "must be given, or until, but not both")
    key, value = ("duration", duration) if until is None else ("at_most", at_most)
    settings: dict[str, Any] = {"duration": number(key, value, "must be positive", above=0.0)}
    if equilibration is not None:
        rule = "must not be negative"
        settings["equilibration"] = number("equilibration", equilibration, rule, least=0.0)
    if samples is not None:
        settings["samples"] = count_of("samples", samples, least=1)
    if until is None:
        if at_most is not None:
            raise SceneError("at_most", at_most, "needs until")
        return {"samples": _SAMPLES, **settings}
    accuracies = tuple(until) if isinstance(until, list | tuple) else (until,)
    for accuracy in Until(accuracies, settings["duration"]).accuracies:  # raises SceneError for other things
        if accuracy.start is not None:
            raise SceneError("until.start", accuracy.start, "is the equilibration of a sweep")
    return {**settings, "until": {accuracy.name: accuracy.accuracy for accuracy in accuracies}}


def _contents_settings(
    names: list[str], correlations: Correlations | None, length: dict[str, Any]
) -> dict[str, Any]:
    """Return the keys of the contents of a point's files, or raise SceneError."""
    kept: dict[str, Any] = required_contents({OBSERVABLES[name].needs for name in names})
    if "until" in length:
        if correlations is not None:
            raise SceneError("correlations", correlations, "need a duration, not until")
        return {"displacements": kept["displacements"]}
    if correlations is None:
        return kept
    if not isinstance(correlations, Correlations):
        raise SceneError("correlations", correlations, "must be a gaspart.Correlations")
    if correlations.start:
        raise SceneError("correlations.start", correlations.start, "is the equilibration of a sweep")
    intervals = multiple("duration", length["duration"], "correlations.interval", correlations.interval)
    if 2 * correlations.lags > intervals + 1:
        raise SceneError("correlations.lags", correlations.lags, f"must be at most half of {intervals}")
    frames = next(n for n in range(min(intervals, length["samples"]), 0, -1) if intervals % n == 0)
    kept |= {"samples": intervals, "frames": frames, "lags": correlations.lags}
    return kept | {"stress": correlations.stress}


def point_keys(engine: Engine) -> set[str]:
    """Return the config keys that a sweep may vary: keys of gas and engine.

    Parameters
    ----------
    engine : Engine
        The engine.

    Returns
    -------
    set of str
        The keys.
    """
    return {*EXTENTS, *GAS, *ENGINE_KEYS[engine.name]}


def _settings(scene: Scene, axes: Mapping[str, list], engine: Engine) -> dict[str, Any]:
    """Return the keys of a point's scene and engine that do not vary, or raise SceneError."""
    settings = {key: value for key, value in engine_to_dict(engine).items() if value is not None}
    settings = {("engine" if key == "name" else key): value for key, value in settings.items()}
    settings = {key: value for key, value in settings.items() if key not in axes}
    of_gas = [key for key in axes if key in EXTENTS or key in GAS]
    if of_gas:
        return settings | _gas(scene, axes, of_gas[0])
    parts = [field.name for field in fields(Scene)]
    for key in axes:
        if key not in point_keys(engine) and key.partition(".")[0] not in parts:
            raise SceneError(f"over.{key}", axes[key], unknown_word(key, {*point_keys(engine), *parts}))
        if key not in point_keys(engine) and None in axes[key]:
            raise SceneError(f"over.{key}", None, "replaces no value of a scene: vary one that it can have")
    return settings | {"scene": scene.to_dict()}


def _gas(scene: Scene, axes: Mapping[str, list], varied: str) -> dict[str, Any]:
    """Return the settings of one species alone in a container; raise SceneError for another scene."""
    rule = "varies one species alone in a container; of other scenes vary a value, such as species.0.count"
    if len(scene.species) != 1:
        raise SceneError(f"over.{varied}", axes[varied], rule)
    (species,), container = scene.species, scene.container
    settings = {
        "dimension": scene.dimension,
        "boundary": list(container.boundary),
        "centres_to_walls": scene.centres_to_walls,
        "mass": species.mass,
        "polydispersity": species.polydispersity,
        "radius_distribution": species.radius_distribution,
        "temperature": species.temperature,
        "exact_temperature": species.exact_temperature,
        "speed": species.speed,
        "arrangement": species.arrangement,
    }
    extents = {
        "radius": species.radius,
        "packing_fraction": scene.packing_fraction,
        "count": species.count,
        "side": list(container.lengths),
    }
    same = {"count": species.count, "radius": species.radius, "side": list(container.lengths)}
    explicit = {key: value for key, value in {**settings, **same}.items() if value is not None}
    if Point(EXPERIMENT, "", "simulate", explicit, "", 0).scene != scene:
        raise SceneError(f"over.{varied}", axes[varied], rule)
    order = _KEPT if species.alike else _KEPT_OF_SIZES
    kept = [key for key in order if key not in axes][: 3 - sum(key in axes for key in EXTENTS)]
    if "side" not in axes and "side" not in kept and len(set(container.lengths)) > 1:
        raise SceneError(f"over.{varied}", axes[varied], "needs a container with equal sides")
    settings |= {key: extents[key] for key in kept}
    return {key: value for key, value in settings.items() if key not in axes}


def _make_plan(experiment: dict, root: str, seed: int) -> _Plan:
    """Return the points of an experiment, in the order of the product of its values.

    Raises SceneError for values that no point can use, and if no point can be run.
    """
    config = {"experiments": {EXPERIMENT: experiment}, "points": root, "seed": seed}
    try:
        planned = list(gridded_points(config, EXPERIMENT).values())
    except SceneError as error:
        raise _of_sweep(error) from None
    errors = {}
    for point in planned:
        try:
            check_point(point)
            recipes(**point.arguments)
        except SceneError as error:
            errors[point.name] = _of_sweep(error)
    if len(errors) == len(planned):
        raise errors[planned[0].name]
    return _Plan(planned, {name: _without_point(error, name) for name, error in errors.items()})


def _of_sweep(error: SceneError) -> SceneError:
    """Return an error of a config with the key that it has in a sweep."""
    key = error.key.removeprefix(f"experiments.{EXPERIMENT}")
    if key.startswith("["):
        key = f"{EXPERIMENT}{key}"
    elif key.startswith(".grid"):
        key = f"over{key.removeprefix('.grid')}"
    return SceneError(key.lstrip(".") or "over", error.value, error.rule, error.file)


def _without_point(error: SceneError, name: str) -> str:
    """Return the text of an error of a point without the point's name."""
    key = error.key.removeprefix(f"{EXPERIMENT}[{name}].")
    return str(SceneError(key, error.value, error.rule, error.file))


def _require_measurable(names: list[str], points: list[Point]) -> None:
    """Raise SceneError for an observable that no run of any of the points can have."""
    kinds = distinct(points)
    for name in names:
        refused = None
        for point in kinds:
            try:
                require_observable(name, point)
                break
            except SceneError as error:
                refused = refused or error
        else:
            if refused:
                rule = f"cannot be measured: {refused.key}: {refused.rule}"
                raise SceneError("observables", name, rule)


def _row(point: Point, names: list[str], part: bool, failure: str) -> Measured:
    """Return the row of a point: its results, or the reason of its failure."""
    if failure:
        return Measured({}, [], failure)
    result, refused = measure_point(point, names, part)
    for name, error in refused.items():
        _complain(point.name, str(error), name)
    return replace(result, failure="; ".join(str(error) for error in refused.values()))


def _print(done: int, points: int, name: str) -> None:
    print(f"{done} of {points} points: {name}", file=sys.stderr, flush=True)


def _complain(point: str, reason: str, observable: str = "") -> None:
    subject = f": {observable}" if observable else ""
    print(f"{EXPERIMENT}[{point}]{subject} is NaN: {reason}", file=sys.stderr, flush=True)
