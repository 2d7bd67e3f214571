"""One frame of a trajectory as a state for other programs: GSD (HOOMD) and LAMMPS data.

Positions and velocities are those of the trajectory's frame, in single precision: particles that touched may
overlap by 1e-7 of a diameter. Walls, faces and gravity are not part of these formats.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gaspart.errors import SceneError, optional
from gaspart.files import FileKind, begins_with, output_path, writing
from gaspart.state.insertion import per_particle
from gaspart.system import descriptor_path
from gaspart.trajectory.opening import check_frames, opened, run_path
from gaspart.trajectory.recipe import read_recipe

EXPORT_FORMATS = {
    ".gsd": FileKind("a GSD file", begins_with(b"\xdf\x65" * 4)),
    ".data": FileKind("LAMMPS data written by gaspart", begins_with(b"gaspart: ")),
}


@dataclass(frozen=True)
class Snapshot:
    """One frame: positions and velocities (N, 3), diameters, masses and types (N,), lengths (3,), time.

    sizes: the different diameters of each type, also of one without a particle in the frame.
    """

    positions: np.ndarray
    velocities: np.ndarray
    diameters: np.ndarray
    masses: np.ndarray
    types: np.ndarray
    lengths: np.ndarray
    time: float
    dimension: int
    sizes: list[np.ndarray]


def export(trajectory: str | Path, path: str | Path, frame: int = -1, overwrite: bool = False) -> Path:
    """Write a frame of a trajectory as .gsd or LAMMPS .data; returns the path.

    frame: counted from 0, or from the end if negative. A file of the same kind at `path` is replaced only
    with `overwrite`, any other never. Raises SceneError for another suffix, a missing frame, and a
    file that cannot be read or written.
    """
    path = output_path(path)
    if path.suffix not in EXPORT_FORMATS:
        raise SceneError("output", str(path), f"must end in {' or '.join(EXPORT_FORMATS)}")
    snapshot = _snapshot(run_path(trajectory), frame)
    with writing(path, EXPORT_FORMATS[path.suffix], overwrite) as scratch:
        (_write_gsd if path.suffix == ".gsd" else _write_data)(scratch, snapshot)
    return path


def _snapshot(path: Path, frame: int) -> Snapshot:
    recipe = read_recipe(path)
    recipe.require_all(path)
    scene = recipe.scene
    with opened(path) as file:
        there = len(file.dimensions["frame"])
        if not -there <= frame < there:
            raise SceneError("frame", frame, f"the trajectory has {there}")
        frame %= there  # netCDF counts -1 from the allocated frames of an unfinished file
        check_frames(path, range(frame, frame + 1))
        places = np.asarray(file["coordinates"][frame], dtype=float)
        inside = np.isfinite(places).all(axis=1)  # of particles that come and go
        masses = np.resize(per_particle(scene, "mass"), scene.capacity)[: len(places)]
        diameters, types = 2.0 * np.asarray(file["radius"][:]), np.asarray(file["type"][:])
        return Snapshot(
            positions=places[inside],
            velocities=np.asarray(file["velocities"][frame], dtype=float)[inside],
            diameters=diameters[inside],
            masses=masses[inside].astype(float),
            types=types[inside],
            lengths=np.asarray(file["cell_lengths"][frame], dtype=float),
            time=float(file["time"][frame]),
            dimension=scene.dimension,
            sizes=[np.unique(diameters[types == n]) for n in range(int(types.max()) + 1)],
        )


def _write_gsd(path: Path, snapshot: Snapshot) -> None:
    """A frame of HOOMD's schema: the origin in the middle of the box, discs in a box without thickness."""
    hoomd = optional("gsd.hoomd", "gsd", "GSD files")
    flat = snapshot.dimension == 2
    frame = hoomd.Frame()
    frame.configuration.dimensions = snapshot.dimension
    sides = np.where([False, False, flat], 0.0, snapshot.lengths)
    frame.configuration.box = [*sides, 0.0, 0.0, 0.0]
    frame.particles.N = len(snapshot.positions)
    frame.particles.types = [f"species_{n}" for n in range(len(snapshot.sizes))]
    frame.particles.typeid = snapshot.types
    frame.particles.type_shapes = _shapes(snapshot)
    frame.particles.position = snapshot.positions - 0.5 * sides
    frame.particles.velocity = snapshot.velocities
    frame.particles.diameter = snapshot.diameters
    frame.particles.mass = snapshot.masses
    with path.open("rb") as scratch, hoomd.open(descriptor_path(scratch), "w") as file:
        file.append(frame)


def _shapes(snapshot: Snapshot) -> list[dict]:
    """The sphere of each type, {} if its particles differ: a file without any size means a diameter of 1."""
    return [
        {"type": "Sphere", "diameter": float(sizes[0])} if len(sizes) == 1 else {} for sizes in snapshot.sizes
    ]


def _write_data(path: Path, snapshot: Snapshot) -> None:
    """LAMMPS data of atom_style sphere: its density is that of a ball of the particle's mass and diameter."""
    count = len(snapshot.positions)
    density = snapshot.masses / (math.pi / 6.0 * snapshot.diameters**3)
    low = np.array([0.0, 0.0, -0.5 * snapshot.lengths[2] if snapshot.dimension == 2 else 0.0])
    lines = [
        f"gaspart: {count} particles at time {snapshot.time!r}; atom_style sphere",
        "",
        f"{count} atoms",
        f"{len(snapshot.sizes)} atom types",
        "",
    ]
    for axis, start, side in zip("xyz", low, snapshot.lengths, strict=True):
        lines.append(f"{float(start)!r} {float(start + side)!r} {axis}lo {axis}hi")
    lines += ["", "Atoms # sphere", ""]
    for n in range(count):
        numbers = (snapshot.diameters[n], density[n], *snapshot.positions[n])
        lines.append(f"{n + 1} {snapshot.types[n] + 1} " + " ".join(f"{x:.9g}" for x in numbers))
    lines += ["", "Velocities", ""]
    for n, velocity in enumerate(snapshot.velocities):
        lines.append(f"{n + 1} " + " ".join(f"{x:.9g}" for x in velocity) + " 0 0 0")
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
