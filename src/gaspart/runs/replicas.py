"""Replicas of a run in separate processes.

The processes of the replicas exchange all information through their files (`gaspart.trajectory.replicas`).
This module starts the processes and collects their progress.
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
from gaspart.kernels.compile.cache import load_numba
from gaspart.trajectory import run as trajectory
from gaspart.trajectory.opening import partial_path
from gaspart.trajectory.recipe import Recipe
from gaspart.trajectory.replicas import beside, path_of_all, replica_paths
from gaspart.trajectory.run import WriteOptions, begun
from gaspart.workers import Lost, in_processes

Examined: TypeAlias = "Callable[[list[AccuracyStatus]], None] | None"
Send: TypeAlias = Callable[[Any], None]


def record_together(
    recipes: Sequence[Recipe], path: str | Path, options: WriteOptions, examined: Examined = None
) -> Path:
    """Record the trajectories of all replicas of a run at `path`."""
    path = output_path(path)
    files = replica_paths(path, len(recipes))
    _carry_out(_record, list(zip(recipes, files, strict=True)), path, options, examined)
    return path


def resume_together(
    file: Path, recipe: Recipe, options: WriteOptions, examined: Examined, duration: float | None
) -> Path:
    """Finish all replicas of a run, or continue them to a duration."""
    path, replicas = path_of_all(file, recipe), beside(file, recipe)
    if duration is not None:
        _carry_out(
            _extend, [(duration, replica_file) for replica_file, _ in replicas], path, options, examined
        )
        return path
    unfinished = [partial for replica_file, _ in replicas if (partial := partial_path(replica_file)).exists()]
    for partial in unfinished:
        begun(partial)
    if not unfinished and all(replica_file.exists() for replica_file, _ in replicas):
        raise SceneError("path", str(path), "is already complete, in all of its replicas")
    return record_together([replica_recipe for _, replica_recipe in replicas], path, options, examined)


def _carry_out(
    function: Callable[..., None],
    calls: Sequence[tuple],
    path: Path,
    options: WriteOptions,
    examined: Examined,
) -> None:
    """Call a function for all replicas in separate processes. The function is called with `send`, the
    arguments in `calls` for one replica, the options, and True if it must report progress.
    """
    reached: dict[int, tuple[float, float, int]] = {}

    def receive(number: int, message: Any) -> None:
        if isinstance(message, list):
            if examined and number == 0:  # the other replicas report the same result
                examined(message)
            return
        reached[number] = message
        if options.progress and len(reached) == len(calls):
            times, durations, collisions = zip(*reached.values(), strict=True)
            options.progress(sum(times) / len(times), max(durations), sum(collisions))

    def finish(number: int, result: Any) -> None:
        if isinstance(result, Lost):
            rule = f"replica {number + 1} of {path}: {result}; the same command continues it"
            raise SimulationError(rule)

    plain = replace(options, progress=None, examiner=None), options.progress is not None
    set_note("the same command continues it")
    in_processes(function, [(*call, *plain) for call in calls], len(calls), finish, receive)
    set_note("")


def _record(send: Send, recipe: Recipe, path: Path, options: WriteOptions, with_progress: bool) -> None:
    """Record the trajectory of a replica."""
    load_numba(ours=True)
    trajectory.record(recipe, path, _sending(options, send, with_progress))


def _extend(send: Send, duration: float, path: Path, options: WriteOptions, with_progress: bool) -> None:
    """Continue the trajectory of a replica."""
    load_numba(ours=True)
    trajectory.extend(path, duration, _sending(options, send, with_progress))


def _sending(options: WriteOptions, send: Send, with_progress: bool) -> WriteOptions:
    """Return options that make a process send its progress and the results of its tests."""
    progress = (lambda *reached: send(reached)) if with_progress else None
    return replace(options, progress=progress, examiner=Examiner(send))
