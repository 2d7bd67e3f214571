"""A finished run that goes on: the same recipe with a longer duration.

The frames of the shorter run are the first ones of the longer, and the state at its end, if its checkpoint
was kept, is that from which the longer one continues. Both get the header of the longer run: its duration is
part of it, and the checksums of all frames depend on it. The shorter file is not touched until the longer
one is complete, so that a kill at any moment loses neither.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from gaspart.errors import SceneError
from gaspart.keys.values import number
from gaspart.trajectory.checkpoint import Checkpoint, checkpoint_path, read_checkpoint, write_checkpoint
from gaspart.trajectory.frames import Frames, frames_of
from gaspart.trajectory.opening import check_frames, checked
from gaspart.trajectory.recipe import Recipe, begun_as, read_recipe, stored_revision


def longer(path: Path, duration: float) -> Recipe:
    """The recipe of a trajectory with a longer duration than it has.

    Raises SceneError for a file that is no undamaged trajectory of this version of the program, and for a
    duration that is no longer, or that the recipe refuses.
    """
    recipe = read_recipe(path)
    if not begun_as(path, recipe):
        rule = "was made by another version of gaspart, Python or a package: it could go on otherwise"
        raise SceneError("path", str(path), rule)
    check_frames(path)
    with checked(path) as (_, _, frames):
        reached = (frames - 1) * recipe.sample_interval
    rule = f"must be longer than the {reached:g} that {path.name} has"
    duration = number("duration", duration, rule, above=reached)
    extended = replace(recipe, duration=duration, until=None)
    if extended.frames <= frames:  # longer by a rounding error
        raise SceneError("duration", duration, rule)
    return extended


def is_beginning(path: Path, wanted: Recipe) -> bool:
    """Whether the file at `path` is of a run that differs from the wanted one in being shorter only."""
    try:
        recipe, revision = read_recipe(path), stored_revision(path)
        with checked(path) as (_, _, frames):
            shorter = frames < wanted.frames
        same = replace(recipe, duration=wanted.duration, until=wanted.until)
    except SceneError:  # as for a duration that is no multiple of its interval
        return False
    return shorter and begun_as(path, recipe) and same.header(revision) == wanted.header(revision)


def take_over(path: Path, wanted: Recipe, frames: Frames) -> Checkpoint | None:
    """Give the frames and the last state of the shorter run at `path` to the longer one that is begun in
    `frames`. None, with nothing changed, if there is no such run, or its last state was not kept.

    The checkpoint of the shorter run is replaced last: after a kill before that, all this is done again.
    Raises SceneError for a damaged file, and OSError.
    """
    if not (path.exists() and is_beginning(path, wanted)):
        return None
    with checked(path) as (source, header, count):
        kept = read_checkpoint(checkpoint_path(path), header)
        if kept is None or kept.frames != count:
            return None
        check_frames(path)
        for frame in frames_of(source, header, count):
            frames.append_bytes(frame)
    frames.sync()
    write_checkpoint(checkpoint_path(path), frames.header, count, kept.arrays)
    return Checkpoint(count, kept.arrays)
