"""Contents of a netCDF file of the AMBER convention, version 1.0.

The convention is https://ambermd.org/netcdf/nctraj.xhtml. LAMMPS (`dump netcdf`), OVITO and gaspart add
further variables.
"""

from __future__ import annotations

import math
import os
import re
import warnings
from pathlib import Path
from typing import Any, BinaryIO

import netCDF4
import numpy as np

from gaspart.errors import SceneError
from gaspart.files import open_regular
from gaspart.inspection.contents import Contents, Overrides
from gaspart.inspection.frames import Vectors, map_frames, read_in_blocks
from gaspart.scene.boundaries import refuse_open
from gaspart.state.insertion import per_particle
from gaspart.system import descriptor_path
from gaspart.trajectory.amber import BOOKKEEPING
from gaspart.trajectory.opening import check_frames
from gaspart.trajectory.recipe import read_recipe

_WIDTHS = {1: 1, 2: 1, 3: 2, 4: 4, 5: 4, 6: 8, 7: 1, 8: 2, 9: 4, 10: 8, 11: 8}
"""Bytes per value of each type of netCDF-3, by the type number."""
_OFFSETS = {1: 4, 2: 8, 5: 8}
"""Bytes of an offset, by the format version. A count has 8 bytes in version 5, otherwise 4."""
_RIGHT_ANGLE = 2e-5
"""Deviation from 90 degrees that is attributed to single precision."""


def needed_bytes(file: BinaryIO) -> int | None:
    """Return the minimum size of a netCDF-3 file according to its header; None for another format. If a file
    is shorter, the library reads zeros without a warning. The format:
    https://docs.unidata.ucar.edu/netcdf-c/current/file_format_specifications.html
    """
    file.seek(0)
    magic = file.read(4)
    if magic[:3] != b"CDF" or magic[3] not in _OFFSETS:
        return None
    width = 8 if magic[3] == 5 else 4

    def number(size: int = width) -> int:
        if len(content := file.read(size)) < size:
            raise ValueError("the file ends within its header")
        return int.from_bytes(content, "big")

    def items() -> range:
        number(4)  # tag
        return range(number())

    def skip(length: int) -> None:
        file.seek(_padded(length), 1)

    def skip_attributes() -> None:
        for _ in items():
            skip(number())
            skip(_WIDTHS.get(number(4), 0) * number())

    records, sides, ends, of_records = number(), [], [0], []
    for _ in items():
        skip(number())
        sides.append(number())
    skip_attributes()
    for _ in items():
        skip(number())
        shape = [sides[number()] for _ in range(number())]
        skip_attributes()
        size = _WIDTHS.get(number(4), 0) * math.prod(shape[1:] if shape[:1] == [0] else shape)
        number()  # the size in the header has only 32 bits
        begin = number(_OFFSETS[magic[3]])
        if shape[:1] == [0]:
            of_records.append((begin, size))
        else:
            ends.append(begin + size)
    if not of_records or records == 0:
        return max(ends)
    if records in (2**32 - 1, 2**64 - 1):
        return None  # a file that is being written: the library computes the number of records from the size
    step = sum(_padded(size) for _, size in of_records) if len(of_records) > 1 else of_records[0][1]
    return max(*ends, *(begin + (records - 1) * step + size for begin, size in of_records))


def _padded(length: int) -> int:
    return -(-length // 4) * 4


def read_netcdf(path: Path, overrides: Overrides) -> Contents:
    """Read all frames; raise SceneError for contents that cannot be checked."""
    by_gaspart = is_own(path)
    if by_gaspart:
        check_frames(path)
        refuse_open(read_recipe(path).scene, "changes the particles: frames are those of particles that stay")
    contents = _contents(_open(path), overrides, path)
    if by_gaspart:
        _add_scene(contents, path)
    return contents


def is_own(path: Path) -> bool:
    """Return True if gaspart wrote a file; damage to one of several attributes does not matter."""
    with open_regular(path) as file:
        head = file.read(4096)
    return any(name.encode() in head for name in BOOKKEEPING)


def _open(path: Path) -> Any:
    """Open a file of the convention; reject a file that ends before its last value."""
    with open_regular(path) as opened:
        minimum, size = needed_bytes(opened), os.fstat(opened.fileno()).st_size
        if minimum is not None and size < minimum:
            rule = f"is truncated: {size} bytes, where its header states {minimum}"
            raise SceneError("file", str(path), rule)
        # closed as soon as no vectors are read from it any more: variables do not keep it open
        file = netCDF4.Dataset(descriptor_path(opened), keepweakref=True)
    conventions = re.split(r"[,\s]+", str(getattr(file, "Conventions", "")))
    if not {"AMBER", "AMBERRESTART"} & set(conventions):
        raise SceneError("Conventions", " ".join(conventions), "must be AMBER or AMBERRESTART", str(path))
    version = str(getattr(file, "ConventionVersion", "1.0"))
    if version != "1.0":
        raise SceneError("ConventionVersion", version, "must be 1.0", str(path))
    return file


def _find(file: Any, *names: str) -> str | None:
    """Return the name of the first variable that exists, in small or capital letters (Radius)."""
    there = {name.lower(): name for name in file.variables} | {name: name for name in file.variables}
    return next((there[name] for name in names if name in there), None)


def _values(variable: Any, index: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return values of a variable, NaN where they were never written, and the mask of the latter."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the library says which of these numbers it does not use
        values = variable[index]
    absent = np.ma.getmaskarray(values)
    if not absent.any():
        return np.asarray(np.ma.getdata(values)), absent
    return np.ma.filled(values.astype(float) if values.dtype.kind in "iu" else values, np.nan), absent


def _read(file: Any, *names: str) -> np.ndarray | None:
    """Return the values of the first variable that exists; None if it was never written."""
    if (name := _find(file, *names)) is None:
        return None
    values, absent = _values(file[name], ...)
    return None if absent.size and absent.all() else values


def _read_frames(file: Any, *names: str) -> np.ndarray | None:
    """Return the values (frame, ...) as `_read`; the variables of a restart file have a single frame."""
    values = _read(file, *names)
    if values is None or file[_find(file, *names)].dimensions[:1] == ("frame",):
        return values
    return values[None]


def _read_vectors(file: Any, name: str) -> Vectors | None:
    """Return the vectors of all frames as `_read_frames`; they are read when they are used."""
    variable = file.variables.get(name)
    if variable is None or variable.ndim != 3 or variable.dimensions[0] != "frame":
        return _read_frames(file, name)
    if all(_values(variable, n)[1].all() for n in range(len(variable))):
        return None
    return read_in_blocks(variable.shape, lambda frames: _values(file[name], frames)[0])


def _contents(file: Any, overrides: Overrides, path: Path) -> Contents:
    """Return the fields of a file whose frames all have a complete set of particles."""
    lengths, angles = _read_frames(file, "cell_lengths"), _read_frames(file, "cell_angles")
    if angles is not None and lengths is not None and lengths.any():
        tilted = np.any(np.abs(angles - 90.0) > _RIGHT_ANGLE, axis=1)
        if tilted.any():
            rule = "a tilted cell cannot be checked"
            raise SceneError("cell_angles", angles[tilted.argmax()].tolist(), rule, str(path))
    positions, resolution = _positions(file, lengths, path)
    time, time_resolution = (None, 0.0) if overrides.time_step is not None else _times(file)
    radii, diameters = _read(file, "radius"), _read(file, "diameter")
    velocities, reason = _velocities(file)
    acting = (_read(file, *names) for names in (("forces",), ("q", "charge")))
    contents = Contents(
        positions=positions,
        velocities=velocities,
        time=time,
        radii=0.5 * diameters if radii is None and diameters is not None else radii,
        masses=_read(file, "mass"),
        ids=_read_frames(file, "id", "identifier"),
        lengths=lengths,
        origin=_read_frames(file, "cell_origin"),
        plain=not any(np.any(values) for values in acting if values is not None),
        resolution=resolution,
        time_resolution=time_resolution,
        no_velocities=reason,
    )
    kinds = _find(file, "type", "atom_types")
    if kinds is not None and file[kinds].ndim == 2:
        contents.species = _read_frames(file, kinds)
    _check_shapes(contents, path)
    return contents


def _velocities(file: Any) -> tuple[Vectors | None, str | None]:
    """Return the velocities (T, N, 3), or None and the reason if some frames have none."""
    values = _read_vectors(file, "velocities")
    stored = 0 if values is None else sum(bool(np.isfinite(frame).any()) for frame in values)
    if values is None or stored == len(values):
        return values, None
    return None, f"velocities are stored in {stored} of {len(values)} frames only"


def _positions(file: Any, lengths: np.ndarray | None, path: Path) -> tuple[Vectors, float]:
    """Return the positions, (T, N, 3), or (T, N, 2) if z was never written, and their resolution."""
    name = _find(file, "coordinates", "unwrapped_coordinates")
    positions = None if name is None or "atom" not in file.dimensions else _read_vectors(file, name)
    if positions is None or len(positions.shape) != 3:
        raise SceneError("file", str(path), "has no coordinates in frames: not AMBER's convention")
    if positions.shape[2] == 3 and all(np.isnan(frame[:, 2]).all() for frame in positions):
        positions = map_frames(positions, lambda frame, n: frame[:, :2], 2)
    reach = 0.0
    for n, frame in enumerate(positions):
        if not np.isfinite(frame).all():
            count = np.isfinite(frame).all(axis=1).sum()
            rule = f"has {count} particles in frame {n}, of {positions.shape[1]}"
            raise SceneError("file", str(path), f"{rule}: a changing number cannot be checked")
        reach = max(reach, float(np.abs(frame).max(initial=0.0)))
    kind, factor = file[name].dtype, abs(float(getattr(file[name], "scale_factor", 1.0)))
    if kind.kind in "iu":
        return positions, factor
    extents = np.zeros(1) if lengths is None else lengths[np.isfinite(lengths)]
    return positions, float(np.finfo(kind).eps * max(reach, float(extents.max(initial=0.0))))


def _times(file: Any) -> tuple[np.ndarray | None, float]:
    """Return the times in double precision, and their resolution. LAMMPS may store steps and a scale factor,
    and OVITO frame numbers in `time` and times in `Time`.
    """
    name = "Time" if str(getattr(file, "program", "")) == "OVITO" else "time"
    if name not in file.variables:
        return None, 0.0
    variable = file[name]
    variable.set_auto_scale(False)
    time = _read_frames(file, name)
    if time is None:
        return None, 0.0
    factor = float(getattr(variable, "scale_factor", 1.0))
    eps = float(np.finfo(variable.dtype).eps) if variable.dtype.kind == "f" else 0.0
    steps = eps > 0.0 and factor != 1.0 and bool(np.all(time == np.round(time)))
    resolution = 0.0 if steps else eps * abs(factor) * float(np.abs(time[np.isfinite(time)]).max(initial=0.0))
    return time.astype(float) * factor + float(getattr(variable, "add_offset", 0.0)), resolution


def _check_shapes(contents: Contents, path: Path) -> None:
    """Raise SceneError for fields with another number of frames or particles than the positions."""
    frames, count, _ = contents.positions.shape
    sizes = dict.fromkeys(("velocities", "radii", "masses", "ids", "species"), (frames, count))
    for name, size in (sizes | dict.fromkeys(("time", "lengths", "origin"), (frames,))).items():
        values = getattr(contents, name)
        if values is not None and values.shape[: len(size)] != size and values.shape != size[1:]:
            raise SceneError("file", str(path), f"has {name} of the shape {values.shape}, not {size}")


def _add_scene(contents: Contents, path: Path) -> None:
    """Add the information from the scene in a gaspart trajectory."""
    recipe = read_recipe(path)
    scene = recipe.scene
    elastic = scene.restitution is None or scene.restitution.smooth_and_elastic
    quiet = scene.gravity is None and not scene.faces and not scene.walls and not scene.vibrates
    quiet = quiet and scene.thermostat is None
    free = not any(kind.fixed for kind in scene.kinds)
    alike = len({kind.mass for kind in scene.kinds}) == 1  # all particles, even those not in the file
    d, frames, count = scene.dimension, len(contents.positions), contents.positions.shape[1]
    contents.boundary = tuple("periodic" if periodic else "wall" for periodic in scene.image_axes)
    contents.flat = d == 2
    contents.lengths = np.broadcast_to(scene.container.lengths, (frames, d))
    contents.masses = per_particle(scene, "mass")[:count].astype(float)
    contents.plain = contents.isolated = bool(elastic and quiet and free and alike)
    contents.part = recipe.stored_count < scene.count
    contents.sampled = not recipe.engine.forbids_overlap
    contents.engine, contents.scene = recipe.engine, recipe.scene
    contents.counted = path if recipe.engine.reference else None
