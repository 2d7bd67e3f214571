"""Folder of trajectories, one for each replica of a point."""

from __future__ import annotations

import errno
import os
import shutil
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from gaspart.errors import SceneError
from gaspart.files import is_remainder, may_replace, place_folder

if TYPE_CHECKING:
    from gaspart.trajectory.recipe import Recipe

Record: TypeAlias = "Callable[[Recipe, Path, bool], None]"
"""Function that makes the trajectory of a recipe, from path and True if an existing file is replaced."""


def write_replicas(
    record: Record,
    recipes: Sequence[Recipe],
    folder: Path,
    report: Callable[[str], None] | None = None,
    overwrite: bool = True,
    kept: Path | None = None,
) -> None:
    """Write the trajectory of each recipe, and call report(line) for each. Snakemake deletes `folder` before
    a rerun. Therefore trajectories are written to a folder next to it until all are complete, and an
    interrupted run resumes there. If `overwrite` is True, they replace files of an unfinished run with
    another recipe. Raises SceneError if that folder has other files: only files that gaspart wrote are
    removed. Links to the trajectories, and their final states, are in the folder `kept`, if it is given. From
    there a longer run is continued, after Snakemake has deleted the shorter one.
    """
    partial = Path(f"{folder}.partial")
    _make(partial)
    if kept is not None:
        _link(kept, partial)
    paths = replica_paths(partial, len(recipes))
    _remainders(partial, paths)  # before the work: raises an error if the folder is not ours
    for path, recipe in zip(paths, recipes, strict=True):
        if report:
            report(f"{path}: seed {recipe.seed}")
        record(recipe, path, overwrite)
    if kept is not None:
        shutil.rmtree(kept, ignore_errors=True)
        _link(partial, kept)
    for leftover in _remainders(partial, paths):
        leftover.unlink()
    try:
        place_folder(partial, folder)
    except OSError as error:
        raise SceneError("path", str(folder), f"cannot be written: {error.strerror}") from None


def _link(source: Path, target: Path) -> None:
    """Link the files of a folder into another one, where they are missing; nothing without hard links."""
    with suppress(OSError):
        target.mkdir(parents=True, exist_ok=True)
        for file in sorted(source.iterdir()):
            if not (target / file.name).exists():
                os.link(file, target / file.name)


def _make(folder: Path) -> None:
    """Make a folder if it is missing. Raises SceneError for a link or a file."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if folder.is_symlink():
            raise NotADirectoryError(errno.ENOTDIR, "it is a link")
    except OSError as error:
        raise SceneError("path", str(folder), f"cannot be written: {error.strerror}") from None


def _remainders(folder: Path, paths: list[Path]) -> list[Path]:
    """Return the files that runs of other recipes left in a folder. Raises SceneError for a file that gaspart
    did not write, and for a folder or link.
    """
    from gaspart.trajectory.opening import CHECKPOINT, TRAJECTORY, UNFINISHED

    kinds = {".nc.partial": UNFINISHED, ".checkpoint.npz": CHECKPOINT, ".failed.npz": CHECKPOINT}
    remainders = []
    for path in sorted({*folder.iterdir()} - {*paths}):
        kind = kinds.get("".join(path.suffixes[-2:]), TRAJECTORY)
        if is_remainder(path) or (may_replace(path, kind, overwrite=True) and kind.recognises(path)):
            remainders.append(path)
    return remainders


def replica_paths(folder: Path, replicas: int) -> list[Path]:
    """Return the trajectories in a folder, in the order of the seeds."""
    return [folder / f"replica-{replica}.nc" for replica in range(replicas)]
