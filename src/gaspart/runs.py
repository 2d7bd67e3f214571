"""`gaspart.run`, `gaspart.resume` and `gaspart.Accuracy`: runs of a duration, or until they are accurate.

The rule that ends a run is in `gaspart.accuracy.reached`; this module refuses what no run can reach.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Self

from gaspart.accuracy.reached import AccuracyStatus, Examiner
from gaspart.accuracy.steady import require_steady
from gaspart.analysis.observables import (
    OBSERVABLES,
    having,
    require_modelled,
    require_run,
    require_steady_value,
    walls_of,
)
from gaspart.engines import Engine, chosen
from gaspart.errors import SceneError, unknown_word
from gaspart.files import is_same_file, output_path
from gaspart.keys.values import count_of
from gaspart.replicas import record_together, resume_together
from gaspart.scene.scene import Scene, require_scene
from gaspart.state.optional_tallies import OptionalTally, impulse_tallies, pair_impulse_tallies
from gaspart.state.state import State
from gaspart.trajectory import run as trajectory
from gaspart.trajectory.checkpoint import checkpoint_path
from gaspart.trajectory.correlator import Correlations
from gaspart.trajectory.last_state import last_state
from gaspart.trajectory.partial import partial_path
from gaspart.trajectory.recipe import MOST_REPLICAS, Recipe
from gaspart.trajectory.recording import Progress
from gaspart.trajectory.replicas import found, in_replicas, replica_paths
from gaspart.trajectory.run import WriteOptions
from gaspart.trajectory.until import Requirement, Until


class Accuracy(Requirement):
    """The accuracy that a run is to reach: standard error / |value| of an observable.

    observable: Z, D, collision_rate, pressure, heat_flux, wall_shear, density, velocity or shear_viscosity,
    as `gaspart measure` names them; accuracy: relative, of one standard error that includes correlations; of
    those with components that vanish, and of a profile, relative to their root mean square; start: the time
    from which frames count, by default a quarter of the run; face: of one of the walls (`x low`), by default
    each of them. A run until the density is accurate keeps impulses, where its engine can and they serve.
    Raises SceneError for other values.
    """

    def __post_init__(self) -> None:
        able = having(ends_runs=True)
        if self.observable not in able:
            rule = unknown_word(self.observable, able, "observable")
            raise SceneError("until.observable", self.observable, rule)
        super().__post_init__()
        if self.face is not None and "face" not in OBSERVABLES[self.observable].along:
            raise SceneError("until.face", self.face, f"has no meaning for {self.observable}")

    @classmethod
    def named(cls, name: str, accuracy: float, start: float | None = None) -> Self:
        """From its `name`, as on the command line and in a config: `Z`, or `pressure:x low`."""
        observable, colon, face = name.partition(":")
        return cls(observable.strip(), accuracy, start, face if colon else None)


def run(
    scene: Scene,
    engine: Engine | str | None = None,
    seed: int | tuple[int, ...] = 0,
    duration: float | None = None,
    sample_interval: float | None = None,
    path: str | Path | None = None,
    *,
    until: Accuracy | list[Accuracy] | tuple[Accuracy, ...] | None = None,
    at_most: float | None = None,
    displacements: bool = False,
    follow: int | None = None,
    keep: str | None = None,
    correlations: Correlations | None = None,
    pairs: bool = False,
    impulses: str | None = None,
    pair_impulses: str | None = None,
    initial: State | str | Path | None = None,
    checkpoint_seconds: float = 30.0,
    progress: Progress | None = None,
    examined: Callable[[list[AccuracyStatus]], None] | None = None,
    overwrite: bool = False,
    keep_checkpoint: bool = False,
    replicas: int = 1,
) -> Path:
    """Run a scene and write its trajectory to `path`; returns `path`.

    engine: event-driven, or as `Simulation` takes it, like the seed. A frame at time 0 and at every
    sample_interval to the duration, an integer multiple of it; with `displacements` also each particle's
    float64 way since time 0, unwrapped; with rough contacts also spins; with `follow` only so many particles,
    from the first on (counters are those of all), with `keep` only their "positions" or "velocities". With
    `correlations` each frame has the sums so far of the velocities' correlations, and with `displacements` of
    the mean-squared displacement, over all pairs of samples, or with `Correlations(stress=True)` those of the
    stress tensor and the heat flux. With `pairs` each frame counts the collisions of each pair of species;
    `impulses`, such as "z:200", and `pair_impulses`, such as "3:300:0.5" (distance, shells, share of
    contacts), keep what a more accurate density along z and g(r) need (event-driven). A run of this recipe
    and program that was cut short is continued, a complete one not changed; another trajectory is replaced
    only with `overwrite`, another file never. `keep_checkpoint`: `path.checkpoint.npz` has the last state.

    initial: a `State`, a trajectory (its `last_state`), or a GSD or XYZ file (`read_state`) to start from.
    Particles and container size must be the scene's; defaults of engines follow from the scene's `speed` or
    `temperature` all the same. until: the run ends when standard error / |value| of all these observables is
    as small as required, examined at 64, 96, 128 ... frames (`gaspart.reached_accuracy`), or after at_most,
    by default 16384 frames without a contact; sample_interval is then the mean time between collisions.
    replicas: so many runs are made at a time, a process each, `run-1.nc`, `run-2.nc` ... of `run.nc`
    (`gaspart.replica_paths`), of the seed with 1, 2 ... behind it; until their mean is as accurate.

    `progress(time, duration, collisions)` is called about twice a second, `examined(reached)` then. SIGINT
    and SIGTERM take effect after a checkpoint, before the caller's handlers. Raises SceneError for settings,
    files and measurements that cannot be; SimulationError for a broken invariant (`path.failed.npz`)."""
    engine = _engine_of(scene, engine)
    wanted = _request(duration, sample_interval, until, at_most)
    displacements |= _needs_paths(wanted, scene, engine, follow, correlations, initial)
    if sample_interval is None:
        sample_interval = default_sample_interval(scene, engine, correlations)
    settings = scene, engine, seed, duration, sample_interval, displacements, follow, correlations, wanted
    tallies = *_tallies(impulses, wanted, scene, engine), *pair_impulse_tallies(pair_impulses)
    recipe = Recipe(*settings, pairs, _start(initial, scene, path, replicas), tallies, keep=keep)
    options = WriteOptions(checkpoint_seconds, progress, overwrite, Examiner(examined), keep_checkpoint)
    return _record(in_replicas(recipe, replicas), _required(path), options, examined)


def _engine_of(scene: object, engine: Engine | str | None) -> Engine:
    """The engine of a run (`chosen`). Raises SceneError for it, and for what is no scene."""
    require_scene(scene)
    return chosen(engine)


def _tallies(
    impulses: str | None, wanted: Until | None, scene: Scene, engine: Engine
) -> tuple[OptionalTally, ...]:
    """The optional tallies that are asked for, or else those that make what is wanted more accurate."""
    if impulses is not None or wanted is None:
        return impulse_tallies(impulses)
    from gaspart.accuracy.target import Target  # loads the analysis, which few runs need

    each = (Target(scene, asked.observable).tallies(engine) for asked in wanted.accuracies)
    return next(filter(None, each), ())


def _record(
    recipes: list[Recipe],
    path: str | Path,
    options: WriteOptions,
    examined: Callable[[list[AccuracyStatus]], None] | None,
) -> Path:
    """Make the trajectory of a recipe, or those of all replicas."""
    if len(recipes) > 1:
        return record_together(recipes, path, options, examined)
    return trajectory.record(recipes[0], path, options)


def _needs_paths(
    wanted: Until | None,
    scene: Scene,
    engine: Engine,
    follow: int | None,
    correlations: Correlations | None,
    initial: State | str | Path | None,
) -> bool:
    """Whether what is to be accurate needs displacements, of a run from a given state if there is one. Raises
    SceneError for what cannot be measured, or never becomes known."""
    if wanted is None:
        return False
    for asked in wanted.accuracies:
        require_measurable(asked, scene, engine, follow, correlations)
        require_end(asked, scene, wanted.at_most, initial is not None)
    return any(OBSERVABLES[asked.observable].needs == "paths" for asked in wanted.accuracies)


def _start(
    initial: State | str | Path | None, scene: Scene, path: str | Path | None, replicas: int
) -> State | None:
    """The initial state of a run: of a file its last state. Raises SceneError if that is one of the files at
    `path`, by whatever name: it would be lost."""
    paths = replica_paths(_required(path), count_of("replicas", replicas, least=1, most=MOST_REPLICAS))
    if not isinstance(initial, str | Path):
        return initial
    from gaspart.inspection.start import STARTS, read_state  # which few runs need

    for output in map(output_path, paths):
        for place in (output, partial_path(output), checkpoint_path(output)):
            if is_same_file(initial, place):
                rule = f"is the file that is to be written, {output}: choose another name for the new run"
                raise SceneError("initial", str(initial), rule)
    return read_state(initial, scene) if Path(initial).suffix in STARTS else last_state(initial)


def _required(path: str | Path | None) -> str | Path:
    if path is None:
        raise SceneError("path", None, "must be given: the file of the trajectory")
    return path


def _request(
    duration: float | None,
    sample_interval: float | None,
    until: Accuracy | list[Accuracy] | tuple[Accuracy, ...] | None,
    at_most: float | None,
) -> Until | None:
    """The end of a run without a duration. Raises SceneError for what excludes or needs each other."""
    if until is not None:
        if duration is not None:
            rule = "excludes until, which ends the run; the longest duration is at_most"
            raise SceneError("duration", duration, rule)
        return Until(tuple(until) if isinstance(until, (list, tuple)) else (until,), at_most)
    if at_most is not None:
        raise SceneError("at_most", at_most, "needs until; without it give duration")
    if duration is None:
        raise SceneError("duration", None, "must be given, or until")
    if sample_interval is None:
        raise SceneError("sample_interval", None, "must be given with a duration")
    return None


def resume(
    path: str | Path,
    checkpoint_seconds: float = 30.0,
    progress: Progress | None = None,
    examined: Callable[[list[AccuracyStatus]], None] | None = None,
    *,
    duration: float | None = None,
    keep_checkpoint: bool = False,
) -> Path:
    """Finish the run that left `path.partial`, from its files only; returns `path`. Replicas, of which it may
    be one, are finished together.

    With a `duration`, the complete run at `path` goes on to that time, and its file is then the one of a run
    of this duration in one go, to the same bytes. It continues from the state at its end if the run had
    `keep_checkpoint`, which the extended one then has too; otherwise it is run again from its start. The
    file is replaced when the longer run is complete; one that was cut short is finished by either form.

    The other arguments as of `run`. Raises SceneError if there is nothing to resume or to extend, if another
    version of the program began it, for a duration that is not longer, and for a file at `path` that is no
    complete trajectory of gaspart.
    """
    examiner = Examiner(examined)
    options = WriteOptions(checkpoint_seconds, progress, False, examiner, keep_checkpoint)
    if replica := _replica(path):
        return resume_together(*replica, options, examined, duration)
    if duration is None:
        return trajectory.resume(path, options)
    return trajectory.extend(path, duration, options)


def _replica(path: str | Path) -> tuple[Path, Recipe] | None:
    """A file of the replicas at a path and its recipe; None if there are none."""
    with suppress(SceneError):
        file, recipe = found(path)
        return (file, recipe) if recipe.replica else None
    return None


def require_measurable(
    asked: Requirement,
    scene: Scene,
    engine: Engine,
    follow: int | None = None,
    correlations: Correlations | None = None,
) -> None:
    """Raise SceneError for an observable that a scene does not have, however long the run, of which a run by
    an engine says nothing, or for which this run does not keep what it needs."""
    walls = walls_of(asked.observable, scene)
    kept = ("fluxes",) if correlations is not None and correlations.stress else ()
    try:
        require_run(asked.observable, scene, kept, follow)
        require_steady_value(asked.observable, scene)
        require_modelled(asked.observable, scene, engine)
    except SceneError as error:
        raise SceneError("until", asked.name, f"{error.key}: {error.rule}") from None
    if asked.face not in (None, *walls):
        raise SceneError("until", asked.name, f"the walls are {', '.join(walls)}")


def require_end(asked: Requirement, scene: Scene, at_most: float | None, given: bool) -> None:
    """Raise SceneError for a run in which nothing ever happens, and, without a longest duration, for one that
    comes to no steady state. given: whether it starts from a given state."""
    kinds = [kind for kind in scene.kinds if kind.count]
    if not kinds:
        return  # which the recipe refuses
    moving = given or any(kind.initial_temperature(scene.dimension) > 0.0 for kind in kinds)
    driven = scene.gravity or scene.thermostat or any(face.moves for face in scene.faces.values())
    if not moving and not driven:
        raise SceneError("until", asked.name, "never becomes known: nothing moves")
    if scene.count == 1 and "face" not in OBSERVABLES[asked.observable].along:
        raise SceneError("until", asked.name, "never becomes known: a single particle meets no other")
    if at_most is None:
        try:
            require_steady(scene)
        except SceneError as error:
            rule = f"{error.key}: {error.rule}, or a longest one (at_most)"
            raise SceneError("until", asked.name, rule) from None


def default_sample_interval(scene: Scene, engine: Engine, correlations: Correlations | None) -> float:
    """The mean time between two collisions of a particle, or else to cross the container, to two digits, as a
    multiple of the engine's steps and the samples of correlations. Raises SceneError if nothing moves."""
    from gaspart.accuracy.scales import scales, two_digits

    shortest = scales(scene).event_time
    if not math.isfinite(shortest):
        raise SceneError("sample_interval", None, "must be given: nothing moves at the start")
    interval = two_digits(shortest)
    unit = correlations.interval if correlations else engine.quantum
    if unit is None:
        return interval
    return max(1, round(interval / unit)) * unit
