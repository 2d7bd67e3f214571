"""How far a run has come, by what lies at its path and beside it: a table states what is done then."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from gaspart.errors import SceneError
from gaspart.files import OVERWRITE, may_replace, open_regular
from gaspart.trajectory.extension import is_beginning
from gaspart.trajectory.frames import frame_count
from gaspart.trajectory.opening import check_frames
from gaspart.trajectory.partial import TRAJECTORY, UNFINISHED, is_blank, partial_path
from gaspart.trajectory.recipe import Recipe, begun_as
from gaspart.trajectory.recording import Examine
from gaspart.trajectory.replicas import beside, opened_together, reached
from gaspart.trajectory.until import Until, is_examined

if TYPE_CHECKING:
    import xarray as xr

Examiner: TypeAlias = "Callable[[Sequence[xr.Dataset], Until, int], float]"
"""Examines the first frames of a run, or of all its replicas: the largest error over the required one, inf if
unknown, 0 to give up."""
_LOOK = 0.05  # seconds between two looks at other replicas


class Content(Enum):
    """The content of a file, compared with a run that is wanted."""

    NOTHING = "there is no file, or an empty one"
    BEGUN = "this run, unfinished"
    COMPLETE = "this run, complete and undamaged"
    SHORTER = "this run, complete with a shorter duration"
    OTHER = "another run or version, or damaged data"


class Action(Enum):
    """The next step of a run."""

    NONE = "the run is finished"
    WRITE = "begin or continue in the partial file"
    REPLACE = "begin, and replace a file: only with overwrite"


_ACTIONS: dict[Content, Action | dict[Content, Action]] = {
    Content.NOTHING: {
        Content.NOTHING: Action.WRITE,
        Content.BEGUN: Action.WRITE,
        Content.OTHER: Action.REPLACE,
    },
    Content.SHORTER: {
        Content.NOTHING: Action.REPLACE,
        Content.BEGUN: Action.WRITE,  # it is being extended
        Content.OTHER: Action.REPLACE,
    },
    Content.COMPLETE: Action.NONE,
    Content.OTHER: Action.REPLACE,
}
"""By what is at the path, and where that does not decide, by the partial file beside it."""


def is_finished(wanted: Recipe, path: Path, examiner: Examiner | None, overwrite: bool) -> bool:
    """Whether a run is complete at `path`. Raises SceneError if it may not be begun or continued."""
    partial, content = partial_path(path), _content(path, wanted, examiner)
    action = _ACTIONS[content]
    if isinstance(action, dict):
        action = action[_partial_content(partial, wanted)]
    if action is Action.REPLACE and not overwrite:
        rule = f"exists, of another run or version, or damaged; move it away, or {OVERWRITE}"
        raise SceneError("path", str(partial if content is Content.NOTHING else path), rule)
    return action is Action.NONE


def _content(path: Path, wanted: Recipe, examiner: Examiner | None) -> Content:
    """The content at the path of a run. Raises SceneError for a file of another kind."""
    if not may_replace(path, TRAJECTORY, overwrite=True):
        return Content.NOTHING
    if begun_as(path, wanted):
        with suppress(SceneError), open_regular(path) as file:
            check_frames(path)
            if is_complete(wanted, path, frame_count(file), examiner):
                return Content.COMPLETE
    return Content.SHORTER if is_beginning(path, wanted) else Content.OTHER


def _partial_content(partial: Path, wanted: Recipe) -> Content:
    """The content of the partial file of a run. Raises SceneError for a file of another kind."""
    with suppress(FileNotFoundError):  # another process has finished it just now
        if may_replace(partial, UNFINISHED, overwrite=True) and not is_blank(partial):
            if begun_as(partial, wanted):
                return Content.BEGUN
            return Content.OTHER if partial.exists() else Content.NOTHING
    return Content.NOTHING


def is_complete(wanted: Recipe, path: Path, frames: int, examiner: Examiner | None) -> bool:
    """Whether the complete trajectory of a run has so many frames. Waits for other replicas."""
    examine = examination(wanted, path, examiner)
    if frames == wanted.frames or examine is None or not is_examined(frames):
        return frames == wanted.frames
    while (excess := examine(frames)) is None:
        time.sleep(_LOOK)
    return excess <= 1.0


def examination(wanted: Recipe, path: Path, examiner: Examiner | None) -> Examine | None:
    """The examination of the first frames of a run that ends when it is accurate; None for other runs. One
    of several replicas is examined with the others."""
    until = wanted.until
    if until is None:
        return None
    if examiner is None:
        raise ValueError("examiner: None (a run that ends when it is accurate needs one)")
    files = beside(path, wanted)

    def examine(frames: int) -> float | None:
        places = reached(files, frames)
        if places is None:
            return None
        try:
            with opened_together(places) as runs:
                return examiner(runs, until, frames)
        except SceneError:
            if reached(files, frames) == places:
                raise
            return None  # the process of another one has just renamed it, or cut it to its checkpoint

    return examine
