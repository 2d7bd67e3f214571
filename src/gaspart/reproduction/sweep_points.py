"""Making the points of a sweep: in this process, or in several.

A point that cannot be made costs no other one: the reason is kept in place of its trajectories. What concerns
the files of all, such as a full disk or a trajectory of another sweep, ends the sweep instead.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from gaspart.errors import SceneError, SimulationError
from gaspart.files import only_process
from gaspart.kernels.compile.loading import load_numba
from gaspart.reproduction.jobs.replicas import replica_paths, write_replicas
from gaspart.reproduction.jobs.simulate import recipes, record
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.points.variants import compile_kernels, compile_task, variant
from gaspart.workers import in_processes, require_processes


def make_all(
    points: Sequence[Point], workers: int, overwrite: bool, finished: Callable[[Point, str], None]
) -> None:
    """Make the trajectories of all points; finished(point, reason) is called for each, with the reason why it
    could not be made, or "". Those whose trajectories exist come first: a conflict is then found before
    anything is run. Raises SceneError for files that cannot be written or are of another sweep."""
    ordered = sorted(points, key=lambda point: not Path(point.path).exists())
    if workers == 1:
        for point in ordered:
            finished(point, make(point, overwrite))
        return
    require_processes("workers", workers)
    for one in {variant(point): point for point in ordered}.values():  # or each process would compile them
        with suppress(SceneError, SimulationError):  # of its own point alone
            compile_kernels(compile_task(one))
    calls = [(point.to_dict(), point.path, overwrite) for point in ordered]
    in_processes(_make_in_process, calls, workers, lambda n, reason: finished(ordered[n], str(reason)))


def make(point: Point, overwrite: bool) -> str:
    """Make the trajectories of a point, or check that those in its folder are these; returns the reason why
    it could not be done, or "". Raises SceneError for files; see `make_all`."""
    folder = Path(point.path)
    try:
        wanted = recipes(**point.arguments)
        with only_process(folder, wait=True):
            if not folder.exists():
                write_replicas(record, wanted, folder, None, overwrite)
                return ""
            for path, recipe in zip(replica_paths(folder, len(wanted)), wanted, strict=True):
                record(recipe, path, overwrite)
    except OSError as error:
        rule = f"cannot be written: {error.strerror}"
        raise SceneError(f"{point.experiment}[{point.name}].path", str(folder), rule) from None
    except SceneError as error:
        if error.key == "path":
            raise error.inside(f"{point.experiment}[{point.name}]") from None
        return str(error)
    except SimulationError as error:
        return str(error)
    except MemoryError:
        return "there is not enough memory"
    return ""


def _make_in_process(tell: Callable[[Any], None], values: dict, path: str, overwrite: bool) -> str:
    """Make a point, given as a dictionary, in a process of its own; see `make`."""
    load_numba(ours=True)
    return make(Point.from_dict(values, path), overwrite)
