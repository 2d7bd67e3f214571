"""States from a trajectory: its last one, and frames as files of other programs."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gaspart.errors import SceneError, optional
from gaspart.files import FileKind, begins_with, output_path, writing
from gaspart.keys.values import count_of
from gaspart.scene.boundaries import refuse_open
from gaspart.scene.faces import GRADIENT
from gaspart.state.given import state_from_arrays
from gaspart.state.insertion import per_particle
from gaspart.state.state import State
from gaspart.system import descriptor_path
from gaspart.trajectory import amber
from gaspart.trajectory.opening import check_frames, kept_beside, open_netcdf_file, open_verified, run_path
from gaspart.trajectory.reading import open_trajectory
from gaspart.trajectory.recipe import Recipe, read_recipe
from gaspart.trajectory.run import simulation_of

if TYPE_CHECKING:
    import xarray as xr

ALL = "all"
"""Keyword for all frames of a trajectory."""


def _is_xyz(path: Path) -> bool:
    """Return True if gaspart wrote a file, and the file is an XYZ file."""
    with path.open("rb") as file:
        return b" Program=gaspart\n" in file.read(1000)


EXPORT_FORMATS = {
    ".gsd": FileKind("a GSD file", begins_with(b"\xdf\x65" * 4)),
    ".xyz": FileKind("an XYZ file written by gaspart", _is_xyz),
    ".data": FileKind("LAMMPS data written by gaspart", begins_with(b"gaspart: ")),
}
_ELEMENTS = """
H He Li Be B C N O F Ne Na Mg Al Si P S Cl Ar K Ca Sc Ti V Cr Mn Fe Co Ni Cu Zn Ga Ge As Se Br Kr Rb
Sr Y Zr Nb Mo Tc Ru Rh Pd Ag Cd In Sn Sb Te I Xe Cs Ba La Ce Pr Nd Pm Sm Eu Gd Tb Dy Ho Er Tm Yb Lu
Hf Ta W Re Os Ir Pt Au Hg Tl Pb Bi Po At Rn Fr Ra Ac Th Pa U Np Pu Am Cm Bk Cf Es Fm Md No Lr Rf Db
Sg Bh Hs Mt Ds Rg Cn Nh Fl Mc Lv Ts Og"""
_SYMBOLS = _ELEMENTS.split()
"""Names of species in an XYZ file. They are chemical symbols, because readers such as ASE accept no other
names."""
_ROWS = 4096  # number of table rows that are formatted at once


@dataclass(frozen=True)
class Snapshot:
    """Frame of a trajectory with N particles."""

    positions: np.ndarray
    velocities: np.ndarray
    numbers: np.ndarray
    diameters: np.ndarray
    masses: np.ndarray
    types: np.ndarray
    lengths: np.ndarray
    origin: np.ndarray
    periodic: tuple[bool, ...]
    time: float
    frame: int
    dimension: int


def export(trajectory: str | Path, path: str | Path, frame: int | str = -1, overwrite: bool = False) -> Path:
    """Write a frame of a trajectory as a GSD, XYZ or LAMMPS data file.

    Parameters
    ----------
    trajectory : str or Path
        The trajectory.
    path : str or Path
        The file to write, with the suffix .gsd, .xyz or .data.
    frame : int or "all", default -1
        Number of the frame, counted from 0, or from the end if negative. "all" writes all frames into a .gsd
        or .xyz file, in which each frame has its own number of particles and container.
    overwrite : bool, default False
        Replace a file of the same kind at `path`. Files of other kinds are never replaced.

    Returns
    -------
    Path
        `path`.

    Raises
    ------
    SceneError
        If the suffix is unknown, the frame does not exist, or a file cannot be read or written.

    Examples
    --------
    >>> import gaspart as gp
    >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)])
    >>> path = gp.run(scene, seed=1, duration=2.0, sample_interval=0.1, path="gas.nc")
    >>> exported = gp.export(path, "gas.xyz", frame="all")
    >>> len(exported.read_text().splitlines())  # 21 frames of 2 + 20 lines
    462
    """
    path = output_path(path)
    if path.suffix not in EXPORT_FORMATS:
        raise SceneError("output", str(path), f"must end in {', '.join(EXPORT_FORMATS)}")
    if frame == ALL and path.suffix == ".data":
        raise SceneError("frame", frame, "LAMMPS data has one frame: give its number, or write .xyz or .gsd")
    snapshots = _snapshots(run_path(trajectory), frame)
    write = {".gsd": _write_gsd, ".xyz": _write_xyz, ".data": _write_data}[path.suffix]
    with writing(path, EXPORT_FORMATS[path.suffix], overwrite) as scratch:
        write(scratch, snapshots)
    return path


def _snapshots(path: Path, frame: int | str) -> Iterator[Snapshot]:
    """Return an iterator over one frame, or all for "all"; errors are raised immediately."""
    recipe = read_recipe(path)
    recipe.require_all(path)
    with open_netcdf_file(path) as file:
        there = len(file.dimensions["frame"])
    if frame == ALL:
        numbers = range(there)
    elif not -there <= count_of("frame", frame, least=-there) < there:
        raise SceneError("frame", frame, f"must be one of {there} frames")
    else:
        # in an unfinished file, netCDF counts -1 from the end of the allocated frames
        frame = int(frame) % there
        numbers = range(frame, frame + 1)
    check_frames(path, numbers)
    return _read(path, numbers)


def _read(path: Path, numbers: range) -> Iterator[Snapshot]:
    """Yield the frames of a trajectory with these indices."""
    scene = read_recipe(path).scene
    with open_netcdf_file(path) as file:
        diameters, types = 2.0 * np.asarray(file["radius"][:]), np.asarray(file["type"][:])
        masses = np.resize(per_particle(scene, "mass"), scene.capacity)[: len(types)].astype(float)
        for n in numbers:
            positions = np.asarray(file["coordinates"][n], dtype=float)
            # False for numbers without a particle in scenes with open faces
            inside = np.isfinite(positions).all(axis=1)
            piston = np.asarray(file["piston"][n]) if scene.has_piston else None
            # not read from the file: in early versions, cells had the length of the whole container, and
            # cells of discs the height of a diameter
            cell = amber.cell(scene, np.array(scene.container.lengths), piston)
            yield Snapshot(
                positions=positions[inside],
                velocities=np.asarray(file["velocities"][n], dtype=float)[inside],
                numbers=np.flatnonzero(inside),
                diameters=diameters[inside],
                masses=masses[inside],
                types=types[inside],
                lengths=cell["cell_lengths"],
                origin=cell.get("cell_origin", np.zeros(3)),
                periodic=(*scene.container.periodic, True)[:3],
                time=float(file["time"][n]),
                frame=n,
                dimension=scene.dimension,
            )


def _write_gsd(path: Path, snapshots: Iterator[Snapshot]) -> None:
    """Write frames as a GSD file in HOOMD's schema. The entry `log/time` contains the time of a frame. The
    entry `log/cell_origin` contains the lower corner of the box in the scene's coordinates, which a piston
    may move. The step of a frame is its index.
    """
    hoomd = optional("gsd.hoomd", "gsd", "GSD files")
    with path.open("rb") as scratch, hoomd.open(descriptor_path(scratch), "w") as file:
        for snapshot in snapshots:
            file.append(_gsd_frame(hoomd.Frame(), snapshot))


def _gsd_frame(frame: Any, snapshot: Snapshot) -> Any:
    """Fill a GSD frame, with its origin in the middle of the box, whose thickness is zero for discs."""
    sides = np.where([False, False, snapshot.dimension == 2], 0.0, snapshot.lengths)
    frame.configuration.dimensions = snapshot.dimension
    frame.configuration.step = snapshot.frame
    frame.configuration.box = [*sides, 0.0, 0.0, 0.0]
    frame.particles.N = len(snapshot.positions)
    frame.particles.types = [f"species_{n}" for n in range(int(snapshot.types.max(initial=0)) + 1)]
    frame.particles.typeid = snapshot.types
    frame.particles.type_shapes = _shapes(snapshot)
    frame.particles.position = snapshot.positions - snapshot.origin - 0.5 * sides
    frame.particles.velocity = snapshot.velocities
    frame.particles.diameter = snapshot.diameters
    frame.particles.mass = snapshot.masses
    frame.log = {"time": np.array([snapshot.time]), "cell_origin": np.array(snapshot.origin, dtype=float)}
    return frame


def _shapes(snapshot: Snapshot) -> list[dict]:
    """Return the shape of each type, without which other programs assume a diameter of 1; {} for several
    sizes.
    """
    shapes: list[dict] = []
    for n in range(int(snapshot.types.max(initial=0)) + 1):
        sizes = np.unique(snapshot.diameters[snapshot.types == n]).tolist()
        shapes.append({"type": "Sphere", "diameter": sizes[0]} if len(sizes) == 1 else {})
    return shapes


def _write_xyz(path: Path, snapshots: Iterator[Snapshot]) -> None:
    """Write an extended XYZ file with boundary conditions and particle numbers."""
    columns = "species:S:1:pos:R:3:velo:R:3:radius:R:1:masses:R:1:id:I:1"
    with path.open("w", encoding="ascii") as file:
        for snapshot in snapshots:
            cell = " ".join(repr(x) for x in np.diag(snapshot.lengths).ravel().tolist())
            origin = " ".join(repr(x) for x in snapshot.origin.tolist())
            pbc = " ".join("T" if along else "F" for along in snapshot.periodic)
            comment = (
                f'Lattice="{cell}" Origin="{origin}" pbc="{pbc}" Properties={columns} Time={snapshot.time!r}'
            )
            file.write(f"{len(snapshot.positions)}\n{comment} Program=gaspart\n")
            if snapshot.types.max(initial=0) >= len(_SYMBOLS):
                warnings.warn(f"names of species repeat after {len(_SYMBOLS)}; radii differ", stacklevel=2)
            kinds = [_SYMBOLS[kind % len(_SYMBOLS)] for kind in snapshot.types.tolist()]
            numbers = *snapshot.positions.T, *snapshot.velocities.T, 0.5 * snapshot.diameters, snapshot.masses
            template = f"%s {' '.join(['%.9g'] * len(numbers))} %d\n"
            file.writelines(_rows(template, np.array(kinds, dtype=object), *numbers, snapshot.numbers + 1))


def _write_data(path: Path, snapshots: Iterator[Snapshot]) -> None:
    """Write a LAMMPS data file of atom_style sphere, with mass over the volume of a ball as density."""
    (snapshot,) = snapshots
    count = len(snapshot.positions)
    density = snapshot.masses / (math.pi / 6.0 * snapshot.diameters**3)
    low = snapshot.origin - [0.0, 0.0, 0.5 * snapshot.lengths[2] if snapshot.dimension == 2 else 0.0]
    lines = [
        f"gaspart: {count} particles at time {snapshot.time!r}; atom_style sphere",
        "",
        f"{count} atoms",
        f"{int(snapshot.types.max(initial=0)) + 1} atom types",
        "",
    ]
    for axis, start, side in zip("xyz", low, snapshot.lengths, strict=True):
        lines.append(f"{float(start)!r} {float(start + side)!r} {axis}lo {axis}hi")
    lines += ["", "Atoms # sphere", ""]
    ids, numbers = np.arange(1, count + 1), (snapshot.diameters, density, *snapshot.positions.T)
    with path.open("w", encoding="ascii") as file:
        file.writelines(f"{line}\n" for line in lines)
        file.writelines(_rows("%d %d %.9g %.9g %.9g %.9g %.9g\n", ids, snapshot.types + 1, *numbers))
        file.write("\nVelocities\n\n")
        file.writelines(_rows("%d %.9g %.9g %.9g 0 0 0\n", ids, *snapshot.velocities.T))


def _rows(template: str, *columns: np.ndarray) -> Iterator[str]:
    """Yield the text of a table in blocks of rows, which are fast to format."""
    for first in range(0, len(columns[0]), _ROWS):
        block = [column[first : first + _ROWS].tolist() for column in columns]
        yield template * len(block[0]) % tuple(chain.from_iterable(zip(*block, strict=True)))


def last_state(path: str | Path) -> State:
    """Return the state of all particles at the end of a trajectory.

    The state is exact if the run was made with `keep_checkpoint`. Otherwise positions, velocities and spins
    are from the last frame, in single precision, and a warning is issued. The motion of a piston and the
    displacement of sheared images are exact.

    Parameters
    ----------
    path : str or Path
        The trajectory.

    Returns
    -------
    State
        The state. Another run can start from it.

    Raises
    ------
    SceneError
        If `open_trajectory` rejects the file, or if a stored checkpoint is damaged or belongs to another run.
        Without a checkpoint, SceneError is also raised if the last frame does not contain all particles
        (`follow`) or all properties (`keep`), or if a frame does not determine the state (in a scene with
        sticky faces).

    Examples
    --------
    >>> import gaspart as gp
    >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)])
    >>> path = gp.run(scene, seed=1, duration=2.0, sample_interval=0.1, path="gas.nc")
    >>> gp.last_state(path).time
    2.0
    """
    path = run_path(path)
    recipe = read_recipe(path)
    with open_verified(path) as (_, header, frames):
        checkpoint = kept_beside(path, header, "to start from the last frame, in single precision")
    if checkpoint and checkpoint.frames == frames:
        simulation = simulation_of(recipe)
        simulation.restore(checkpoint.arrays)
        return simulation.state.copy()
    refuse_open(recipe.scene, f"changes the particles, and {path} has no checkpoint of its end")
    if recipe.stored_count < recipe.scene.count:
        rule = f"has {recipe.stored_count} of {recipe.scene.count} particles, and no checkpoint"
        raise SceneError("file", str(path), rule)
    recipe.require_all(path)
    with open_trajectory(path) as data:
        if data.sizes["frame"] == 0:
            raise SceneError("frame", 0, "the trajectory has no frame yet")
        state = _of_frame(recipe, data.isel(frame=-1))
    rule = "has no checkpoint of its end (keep_checkpoint): its last state is known in single precision only"
    warnings.warn(f"gaspart: {path}: {rule}", stacklevel=2)
    return state


def _of_frame(recipe: Recipe, frame: xr.Dataset) -> State:
    """Return the state from a frame that contains all particles."""
    scene, time = recipe.scene, float(frame["time"])
    positions, velocities = (frame[name].values.astype(float) for name in ("coordinates", "velocities"))
    spins, vibrations = (
        frame[name].values.astype(float) if name in frame else None for name in ("spins", "vibrations")
    )
    piston, displaced = None, None
    if scene.has_piston:
        piston = np.array([float(frame[f"piston_{name}"]) for name in ("position", "velocity")])
    if scene.shear_rate is not None:
        begun = recipe.initial.displaced if recipe.initial else None
        displaced = (begun or 0.0) + scene.shear_rate * scene.container.lengths[GRADIENT] * time
    return replace(
        state_from_arrays(scene, positions, velocities, spins, piston, displaced, vibrations), time=time
    )
