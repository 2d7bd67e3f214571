"""The functions `gaspart.run` and `gaspart.resume`.

Both functions run scenes for a duration or until observables are accurate, also as replicas.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from gaspart.accuracy.reached import AccuracyStatus, Examiner
from gaspart.engines import Engine, resolve_engine
from gaspart.errors import SceneError
from gaspart.files import is_same_file, output_path
from gaspart.keys.kinds import field_values
from gaspart.keys.values import count_of
from gaspart.runs.ending import (
    Accuracy,
    contents_until,
    default_sample_interval,
    require_reachable,
)
from gaspart.runs.replicas import record_together, resume_together
from gaspart.scene.scene import Scene, require_scene
from gaspart.state.optional_tallies import OptionalTally
from gaspart.state.state import State
from gaspart.trajectory import run as trajectory
from gaspart.trajectory.correlator import Correlations
from gaspart.trajectory.export import last_state
from gaspart.trajectory.opening import checkpoint_path, partial_path
from gaspart.trajectory.recipe import MOST_REPLICAS, Recipe
from gaspart.trajectory.recording import Progress
from gaspart.trajectory.replicas import find_run, in_replicas, replica_paths
from gaspart.trajectory.run import WriteOptions
from gaspart.trajectory.run_options import Contents, Until


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
    tallies: Iterable[OptionalTally] = (),
    initial: State | str | Path | None = None,
    checkpoint_seconds: float = 30.0,
    progress: Progress | None = None,
    examined: Callable[[list[AccuracyStatus]], None] | None = None,
    overwrite: bool = False,
    keep_checkpoint: bool = False,
    replicas: int = 1,
) -> Path:
    """Run a scene and write its trajectory to a file.

    The run ends after `duration`, or, with `until`, when all requested accuracies are reached. If an
    interrupted run with the same settings and program version is at `path`, it is continued. If a complete
    run with the same settings is at `path`, nothing is changed.

    If contacts are rough, the file also contains spins. After SIGINT or SIGTERM a checkpoint is written
    before the handlers of the caller are executed.

    Parameters
    ----------
    scene : Scene
        The scene to simulate.
    engine : Engine or {"event", "step", "dsmc"}, optional
        Engine, or the name of an engine with default settings. Default: event-driven.
    seed : int or tuple of int, default 0
        Seed of the initial state and of all random numbers of the run.
    duration : float, [time], optional
        Length of the run; must be an integer multiple of `sample_interval`. Cannot be combined with `until`.
    sample_interval : float, [time], optional
        Time between frames; the first frame is at time 0. Default with `until`: the mean time between
        collisions of a particle.
    path : str or Path
        The trajectory file (AMBER netCDF).
    until : Accuracy or sequence of Accuracy, optional
        Requested relative standard errors, standard error / |value|. The accuracies are tested at 64, 96,
        128 ... frames (see `reached_accuracy`).
    at_most : float, [time], optional
        Maximum length of a run with `until`. Default: no maximum, but the run ends if there is no contact in
        its first 16384 frames.
    displacements : bool, default False
        Also store the unwrapped displacement of each particle since time 0, in float64.
    follow : int, optional
        Store only the first `follow` particles. Numbers of collisions and other totals still include all
        particles.
    keep : {"positions", "velocities"}, optional
        Store only positions or only velocities. Default: both.
    correlations : Correlations, optional
        Time correlations to accumulate. Each frame stores sums over all pairs of samples since the start:
        sums for the velocity autocorrelation and, with `displacements`, for the mean-squared displacement;
        with ``Correlations(stress=True)``, sums for the stress tensor and the heat flux instead.
    pairs : bool, default False
        Store in each frame the number of collisions of each pair of species.
    tallies : iterable of OptionalTally, optional
        Optional sums to store: ``ImpulseTally("z", 200)`` for densities and pressures,
        ``PairImpulseTally(3.0, 300, 0.5)`` for g(r). They are more accurate than counts.
    initial : State, str or Path, optional
        Initial state: a state, the last state of a trajectory (`last_state`), or a GSD or XYZ file
        (`read_state`). The particles and the size of the container must be the same as in `scene`. Default
        settings of engines are still computed from the speeds or temperatures of `scene`.
    checkpoint_seconds : float, default 30.0
        Wall-clock time between checkpoints, in seconds.
    progress : callable, optional
        Function that is called as ``progress(time, duration, collisions)`` about twice per second.
    examined : callable, optional
        Function that is called with the list of `AccuracyStatus` after each test of `until`.
    overwrite : bool, default False
        Replace another trajectory at `path`. Files of other kinds are never replaced.
    keep_checkpoint : bool, default False
        Store the final state in ``<path>.checkpoint.npz``.
    replicas : int, default 1
        Number of independent simultaneous runs, one process each. Run k has the seed ``(seed, k)``. For the
        path ``run.nc``, its file is ``run-k.nc`` (`replica_paths`). With `until` all runs end when their mean
        has reached the accuracies.

    Returns
    -------
    Path
        `path`.

    Raises
    ------
    SceneError
        If settings or measurements are impossible, or a file cannot be read or written.
    SimulationError
        If an invariant is violated during the run. The state is saved in ``<path>.failed.npz``.

    See Also
    --------
    resume : Finish or extend a run.
    open_trajectory : Open the file as an xarray.Dataset.
    Simulation : Advance a scene without a file.

    Examples
    --------
    >>> import gaspart as gp
    >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)])
    >>> path = gp.run(scene, seed=1, duration=2.0, sample_interval=0.1, path="gas.nc")
    >>> with gp.open_trajectory(path) as trajectory:
    ...     trajectory.sizes["frame"]
    21
    """
    asked = locals()  # by the names that `Contents`, `Recipe` and `WriteOptions` give them
    require_scene(scene)
    engine = resolve_engine(engine)
    request = _request(duration, sample_interval, until, at_most)
    contents = Contents(**_fields_among(Contents, asked))
    if request is not None:
        contents = contents_until(request, scene, engine, contents, from_state=initial is not None)
        contents = _with_useful_tally(contents, request, scene, engine)
    asked |= field_values(contents)
    asked |= {"engine": engine, "until": request, "initial": _start(initial, scene, path, replicas, seed)}
    if sample_interval is None:
        asked["sample_interval"] = default_sample_interval(scene, engine, correlations)
    recipes = _in_replicas(Recipe(**_fields_among(Recipe, asked)), replicas)
    options = WriteOptions(examiner=Examiner(examined), **_fields_among(WriteOptions, asked))
    if len(recipes) > 1:
        return record_together(recipes, _require_path(path), options, examined)
    return trajectory.record(recipes[0], _require_path(path), options)


def _fields_among(kind: Any, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values, by name, that are fields of a dataclass."""
    return {item.name: values[item.name] for item in fields(kind) if item.name in values}


def _in_replicas(recipe: Recipe, replicas: int) -> list[Recipe]:
    """Return the recipes of the replicas of a run. Raises SceneError under the same conditions as
    `in_replicas`, and for an accuracy that the mean of the replicas can never reach.
    """
    recipes, until = in_replicas(recipe, replicas), recipe.until
    if until is not None and until.at_most is None and recipe.initial is None:
        for requirement in until.accuracies:
            require_reachable(requirement, recipe.scene, replicas)
    return recipes


def _with_useful_tally(contents: Contents, request: Until, scene: Scene, engine: Engine) -> Contents:
    """Add the tally that makes the requested accuracies cheaper, if there is such a tally."""
    from gaspart.accuracy.target import Target  # this loads the analysis, which few runs need

    useful = (
        tally
        for requirement in request.accuracies
        for tally in Target(scene, requirement.observable, requirement.face).tallies(engine)
    )
    present = {tally.name for tally in contents.tallies}
    first = next((tally for tally in useful if tally.name not in present), None)
    return replace(contents, tallies=(*contents.tallies, first)) if first else contents


def _start(
    initial: State | str | Path | None,
    scene: Scene,
    path: str | Path | None,
    replicas: int,
    seed: int | tuple[int, ...],
) -> State | None:
    """Return the initial state of a run; for a file, its last state. Raises SceneError if this file is one of
    the files of the run at `path`, even under another name, because the run would overwrite it.
    """
    paths = replica_paths(_require_path(path), count_of("replicas", replicas, least=1, most=MOST_REPLICAS))
    if not isinstance(initial, str | Path):
        return initial
    from gaspart.inspection.readers import STARTS, read_state  # few runs need this

    for output in map(output_path, paths):
        for target in (output, partial_path(output), checkpoint_path(output)):
            if is_same_file(initial, target):
                rule = f"is the file that is to be written, {output}: choose another name for the new run"
                raise SceneError("initial", str(initial), rule)
    return read_state(initial, scene, seed) if Path(initial).suffix in STARTS else last_state(initial)


def _require_path(path: str | Path | None) -> str | Path:
    """Return the path of a trajectory; raise an error without one."""
    if path is None:
        raise SceneError("path", None, "must be given: the file of the trajectory")
    return path


def _request(
    duration: float | None,
    sample_interval: float | None,
    until: Accuracy | list[Accuracy] | tuple[Accuracy, ...] | None,
    at_most: float | None,
) -> Until | None:
    """Return the accuracies that end a run, or None for a run with a duration. Raises SceneError for
    arguments that exclude or require each other.
    """
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
    """Finish an interrupted run, or extend a complete run, from its files only.

    Without a `duration` the interrupted run whose file is ``<path>.partial`` is continued to its end. With a
    `duration` the complete run at `path` is continued to that time.

    The file of an extended run has the same bytes as the file of a single run of this duration. If the run
    was made with `keep_checkpoint`, the extension starts from its final state, and the extended run has a
    checkpoint, too. Otherwise the whole run is repeated from its start. The file is replaced when the longer
    run is complete. To finish an interrupted extension, call `resume` with or without `duration`.

    Parameters
    ----------
    path : str or Path
        The trajectory. If the file is one of several replicas, all replicas are finished together.
    checkpoint_seconds : float, default 30.0
        Wall-clock time between checkpoints, in seconds.
    progress : callable, optional
        Function that is called as ``progress(time, duration, collisions)`` about twice per second.
    examined : callable, optional
        Function that is called with the list of `AccuracyStatus` after each test of `until`.
    duration : float, [time], optional
        New length of a complete run.
    keep_checkpoint : bool, default False
        Store the final state in ``<path>.checkpoint.npz``.

    Returns
    -------
    Path
        `path`.

    Raises
    ------
    SceneError
        If there is nothing to resume or to extend, if another version of the program began the run, if the
        duration is not longer, or if the file at `path` is not a complete trajectory of gaspart.
    SimulationError
        If an invariant is violated during the run.

    See Also
    --------
    run : Begin a run.

    Examples
    --------
    >>> import gaspart as gp
    >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)])
    >>> path = gp.run(scene, seed=1, duration=2.0, sample_interval=0.1, path="gas.nc")
    >>> path = gp.resume(path, duration=3.0)
    >>> with gp.open_trajectory(path) as trajectory:
    ...     trajectory.sizes["frame"]
    31
    """
    options = WriteOptions(
        checkpoint_seconds, progress, examiner=Examiner(examined), keep_checkpoint=keep_checkpoint
    )
    if replica := _replica(path):
        return resume_together(*replica, options, examined, duration)
    if duration is None:
        return trajectory.resume(path, options)
    return trajectory.extend(path, duration, options)


def _replica(path: str | Path) -> tuple[Path, Recipe] | None:
    """Return a file of the replicas at a path, and its recipe, or None."""
    with suppress(SceneError):
        file, recipe = find_run(path)
        return (file, recipe) if recipe.replica else None
    return None
