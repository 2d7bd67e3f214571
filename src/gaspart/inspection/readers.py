"""Reading trajectories: AMBER and LAMMPS netCDF, GSD, and XYZ, extended or plain.

`docs/formats.md` lists every field of these formats, and what is done with it.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from gaspart.errors import SceneError
from gaspart.files import open_regular
from gaspart.inspection.contents import Contents, Given, complete_frames
from gaspart.inspection.frames import Frames
from gaspart.inspection.gsd_contents import read_gsd
from gaspart.inspection.netcdf_contents import is_own, read_netcdf
from gaspart.inspection.xyz_contents import read_xyz
from gaspart.system import memory
from gaspart.trajectory.recipe import read_recipe

COPIES = 4
"""Memory that reading takes, over the size of a file: in double precision, as stored and in the container."""
SUFFIXES = (".nc", ".gsd", ".xyz")
_READERS = {
    **dict.fromkeys((".nc", ".ncdf", ".ncrst", ".rst7", ".rst", ".partial"), read_netcdf),
    ".gsd": read_gsd,
    **dict.fromkeys((".xyz", ".extxyz"), read_xyz),
}


def read_frames(
    path: str | Path,
    radius: float | None = None,
    lengths: tuple[float, ...] | None = None,
    boundary: str | tuple[str, ...] | None = None,
    time_step: float | None = None,
    origin: str | tuple[float, ...] | None = None,
) -> Frames:
    """The frames of a trajectory; the arguments take precedence over the file.

    radius: of all particles; lengths: (d,) sides; boundary: "periodic" (the default for files of other
    programs that state nothing else) or "wall", or one for each axis; time_step: simulated time of one step,
    where a file counts steps (GSD), or between frames; origin: (d,) the lower corner of the container, or
    "centre" if its middle is at 0. Raises SceneError for a file that cannot be read, or
    for missing data.
    """
    path, given = Path(path), Given(radius, lengths, boundary, time_step, origin)
    with _reading(path):
        return complete_frames(_contents(path, given), given, str(path))


def is_open_run(path: str | Path) -> bool:
    """Return True for a trajectory of gaspart with open faces, which `open_runs.judge_open` checks."""
    path = Path(path)
    with _reading(path):
        netcdf = _READERS.get(path.suffix.lower()) is read_netcdf
        return netcdf and is_own(path) and read_recipe(path).scene.is_open


def read_contents(path: Path, given: Given) -> Contents:
    """The contents of a file, as `read_frames` reads it. Raises SceneError."""
    with _reading(path):
        return _contents(path, given)


def _contents(path: Path, given: Given) -> Contents:
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise SceneError("file", str(path), f"must end in {', '.join(SUFFIXES)}")
    _require_memory(path)
    return reader(path, given)


@contextmanager
def _reading(path: Path) -> Iterator[None]:
    """Raises SceneError for whatever is wrong with a file. Values that are not finite are refused later."""
    try:
        with np.errstate(all="ignore"):
            yield
    except SceneError:
        raise
    except (OSError, RuntimeError, ValueError, LookupError, TypeError, MemoryError) as error:
        reason = getattr(error, "strerror", None) or error
        raise SceneError("file", str(path), f"cannot be read: {reason}") from None


def _require_memory(path: Path) -> None:
    """Raise SceneError for a file whose frames do not fit the memory, as a sparse one; OSError for none."""
    with open_regular(path) as file:
        size = os.fstat(file.fileno()).st_size
    there, needed = memory(), COPIES * size
    if there is not None and needed > there:
        rule = f"needs {needed / 1e9:.3g} GB of memory for all frames; this machine has {there / 1e9:.3g} GB"
        raise SceneError("file", str(path), rule)
