"""`gaspart.run` and `gaspart.resume`: runs of a duration, or until they are accurate, also replicas."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from gaspart.accuracy.reached import AccuracyStatus, Examiner
from gaspart.analysis.observables import OBSERVABLES
from gaspart.engines import Engine, chosen
from gaspart.errors import SceneError
from gaspart.files import is_same_file, output_path
from gaspart.keys.values import count_of
from gaspart.runs.ending import (
    Accuracy,
    default_sample_interval,
    require_end,
    require_measurable,
    require_reachable,
)
from gaspart.runs.replicas import record_together, resume_together
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
from gaspart.trajectory.until import Until


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
    return _record(_in_replicas(recipe, replicas), _required(path), options, examined)


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

    each = (Target(scene, asked.observable, asked.face).tallies(engine) for asked in wanted.accuracies)
    return next(filter(None, each), ())


def _in_replicas(recipe: Recipe, replicas: int) -> list[Recipe]:
    """Return the recipes of the replicas of a run. Raises SceneError as `in_replicas`, and for an accuracy
    that their mean never reaches."""
    recipes, until = in_replicas(recipe, replicas), recipe.until
    if until is not None and until.at_most is None and recipe.initial is None:
        for asked in until.accuracies:
            require_reachable(asked, recipe.scene, replicas)
    return recipes


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
