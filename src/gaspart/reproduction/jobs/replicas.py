"""Folder of trajectories, one for each replica of a point."""

from __future__ import annotations

import errno
from collections.abc import Callable, Sequence
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
) -> None:
    """Write the trajectory of each recipe, and call report(line) for each.

    Snakemake deletes `folder` before a rerun. Therefore trajectories are written to a folder next to it until
    all are complete, and an interrupted run resumes there. If `overwrite` is True, they replace files of an
    unfinished run with another recipe. Raises SceneError if that folder has other files: only files that
    gaspart wrote are removed.
    """
    partial = Path(f"{folder}.partial")
    _make(partial)
    paths = replica_paths(partial, len(recipes))
    _remainders(partial, paths)  # before the work: raises an error if the folder is not ours
    for path, recipe in zip(paths, recipes, strict=True):
        if report:
            report(f"{path}: seed {recipe.seed}")
        record(recipe, path, overwrite)
    for leftover in _remainders(partial, paths):
        leftover.unlink()
    try:
        place_folder(partial, folder)
    except OSError as error:
        raise SceneError("path", str(folder), f"cannot be written: {error.strerror}") from None


def _make(folder: Path) -> None:
    """Make a folder if it is missing.

    Raises SceneError for a link or a file.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if folder.is_symlink():
            raise NotADirectoryError(errno.ENOTDIR, "it is a link")
    except OSError as error:
        raise SceneError("path", str(folder), f"cannot be written: {error.strerror}") from None


def _remainders(folder: Path, paths: list[Path]) -> list[Path]:
    """Return the files that runs of other recipes left in a folder.

    Raises SceneError for a file that gaspart did not write, and for a folder or link.
    """
    from gaspart.trajectory.checkpoint import CHECKPOINT
    from gaspart.trajectory.opening import TRAJECTORY, UNFINISHED

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
