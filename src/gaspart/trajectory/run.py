"""Trajectories: written during the run, continued after a kill, readable by common tools.

A run writes `path.partial`, and regularly `path.checkpoint.npz`, from which it can continue to the same bits.
When it is complete, the file is renamed to `path`. Nothing in it depends on when or where it was made.
A checkpoint that is kept is then the state at the end, from which a longer run continues (`extension`).
"""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import BinaryIO

from gaspart.errors import SceneError
from gaspart.files import OVERWRITE, may_replace, open_regular, output_path, place
from gaspart.keys.values import number
from gaspart.simulation import Simulation
from gaspart.trajectory import amber, provenance
from gaspart.trajectory.checkpoint import (
    CHECKPOINT,
    checkpoint_path,
    kept_beside,
    read_checkpoint,
    remove_checkpoint,
)
from gaspart.trajectory.extension import is_beginning, longer, take_over
from gaspart.trajectory.frames import Frames, frame_count
from gaspart.trajectory.opening import check_frames, checked, run_path
from gaspart.trajectory.partial import TRAJECTORY, locked, partial_path, writing
from gaspart.trajectory.recipe import Recipe, begun_as, read_recipe, stored_revision
from gaspart.trajectory.recording import Progress, Recording
from gaspart.trajectory.stage import Examiner, examination, is_complete, is_finished


@dataclass(frozen=True)
class WriteOptions:
    """How a trajectory is written: nothing in it depends on these options.

    checkpoint_seconds: between checkpoints; overwrite: whether another run's file may be replaced; examiner:
    for a recipe that ends when it is accurate; keep_checkpoint: whether the last one stays beside the file.
    Raises SceneError for a negative time.
    """

    checkpoint_seconds: float = 30.0
    progress: Progress | None = None
    overwrite: bool = False
    examiner: Examiner | None = None
    keep_checkpoint: bool = False

    def __post_init__(self) -> None:
        number("checkpoint_seconds", self.checkpoint_seconds, "must not be negative", least=0.0)


def record(wanted: Recipe, path: str | Path, options: WriteOptions) -> Path:
    """Make the trajectory of a recipe at `path`; returns `path`.

    What is raised is that of `gaspart.run` (`gaspart.runs`).
    """
    path = output_path(path)
    if path.suffix != ".nc" and not path.is_dir():  # `gaspart check` knows the format by it
        raise SceneError("path", str(path), "must end in .nc: a trajectory is a netCDF file")
    return _carry_out(wanted, path, options)


def resume(path: str | Path, options: WriteOptions) -> Path:
    """Finish the run that left `path.partial`, from its files only; returns `path`.

    Raises SceneError if there is nothing to resume, if another version of the program began it, and for a
    file at `path` that is no complete trajectory of gaspart.
    """
    path = run_path(path)
    partial = partial_path(path)
    try:
        with writing(path):
            wanted = begun(partial)
    except SceneError:
        if partial.exists():
            raise
        # not before: another process may finish the run at any moment
        rule = f"there is no {partial.name} to continue"
        if path.exists():
            check_frames(path)  # raises SceneError for a damaged file, and one of another program
            wanted = read_recipe(path)
            with open_regular(path) as file:
                frames = frame_count(file)
            missing = f"has {frames} of {'more' if wanted.until else wanted.frames} frames, and {rule}"
            rule = "is already complete" if is_complete(wanted, path, frames, options.examiner) else missing
        raise SceneError("path", str(path), rule) from None
    return _carry_out(wanted, path, options)


def begun(partial: Path) -> Recipe:
    """The recipe of an unfinished trajectory. Raises SceneError if another version began it."""
    wanted = read_recipe(partial)
    if not begun_as(partial, wanted):
        rule = "was begun by another version of gaspart, Python or a package: start it anew"
        raise SceneError("path", str(partial), rule)
    return wanted


def extend(path: str | Path, duration: float, options: WriteOptions) -> Path:
    """Continue the complete run at `path` to a longer duration; returns `path`.

    The file has then the bytes of a run of that duration in one go. Without the checkpoint of its end, which
    `keep_checkpoint` leaves beside it, it is run again from its start; one that had it keeps the next one.
    An extension that was cut short is continued, by this or by `resume`. Raises SceneError as `longer`, for
    another run that is unfinished beside the file, and for a checkpoint that is damaged or of another run.
    """
    path = Path(path)
    partial, checkpoint = partial_path(path), checkpoint_path(path)
    if not path.exists() and partial.exists():
        rule = f"is unfinished: resume it without a duration, which {partial.name} has, before it is extended"
        raise SceneError("path", str(path), rule)
    wanted = longer(path, duration)
    if not partial.exists():
        with checked(path) as (_, header, _):
            kept_beside(path, header, "to run it again from its start")  # named here, if it is damaged
    with writing(path):
        kept = options.keep_checkpoint or checkpoint.exists()
        with locked(partial) as file:
            if amber.is_blank(file):  # this file states what is under way, whenever it is cut short
                Frames(file, wanted.layout, wanted.header(stored_revision(path)))
            elif not begun_as(partial, wanted):
                rule = "is of another unfinished run, or to another duration; resume it or move it away"
                raise SceneError("path", str(partial), rule)
    return _carry_out(wanted, path, replace(options, keep_checkpoint=kept))


def simulation_of(recipe: Recipe) -> Simulation:
    """The simulation of a recipe, at its start."""
    return Simulation(recipe.scene, recipe.engine, recipe.seed, initial=recipe.initial, tallies=recipe.asked)


def _carry_out(wanted: Recipe, path: Path, options: WriteOptions) -> Path:
    """Finish a trajectory from its present state."""
    partial, checkpoint = partial_path(path), checkpoint_path(path)
    with writing(path):
        if path.is_dir() or not os.access(path.parent, os.W_OK | os.X_OK):
            raise SceneError("path", str(path), "must be a file in an existing folder that can be written to")
        if is_finished(wanted, path, options.examiner, options.overwrite):
            if not partial.exists() and not options.keep_checkpoint:
                remove_checkpoint(checkpoint)
            return path
        may_replace(checkpoint, CHECKPOINT, overwrite=True)  # before the work; each checkpoint asks it again
        simulation = simulation_of(wanted)
        with locked(partial) as file:
            # again: another process may have finished or begun a run before the lock
            if not is_finished(wanted, path, options.examiner, options.overwrite):
                _record(wanted, simulation, file, path, options)
                file.close()  # Windows renames no open file
                place(partial, path, TRAJECTORY, options.overwrite or is_beginning(path, wanted))
                if not options.keep_checkpoint:
                    remove_checkpoint(checkpoint)
    return path


def _can_keep(partial: Path, frames: int, overwrite: bool) -> bool:
    """Whether the first frames are undamaged. Raises SceneError if not, unless they may be replaced."""
    try:
        check_frames(partial, range(frames))
    except SceneError as error:
        if overwrite:
            return False
        rule = f"{error.rule}; {OVERWRITE} to start again"
        raise SceneError("path", str(partial), rule) from None
    return True


def _record(
    wanted: Recipe,
    simulation: Simulation,
    file: BinaryIO,
    path: Path,
    options: WriteOptions,
) -> None:
    """Write all missing frames to the open partial file."""
    partial = partial_path(path)
    continued = begun_as(partial, wanted)
    header = wanted.header(stored_revision(partial) if continued else provenance.git_revision())
    checkpoint = read_checkpoint(checkpoint_path(path), header) if continued else None
    if checkpoint and (
        checkpoint.frames > frame_count(file) or not _can_keep(partial, checkpoint.frames, options.overwrite)
    ):
        checkpoint = None
    frames = Frames(file, wanted.layout, header, kept=checkpoint.frames if checkpoint else 0)
    checkpoint = checkpoint or take_over(path, wanted, frames)
    examine = examination(wanted, partial, options.examiner)
    recording = Recording(
        wanted, simulation, frames, path, options.checkpoint_seconds, options.progress, examine
    )
    if checkpoint:
        recording.restore(checkpoint.arrays)
    recording.finish(options.keep_checkpoint)
