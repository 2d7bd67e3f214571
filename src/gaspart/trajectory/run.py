"""Runs that write a trajectory: begin, resume and extend.

A run writes `path.partial`, and regularly the checkpoint `path.checkpoint.npz`, from which it can continue
bitwise identically. When the run is complete, the file is renamed to `path`. The content of the file does not
depend on the time or the machine of the run. The last checkpoint can be stored with the file. It contains the
final state, from which a longer run can continue.

`record`, `resume` and `extend` determine the recipe of the file. The rest is the same for them: find out from
the files what is missing (`is_finished`), take what a checkpoint or a shorter run has, and write the rest.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, TypeAlias

from gaspart.errors import SceneError, short_repr
from gaspart.files import OVERWRITE, may_replace, open_regular, output_path, place
from gaspart.keys.values import number
from gaspart.simulation import Simulation
from gaspart.trajectory import amber, provenance
from gaspart.trajectory.amber import Frames, frame_count, frames_of
from gaspart.trajectory.native_kernels import replace_shipped_kernels
from gaspart.trajectory.opening import (
    CHECKPOINT,
    TRAJECTORY,
    UNFINISHED,
    Checkpoint,
    check_frames,
    checkpoint_path,
    is_blank,
    kept_beside,
    open_locked,
    open_verified,
    partial_path,
    read_checkpoint,
    remove_checkpoint,
    run_path,
    write_checkpoint,
    writing,
)
from gaspart.trajectory.recipe import Recipe, begun_as, read_recipe, stored_revision
from gaspart.trajectory.recording import Examine, Progress, Recording
from gaspart.trajectory.replicas import beside, find_replicas, opened_together
from gaspart.trajectory.run_options import Until, is_examined

if TYPE_CHECKING:
    import xarray as xr

Examiner: TypeAlias = "Callable[[Sequence[xr.Dataset], Until, int], float]"
"""Function that computes the errors in the first frames of a run, or of all its replicas.

The function returns the largest ratio of an error to the required error. The result is inf if an error is
unknown, and 0 if the run must end.
"""
_LOOK = 0.05  # seconds between checks of other replicas


@dataclass(frozen=True)
class WriteOptions:
    """Options for writing a trajectory, which its content does not depend on; none may be negative."""

    checkpoint_seconds: float = 30.0
    progress: Progress | None = None
    overwrite: bool = False
    examiner: Examiner | None = None
    keep_checkpoint: bool = False

    def __post_init__(self) -> None:
        number("checkpoint_seconds", self.checkpoint_seconds, "must not be negative", least=0.0)


def record(recipe: Recipe, path: str | Path, options: WriteOptions) -> Path:
    """Write the trajectory of a recipe at `path`, and return `path`; raises as `gaspart.run`."""
    path = output_path(path)
    if path.suffix != ".nc" and not path.is_dir():  # `gaspart check` recognises the format by this suffix
        raise SceneError("path", str(path), "must end in .nc: a trajectory is a netCDF file")
    return _carry_out(recipe, path, options)


def resume(path: str | Path, options: WriteOptions) -> Path:
    """Finish the interrupted run of `path.partial` from its files, and return `path`. Raises SceneError if
    there is nothing to resume, if another version of the program began the run, or if the file at `path` is
    not a complete trajectory of gaspart.
    """
    path = run_path(path)
    partial = partial_path(path)
    try:
        with writing(path):
            recipe = begun(partial)
    except SceneError:
        if partial.exists():
            raise
        # checked only now, because another process may finish the run at any moment
        rule = f"there is no {partial.name} to continue"
        if path.exists():
            check_frames(path)  # raises SceneError for a damaged file, or a file of another program
            recipe = read_recipe(path)
            with open_regular(path) as file:
                frames = frame_count(file)
            missing = f"has {frames} of {'more' if recipe.until else recipe.frames} frames, and {rule}"
            rule = "is already complete" if is_complete(recipe, path, frames, options.examiner) else missing
        raise SceneError("path", str(path), rule) from None
    return _carry_out(recipe, path, options)


def begun(partial: Path) -> Recipe:
    """Return the recipe of an unfinished trajectory. Raises SceneError if another version began it."""
    recipe = read_recipe(partial)
    if not begun_as(partial, recipe):
        rule = "was begun by another version of gaspart, Python or a package: start it anew"
        raise SceneError("path", str(partial), rule)
    return recipe


def extend(path: str | Path, duration: float, options: WriteOptions) -> Path:
    """Continue the complete run at `path` to a longer duration, and return `path`. The resulting file has the
    bytes of an uninterrupted run of the longer duration. The run continues from its final checkpoint, which
    `keep_checkpoint` stores. Without this checkpoint the run is repeated from its start. If the run has a
    checkpoint, the extended run has a checkpoint, too. An interrupted extension is continued by this function
    or by `resume`. Raises SceneError under the same conditions as `longer`, and if another unfinished run is
    at the path, or if the checkpoint is damaged or belongs to another run.
    """
    path = Path(path)
    partial, checkpoint = partial_path(path), checkpoint_path(path)
    if not path.exists() and partial.exists():
        rule = f"is unfinished: resume it without a duration, which {partial.name} has, before it is extended"
        raise SceneError("path", str(path), rule)
    recipe = longer(path, duration)
    if not partial.exists():
        with open_verified(path) as (_, header, _):
            # the message then names this file, if it is damaged
            kept_beside(path, header, "to run it again from its start")
    with writing(path):
        kept = options.keep_checkpoint or checkpoint.exists()
        with open_locked(partial) as file:
            # this file states the requested duration, whenever the work is interrupted
            if amber.is_blank(file):
                Frames(file, recipe.layout, recipe.header(stored_revision(path)))
            elif not begun_as(partial, recipe):
                rule = "is of another unfinished run, or to another duration; resume it or move it away"
                raise SceneError("path", str(partial), rule)
    return _carry_out(recipe, path, replace(options, keep_checkpoint=kept))


# The work, which is the same for all three.


def _carry_out(recipe: Recipe, path: Path, options: WriteOptions) -> Path:
    """Finish a trajectory from its present state, and store native kernels if this saves time."""
    start = time.thread_time()
    _finish(recipe, path, options)
    replace_shipped_kernels(time.thread_time() - start)
    return path


def _finish(recipe: Recipe, path: Path, options: WriteOptions) -> None:
    """Finish a trajectory from its present state."""
    partial, checkpoint = partial_path(path), checkpoint_path(path)
    with writing(path):
        if path.is_dir() or not os.access(path.parent, os.W_OK | os.X_OK):
            raise SceneError("path", str(path), "must be a file in an existing folder that can be written to")
        if is_finished(recipe, path, options.examiner, options.overwrite):
            if not partial.exists() and not options.keep_checkpoint:
                remove_checkpoint(checkpoint)
            return
        # tested before the work; each checkpoint tests it again
        may_replace(checkpoint, CHECKPOINT, overwrite=True)
        simulation = simulation_of(recipe)
        with open_locked(partial) as file:
            # again: another process may have finished or begun a run before the lock
            if not is_finished(recipe, path, options.examiner, options.overwrite):
                _record(recipe, simulation, file, path, options)
                place(partial, path, TRAJECTORY, options.overwrite or is_beginning(path, recipe))
                if not options.keep_checkpoint:
                    remove_checkpoint(checkpoint)


def _record(
    recipe: Recipe,
    simulation: Simulation,
    file: BinaryIO,
    path: Path,
    options: WriteOptions,
) -> None:
    """Write all missing frames to the open partial file."""
    partial = partial_path(path)
    continued = begun_as(partial, recipe)
    header = recipe.header(stored_revision(partial) if continued else provenance.git_revision())
    checkpoint = read_checkpoint(checkpoint_path(path), header) if continued else None
    if checkpoint and (
        checkpoint.frames > frame_count(file) or not _can_keep(partial, checkpoint.frames, options.overwrite)
    ):
        checkpoint = None
    frames = Frames(file, recipe.layout, header, kept=checkpoint.frames if checkpoint else 0)
    checkpoint = checkpoint or take_over(path, recipe, frames)
    examine = examination(recipe, partial, options.examiner)
    recording = Recording(
        recipe, simulation, frames, path, options.checkpoint_seconds, options.progress, examine
    )
    if checkpoint:
        recording.restore(checkpoint.arrays)
    recording.finish(options.keep_checkpoint)


def _can_keep(partial: Path, frames: int, overwrite: bool) -> bool:
    """Return True if the first `frames` are undamaged; SceneError if not, unless `overwrite`."""
    try:
        check_frames(partial, range(frames))
    except SceneError as error:
        if overwrite:
            return False
        rule = f"{error.rule}; {OVERWRITE} to start again"
        raise SceneError("path", str(partial), rule) from None
    return True


def simulation_of(recipe: Recipe) -> Simulation:
    """Return the simulation of a recipe at time 0."""
    return Simulation(recipe.scene, recipe.engine, recipe.seed, initial=recipe.initial, tallies=recipe.asked)


# What the files at the path of a run are.


class Content(Enum):
    """Relation of an existing file to the requested run."""

    NOTHING = "there is no file, or an empty one"
    BEGUN = "this run, unfinished"
    COMPLETE = "this run, complete and undamaged"
    SHORTER = "this run, complete with a shorter duration"
    OTHER = "another run or version, or damaged data"


def is_finished(recipe: Recipe, path: Path, examiner: Examiner | None, overwrite: bool) -> bool:
    """Return True if a run is complete at `path`; SceneError if a file would be replaced, unless
    `overwrite`.
    """
    partial, content = partial_path(path), _content(path, recipe, examiner)
    if content is Content.COMPLETE:
        return True
    unfinished = Content.OTHER if content is Content.OTHER else _partial_content(partial, recipe)
    is_begun = unfinished is Content.BEGUN  # beside a shorter run: its extension
    if overwrite or is_begun or content is unfinished is Content.NOTHING:
        return False
    there = partial if content is Content.NOTHING else path
    rule = f"exists{_difference(there, recipe, content)}; move it away, or {OVERWRITE}"
    raise SceneError("path", str(there), rule)


def _content(path: Path, recipe: Recipe, examiner: Examiner | None) -> Content:
    """Return the content of the file at the path of a run. Raises SceneError for a file of another kind."""
    if not may_replace(path, TRAJECTORY, overwrite=True):
        return Content.NOTHING
    if begun_as(path, recipe):
        with suppress(SceneError), open_regular(path) as file:
            check_frames(path)
            if is_complete(recipe, path, frame_count(file), examiner):
                return Content.COMPLETE
    return Content.SHORTER if is_beginning(path, recipe) else Content.OTHER


def _partial_content(partial: Path, recipe: Recipe) -> Content:
    """Return the content of the partial file of a run. Raises SceneError for a file of another kind."""
    with suppress(FileNotFoundError):  # another process has just finished it
        if may_replace(partial, UNFINISHED, overwrite=True) and not is_blank(partial):
            if begun_as(partial, recipe):
                return Content.BEGUN
            return Content.OTHER if partial.exists() else Content.NOTHING
    return Content.NOTHING


def _difference(path: Path, recipe: Recipe, content: Content) -> str:
    """Describe the difference between the file of a run and the requested run."""
    try:
        stored = read_recipe(path)
    except SceneError:
        return " and is damaged"
    if content is Content.SHORTER and stored.until is None and recipe.until is None:
        return f", with a shorter duration; continue it: gaspart resume {path} --duration {recipe.duration:g}"
    keys = [item.name for item in fields(Recipe) if item.compare]
    changed = [key for key in keys if getattr(stored, key) != getattr(recipe, key)]
    texts = [
        f"{key} {short_repr(getattr(stored, key))}, not {short_repr(getattr(recipe, key))}"
        if isinstance(getattr(recipe, key), int | float | str | tuple)
        else key
        for key in changed
    ]
    if not changed:
        return ", of another version of gaspart or with another initial state, or is damaged"
    return f", of another run, which differs in {'; '.join(texts)}"


# End of a run: all frames are there, or its accuracy is reached.


def is_complete(recipe: Recipe, path: Path, frames: int, examiner: Examiner | None) -> bool:
    """Return True if a trajectory is complete with these frames, once other replicas have them too."""
    examine = examination(recipe, path, examiner)
    if frames == recipe.frames or examine is None or not is_examined(frames):
        return frames == recipe.frames
    while (excess := examine(frames)) is None:
        time.sleep(_LOOK)
    return excess <= 1.0


def examination(recipe: Recipe, path: Path, examiner: Examiner | None) -> Examine | None:
    """Return the joint test of the accuracy of a run's replicas in their first frames, or None."""
    until = recipe.until
    if until is None:
        return None
    if examiner is None:
        raise ValueError("examiner: None (a run that ends when it is accurate needs one)")
    files = beside(path, recipe)

    def examine(frames: int) -> float | None:
        paths = find_replicas(files, frames)
        if paths is None:
            return None
        try:
            with opened_together(paths) as runs:
                return examiner(runs, until, frames)
        except SceneError:
            if find_replicas(files, frames) == paths:
                raise
            return None  # another process has just renamed the file, or truncated it to its checkpoint

    return examine


# Extension of a finished run: the same recipe with a longer duration. The frames of the shorter run are the
# first frames of the longer run. If the checkpoint of the shorter run was stored, the longer run continues
# from this final state. The frames get the header of the longer run, because its duration is part of the
# header, and the checksums of all frames depend on it. The shorter file is not changed until the longer run
# is complete, so that an interruption at any moment loses neither.


def longer(path: Path, duration: float) -> Recipe:
    """Return the recipe of a trajectory with a longer duration. Raises SceneError if the file is not an
    undamaged trajectory of this version of the program. Raises SceneError also if the duration is not longer,
    or if the recipe rejects it.
    """
    recipe = read_recipe(path)
    if not begun_as(path, recipe):
        rule = "was made by another version of gaspart, Python or a package: it could go on otherwise"
        raise SceneError("path", str(path), rule)
    check_frames(path)
    with open_verified(path) as (_, _, frames):
        reached = (frames - 1) * recipe.sample_interval
    rule = f"must be longer than the {reached:g} that {path.name} has"
    duration = number("duration", duration, rule, above=reached)
    extended = replace(recipe, duration=duration, until=None)
    if extended.frames <= frames:  # longer only by a rounding error
        raise SceneError("duration", duration, rule)
    return extended


def is_beginning(path: Path, recipe: Recipe) -> bool:
    """Return True if the file at `path` differs from a requested run only by a shorter duration."""
    try:
        stored, revision = read_recipe(path), stored_revision(path)
        with open_verified(path) as (_, _, frames):
            shorter = frames < recipe.frames
        same = replace(stored, duration=recipe.duration, until=recipe.until)
    except SceneError:  # for example, a duration that is no multiple of its interval
        return False
    return shorter and begun_as(path, stored) and same.header(revision) == recipe.header(revision)


def take_over(path: Path, recipe: Recipe, frames: Frames) -> Checkpoint | None:
    """Copy the frames and the final state of a shorter run to a longer run. If there is no shorter run, or if
    its final state was not stored, the function returns None and changes nothing. The checkpoint of the
    shorter run is replaced last, so that the copy can be repeated if it is interrupted. Raises OSError, and
    SceneError for a damaged file.
    """
    if not (path.exists() and is_beginning(path, recipe)):
        return None
    with open_verified(path) as (source, header, count):
        kept = read_checkpoint(checkpoint_path(path), header)
        if kept is None or kept.frames != count:
            return None
        check_frames(path)
        for frame in frames_of(source, header, count):
            frames.append_bytes(frame)
    frames.sync()
    write_checkpoint(checkpoint_path(path), frames.header, count, kept.arrays)
    return Checkpoint(count, kept.arrays)
