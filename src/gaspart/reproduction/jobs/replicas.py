"""A folder of trajectories, one for each replica of a point."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

Record: TypeAlias = Callable[[dict, tuple[int, ...], Path, bool], None]
"""Makes one trajectory of some parameters: seed, path, and whether another file there is replaced."""


def write_replicas(
    record: Record,
    parameters: dict,
    folder: Path,
    report: Callable[[str], None] | None = None,
    overwrite: bool = True,
) -> None:
    """Write a trajectory for each seed of the parameters; report(line) is called for each.

    They lie beside `folder`, which Snakemake deletes before a rerun, until all are complete: an interrupted
    run resumes there. overwrite: whether they replace the remainder of a run with other parameters.
    """
    partial = Path(f"{folder}.partial")
    partial.mkdir(parents=True, exist_ok=True)
    paths = replica_paths(parameters, partial)
    for path, seed in zip(paths, parameters["seeds"], strict=True):
        if report:
            report(f"{path}: seed {seed}")
        record(parameters, tuple(seed), path, overwrite)
    for leftover in set(partial.iterdir()) - set(paths):
        leftover.unlink()
    partial.rename(folder)


def replica_paths(parameters: dict, folder: Path) -> list[Path]:
    """The trajectories of a folder, in the order of the seeds."""
    return [folder / f"replica-{replica}.nc" for replica in range(len(parameters["seeds"]))]
