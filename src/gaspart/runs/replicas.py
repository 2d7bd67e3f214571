"""The replicas of a run, each in a process of its own.

What they have to know of each other they read from their files (`gaspart.trajectory.replicas`): this module
begins the processes, and gathers their progress.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeAlias

from gaspart.accuracy.reached import AccuracyStatus, Examiner
from gaspart.errors import SceneError, SimulationError
from gaspart.files import output_path
from gaspart.interruption import set_note
from gaspart.kernels.compile.loading import load_numba
from gaspart.trajectory import run as trajectory
from gaspart.trajectory.partial import partial_path
from gaspart.trajectory.recipe import Recipe
from gaspart.trajectory.replicas import beside, path_of_all, replica_paths
from gaspart.trajectory.run import WriteOptions, begun
from gaspart.workers import Lost, in_processes, require_processes

Examined: TypeAlias = "Callable[[list[AccuracyStatus]], None] | None"
Send: TypeAlias = Callable[[Any], None]


def record_together(
    recipes: Sequence[Recipe], path: str | Path, options: WriteOptions, examined: Examined = None
) -> Path:
    """Make the trajectories of all replicas of a run at `path`; returns `path`.

    What is raised is that of one run (`gaspart.trajectory.run.record`), and SimulationError for a process
    that something has ended.
    """
    path = output_path(path)
    files = replica_paths(path, len(recipes))
    _carry_out(_record, list(zip(recipes, files, strict=True)), path, options, examined)
    return path


def resume_together(
    file: Path, recipe: Recipe, options: WriteOptions, examined: Examined, duration: float | None
) -> Path:
    """Finish all replicas of a run, of which `recipe` is that of the one in a file, or continue them to a
    duration; returns the path of all. Raises as `gaspart.trajectory.run.resume` and `extend`."""
    path, all_of_them = path_of_all(file, recipe), beside(file, recipe)
    if duration is not None:
        _carry_out(_extend, [(duration, one) for one, _ in all_of_them], path, options, examined)
        return path
    unfinished = [partial for one, _ in all_of_them if (partial := partial_path(one)).exists()]
    for partial in unfinished:
        begun(partial)
    if not unfinished and all(one.exists() for one, _ in all_of_them):
        raise SceneError("path", str(path), "is already complete, in all of its replicas")
    return record_together([one for _, one in all_of_them], path, options, examined)


def _carry_out(
    function: Callable[..., None],
    calls: Sequence[tuple],
    path: Path,
    options: WriteOptions,
    examined: Examined,
) -> None:
    """Call a function of `send`, its arguments, options and whether progress is shown, for all replicas."""
    reached: dict[int, tuple[float, float, int]] = {}

    def received(number: int, message: Any) -> None:
        if isinstance(message, list):
            if examined and number == 0:  # the others say the same
                examined(message)
            return
        reached[number] = message
        if options.progress and len(reached) == len(calls):
            times, durations, collisions = zip(*reached.values(), strict=True)
            options.progress(sum(times) / len(times), max(durations), sum(collisions))

    def finished(number: int, result: Any) -> None:
        if isinstance(result, Lost):
            rule = f"replica {number + 1} of {path}: {result}; the same command continues it"
            raise SimulationError(rule)

    require_processes("replicas", len(calls))
    plain = replace(options, progress=None, examiner=None), options.progress is not None
    set_note("the same command continues it")
    in_processes(function, [(*call, *plain) for call in calls], len(calls), finished, received)
    set_note("")


def _record(send: Send, recipe: Recipe, path: Path, options: WriteOptions, shown: bool) -> None:
    """Make one of the replicas."""
    load_numba(ours=True)
    trajectory.record(recipe, path, _sending(options, send, shown))


def _extend(send: Send, duration: float, path: Path, options: WriteOptions, shown: bool) -> None:
    """Continue one of the replicas."""
    load_numba(ours=True)
    trajectory.extend(path, duration, _sending(options, send, shown))


def _sending(options: WriteOptions, send: Send, shown: bool) -> WriteOptions:
    """The options of a process that sends what its examinations give, and its progress."""
    progress = (lambda *reached: send(reached)) if shown else None
    return replace(options, progress=progress, examiner=Examiner(send))
