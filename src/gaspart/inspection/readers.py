"""Reading trajectories: AMBER and LAMMPS netCDF, GSD, and XYZ, extended or plain."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from gaspart.errors import SceneError, optional
from gaspart.files import descriptor_path
from gaspart.inspection.frames import Frames, complete_frames
from gaspart.trajectory.amber import BOOKKEEPING
from gaspart.trajectory.recipe import check_frames, open_descriptor, opened, read_recipe

KINDS = (".nc", ".gsd", ".xyz")


def read_frames(
    path: str | Path,
    radius: float | None = None,
    lengths: tuple[float, ...] | None = None,
    boundary: str | None = None,
    time_step: float | None = None,
) -> Frames:
    """The frames of a trajectory; the arguments take precedence over the file.

    radius: of all particles; lengths: (d,) sides; boundary: "periodic" (the default for files of other
    programs) or "wall"; time_step: simulated time of one step, where a file counts steps (GSD) or frames
    (XYZ). Raises SceneError for a file that cannot be read, or for missing data.
    """
    path = Path(path)
    readers = {".nc": _netcdf, ".ncdf": _netcdf, ".partial": _netcdf, ".gsd": _gsd, ".xyz": _xyz}
    reader = readers.get(path.suffix)
    if reader is None:
        raise SceneError("file", str(path), f"must end in {', '.join(KINDS)}")
    try:
        with path.open("rb"):
            pass
        found = reader(path)
    except SceneError:
        raise
    except (OSError, RuntimeError, ValueError, KeyError, IndexError) as error:
        reason = getattr(error, "strerror", None) or error
        raise SceneError("file", str(path), f"cannot be read: {reason}") from None
    steps = found.pop("steps", None)
    if steps is not None and time_step is not None:
        found["time"] = time_step * np.asarray(steps, dtype=float)
    return complete_frames(found, str(path), radius, lengths, boundary)


def _netcdf(path: Path) -> dict:
    """AMBER's convention, which LAMMPS follows; with more variables in files of gaspart."""
    own = _is_own(path)
    if own:
        check_frames(path)
    with opened(path) if own else _foreign(path) as file:
        if "coordinates" not in file.variables or "frame" not in file.dimensions:
            raise SceneError("file", str(path), "has no coordinates in frames: not AMBER's convention")

        def read(name: str) -> np.ndarray | None:
            return np.ma.filled(file[name][:], np.nan) if name in file.variables else None

        found = {"positions": read("coordinates"), "velocities": read("velocities"), "time": read("time")}
        cells, origin = read("cell_lengths"), read("cell_origin")
        if cells is not None and len(cells):
            found["lengths"] = _constant(cells, path)
        if origin is not None and len(origin):
            found["origin"] = origin[0]
        if "radius" in file.variables:
            radii = np.ma.filled(file["radius"][:], np.nan)
            found["radii"] = radii if radii.ndim == 1 else radii[0]
    if own:
        found |= _own(path)
    return {key: value for key, value in found.items() if value is not None}


def _is_own(path: Path) -> bool:
    """Whether gaspart wrote a file. Several attributes are tried, so that damage to one does not hide it."""
    with path.open("rb") as file:
        head = file.read(4096)
    return any(name.encode() in head for name in BOOKKEEPING)


@contextmanager
def _foreign(path: Path) -> Iterator[Any]:
    """A netCDF file of another program."""
    with path.open("rb") as file, open_descriptor(file) as dataset:
        yield dataset


def _own(path: Path) -> dict:
    """Properties of the scene of a trajectory of gaspart."""
    scene = read_recipe(path).scene
    elastic = scene.restitution is None or scene.restitution.smooth_and_elastic
    quiet = scene.gravity is None and not scene.faces and not scene.walls and not scene.vibrates
    alike = len({kind.mass for kind in scene.kinds}) == 1
    free = not any(kind.fixed for kind in scene.kinds)
    return {
        "boundary": scene.container.boundary,
        "flat": scene.dimension == 2,
        "lengths": np.array(scene.container.lengths),
        "plain": bool(elastic and quiet and alike and free),
    }


def _constant(cells: np.ndarray, path: Path) -> np.ndarray:
    """(3,) sides that are the same in every frame."""
    if np.abs(cells - cells[0]).max() > 1e-6 * np.abs(cells).max():
        raise SceneError("lengths", [float(x) for x in cells[-1]], f"{path}: the container changes its size")
    return cells[0]


def _gsd(path: Path) -> dict:
    """HOOMD's format: the origin is the middle of the box, and a frame states its step."""
    hoomd = optional("gsd.hoomd", "gsd", "GSD files")
    with path.open("rb") as opened_file, hoomd.open(descriptor_path(opened_file), "r") as file:
        frames = list(file)
    boxes = np.array([frame.configuration.box for frame in frames], dtype=float)
    if np.any(boxes[:, 3:] != 0.0):
        raise SceneError("box", boxes[0, 3:].tolist(), f"{path}: a tilted box cannot be checked")
    sides = _constant(boxes[:, :3], path)
    return {
        "positions": np.array([frame.particles.position for frame in frames]),
        "velocities": np.array([frame.particles.velocity for frame in frames]),
        "radii": 0.5 * np.array(frames[0].particles.diameter, dtype=float),
        "lengths": sides,
        "origin": -0.5 * sides,
        "flat": frames[0].configuration.dimensions == 2,
        "steps": [frame.configuration.step for frame in frames],
    }


def _xyz(path: Path) -> dict:
    """Count, comment, and a line per particle; the extended form names the columns and the box in the
    comment."""
    lines = path.read_text(encoding="utf-8").splitlines()
    frames: list[list[list[str]]] = []
    comments, at = [], 0
    while at < len(lines) and lines[at].strip():
        count = int(lines[at])
        rows = [line.split() for line in lines[at + 2 : at + 2 + count]]
        if len(rows) < count:
            raise SceneError(
                "file", str(path), f"is truncated: frame {len(frames)} has {len(rows)} particles"
            )
        frames.append(rows)
        comments.append(lines[at + 1])
        at += count + 2
    columns = _columns(comments[0])

    def read(name: str) -> np.ndarray | None:
        if name not in columns:
            return None
        first, width = columns[name]
        return np.array([[row[first : first + width] for row in rows] for rows in frames], dtype=float)

    found: dict[str, Any] = {
        "positions": read("pos"),
        "velocities": read("velo"),
        "steps": range(len(frames)),
    }
    radii = read("radius")
    found["radii"] = None if radii is None else radii[0, :, 0]
    digits = [len(word.partition(".")[2]) for word in frames[0][0][columns["pos"][0] :][:3]]
    found["resolution"] = 10.0 ** -max(digits)
    lattice = re.search(r'Lattice="([^"]*)"', comments[0])
    if lattice:
        cell = np.array(lattice[1].split(), dtype=float).reshape(3, 3)
        if np.any(cell != np.diag(np.diag(cell))):
            raise SceneError("Lattice", lattice[1], f"{path}: a tilted box cannot be checked")
        found["lengths"] = np.diag(cell)
    origin = re.search(r'Origin="([^"]*)"', comments[0])
    if origin:
        found["origin"] = np.array(origin[1].split(), dtype=float)
    times = [re.search(r"\btime=([-+.\deE]+)", comment, re.IGNORECASE) for comment in comments]
    if all(times):
        found["time"] = np.array([float(match[1]) for match in times if match])
    return {key: value for key, value in found.items() if value is not None}


def _columns(comment: str) -> dict[str, tuple[int, int]]:
    """First column and number of columns of each property; a name and three coordinates in the plain form."""
    named = re.search(r"Properties=(\S+)", comment)
    if not named:
        return {"pos": (1, 3)}
    parts, first, columns = named[1].split(":"), 0, {}
    for name, width in zip(parts[::3], parts[2::3], strict=True):
        columns[{"vel": "velo", "velocities": "velo"}.get(name, name)] = first, int(width)
        first += int(width)
    return columns
