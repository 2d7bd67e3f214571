"""`gaspart.sweep`: observables over a grid of scenes or settings, without a workflow.

The grid is an experiment of a config, with the points, seeds and jobs of the workflow. Trajectories are
kept, so that a sweep that was cut short goes on, and one with more values or observables makes only what
is missing.
"""

from __future__ import annotations

import pickle
import subprocess
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import fields
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from gaspart.analysis.observables import OBSERVABLES, known, require_defined, require_kept
from gaspart.engines import Engine, EventDriven, engine_to_dict
from gaspart.errors import SceneError, SimulationError, unknown_word
from gaspart.interruption import exit_on_signals
from gaspart.kernels.compile.loading import load_numba
from gaspart.reproduction.config import checked_points
from gaspart.reproduction.jobs import simulate, simulate_until
from gaspart.reproduction.jobs.replicas import Record, replica_paths, write_replicas
from gaspart.reproduction.points.keys import ENGINES, EXTENTS, GAS, PREFIX
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.points.variants import task, variant, warm
from gaspart.reproduction.sweep_table import Measured, measured, table
from gaspart.scene.scene import Scene
from gaspart.scene.validation import count_of, number
from gaspart.tradeoff.accuracy import Accuracy

if TYPE_CHECKING:
    import xarray as xr

EXPERIMENT = "points"
"""The folder of the trajectories within that of a sweep; with each point's name it makes the seeds."""
_SAMPLES = 128
_KEPT = ("radius", "packing_fraction", "count", "side")
"""The extents of a gas in the order in which they keep their values where others vary."""
_RECORD: dict[str, Record] = {"simulate": simulate.record, "simulate_until": simulate_until.record}
Progress: TypeAlias = Callable[[int, int, str], None]


def sweep(
    scene: Scene,
    over: Mapping[str, Sequence[Any]],
    observables: Iterable[str],
    *,
    folder: str | Path,
    engine: Engine | None = None,
    duration: float | None = None,
    until: Accuracy | Sequence[Accuracy] | None = None,
    at_most: float | None = None,
    samples: int | None = None,
    equilibration: float | None = None,
    replicas: int = 1,
    seed: int = 0,
    workers: int = 1,
    progress: Progress | None = None,
    overwrite: bool = False,
) -> xr.Dataset:
    """Run a scene for each combination of some values, and measure observables of each run.

    over: the values of each key that varies, all combinations of which are run. A key is one of a config:
    for one species alone in a container `packing_fraction`, `count`, `radius`, `side`, `temperature` and
    the others of a gas, where of radius, packing fraction and count those that are not varied keep their
    values as far as possible; a setting of the engine, such as `time_step`; or the place of a value in a
    scene file, such as `gravity` or `species.0.mass`. observables: names as of `gaspart measure`. engine:
    by default `EventDriven()`.

    Each run has a duration, divided into so many samples (128 by default), or ends when the standard
    errors of `until` are reached (see `gaspart.run`; the samples are then those until `at_most`, by
    default one for each collision of a particle), at the latest after `at_most`. equilibration: a time
    before, which is not measured; by default the first quarter of each run is not. replicas: independent
    runs, whose mean is taken. seed: with the names of a point and a replica it gives each random stream.
    workers: processes that run points at the same time, which changes no bit. progress(done, points,
    name) is called when a point is complete; by default it writes a line to the standard error.

    Returns a Dataset with a dimension for each key of `over`. An observable has its name; with the suffix
    _error it is the standard uncertainty, with _theory the value of theory, where there is one. Curves
    have their own dimension too, such as `rdf_distance`; where its places differ between the points,
    these are the variable `rdf_distance_places`. `duration` is that of each run, the mean over replicas.
    The trajectories are `folder`/points/<name>/replica-<k>.nc. Those that are complete are not made
    again, and one that was cut short goes on; those of other settings are replaced only with `overwrite`.

    Raises SceneError for settings that contradict each other, a folder that holds a trajectory of another
    sweep, and what cannot be measured; SimulationError as `gaspart.run`.
    """
    names = [known(name) for name in observables]
    axes = {key: list(values) for key, values in over.items()}
    engine = EventDriven() if engine is None else engine
    length = _length(duration, until, at_most, samples, equilibration)
    point = {**length, **_settings(scene, axes, engine, Path(folder))}
    point |= {
        "replicas": count_of("replicas", replicas, least=1),
        "pairs": any(OBSERVABLES[name].needs == "pairs" for name in names),
    }
    job = "simulate" if until is None else "simulate_until"
    grid = {key if key in point_keys(engine) else PREFIX + key: values for key, values in axes.items()}
    planned = _planned({"job": job, "point": point, "grid": grid}, str(folder), count_of("seed", seed))
    _run(_measurable(planned, names), count_of("workers", workers, least=1), progress or _print, overwrite)
    rows: list[Measured] = [measured(one, names, equilibration is None) for one in planned]
    return table(rows, names, axes, {"scene": scene, "engine": engine, "seed": seed})


def _measurable(planned: list[Point], names: list[str]) -> list[Point]:
    """The points. Raises SceneError, before anything runs, for an observable that one does not have, or that
    its run does not keep what it needs for."""
    for point, name in product(planned, names):
        try:
            require_defined(name, point.scene)
            require_kept(name, ("pairs",))
        except SceneError as error:
            raise error.inside(f"{name} of {EXPERIMENT}[{point.name}]") from None
    return planned


def _length(
    duration: float | None,
    until: Accuracy | Sequence[Accuracy] | None,
    at_most: float | None,
    samples: int | None,
    equilibration: float | None,
) -> dict[str, Any]:
    """What a point states of its length. Raises SceneError."""
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
    asked = (until,) if isinstance(until, Accuracy) else tuple(until)
    for one in asked:
        if one.start is not None:
            raise SceneError("until.start", one.start, "is the equilibration of a sweep")
    return {**settings, "until": {one.name: one.accuracy for one in asked}}


def point_keys(engine: Engine) -> set[str]:
    """The keys of a config that a sweep may vary: those of a gas and of the engine."""
    return {*EXTENTS, *GAS, *ENGINES[engine.name]}


def _settings(scene: Scene, axes: Mapping[str, list], engine: Engine, folder: Path) -> dict[str, Any]:
    """What a point states of its scene and its engine beside what varies. Raises SceneError."""
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
    path = folder / "scene.yaml"
    folder.mkdir(parents=True, exist_ok=True)
    scene.to_file(path)
    return settings | {"scene": str(path)}


def _gas(scene: Scene, axes: Mapping[str, list], varied: str) -> dict[str, Any]:
    """The settings that describe one species alone in a container. Raises SceneError for another scene."""
    rule = "varies one species alone in a container; of other scenes vary a value, such as species.0.count"
    if len(scene.species) != 1:
        raise SceneError(f"over.{varied}", axes[varied], rule)
    (species,), container = scene.species, scene.container
    settings = {
        "dimension": scene.dimension,
        "boundary": list(container.boundary),
        "centres_to_walls": scene.centres_to_walls,
        "mass": species.mass,
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
    if Point(EXPERIMENT, "", "simulate", {**settings, **same}, "", 0).scene != scene:
        raise SceneError(f"over.{varied}", axes[varied], rule)
    kept = [key for key in _KEPT if key not in axes][: 3 - sum(key in axes for key in EXTENTS)]
    if "side" not in axes and "side" not in kept and len(set(container.lengths)) > 1:
        raise SceneError(f"over.{varied}", axes[varied], "needs a container with equal sides")
    settings |= {key: extents[key] for key in kept}
    return {key: value for key, value in settings.items() if key not in axes}


def _planned(experiment: dict, root: str, seed: int) -> list[Point]:
    """The points of an experiment, in the order of the product of its values. Raises SceneError."""
    config = {"experiments": {EXPERIMENT: experiment}, "points": root, "seed": seed}
    try:
        return list(checked_points(config, EXPERIMENT).values())
    except SceneError as error:
        key = error.key.removeprefix(f"experiments.{EXPERIMENT}")
        key = f"over{key.removeprefix('.grid')}" if key.startswith(".grid") else key.lstrip(".")
        raise SceneError(key, error.value, error.rule, error.file) from None


def _run(planned: list[Point], workers: int, progress: Progress, overwrite: bool) -> None:
    """Make the trajectories of all points, in this process or in several."""
    if workers == 1:
        for done, point in enumerate(planned, 1):
            _make(point.to_dict(), overwrite)
            progress(done, len(planned), point.name)
        return
    for one in {variant(point): point for point in planned}.values():  # or each process would compile them
        warm(task(one))
    with ThreadPoolExecutor(workers) as pool:
        try:
            futures = {pool.submit(_in_process, point, overwrite): point for point in planned}
            for done, future in enumerate(as_completed(futures), 1):
                future.result()
                progress(done, len(planned), futures[future].name)
        except BaseException:  # processes that run have had the same signal, and end after a checkpoint
            pool.shutdown(cancel_futures=True)
            raise


def _in_process(point: Point, overwrite: bool) -> None:
    """`_make` in a process of its own, which, unlike those of a pool, does not run the caller's script again.
    Raises what that raised."""
    command = [sys.executable, "-m", "gaspart.reproduction.sweep"]
    given = pickle.dumps((point.to_dict(), overwrite))
    done = subprocess.run(command, input=given, stdout=subprocess.PIPE, check=False)
    if done.returncode:
        code = f"ended with code {done.returncode}"
        raise SimulationError(f"{EXPERIMENT}[{point.name}]: the process of the run {code}")
    if error := pickle.loads(done.stdout):
        raise error


def _serve() -> None:
    """Make the point that the standard input states, and write the error that it raised, or None."""
    exit_on_signals()
    load_numba(ours=True)
    error = None
    try:
        _make(*pickle.load(sys.stdin.buffer))
    except (SceneError, SimulationError) as raised:
        error = raised
    pickle.dump(error, sys.stdout.buffer)


def _make(values: dict, overwrite: bool) -> None:
    """Make the trajectories of a point, or check that those in its folder are these. Raises SceneError."""
    point = Point.from_dict(values)
    parameters, folder, record = point.parameters, Path(point.path), _RECORD[point.job]
    try:
        if not folder.exists():
            return write_replicas(record, parameters, folder)
        for path, seed in zip(replica_paths(parameters, folder), parameters["seeds"], strict=True):
            record(parameters, tuple(seed), path, overwrite)
    except SceneError as error:
        raise error.inside(f"{EXPERIMENT}[{point.name}]") from None


def _print(done: int, points: int, name: str) -> None:
    print(f"{done} of {points} points: {name}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    _serve()
