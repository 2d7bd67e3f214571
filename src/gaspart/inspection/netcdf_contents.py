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

import numpy as np

from gaspart.errors import SceneError
from gaspart.files import open_regular
from gaspart.inspection.contents import Contents, Overrides
from gaspart.inspection.frames import Vectors, map_frames, read_in_blocks
from gaspart.scene.boundaries import refuse_open
from gaspart.state.insertion import per_particle
from gaspart.trajectory.amber import BOOKKEEPING
from gaspart.trajectory.opening import check_frames, open_descriptor, open_netcdf
from gaspart.trajectory.recipe import read_recipe

# Size of a netCDF-3 file according to its header. If a file is shorter, the library reads zeros without a
# warning.
#
# The format: https://docs.unidata.ucar.edu/netcdf-c/current/file_format_specifications.html


_WIDTHS = {1: 1, 2: 1, 3: 2, 4: 4, 5: 4, 6: 8, 7: 1, 8: 2, 9: 4, 10: 8, 11: 8}
"""Bytes per value of each type, by the type number."""
_OFFSETS = {1: 4, 2: 8, 5: 8}
"""Bytes of an offset, by the format version. A count has 8 bytes in version 5, otherwise 4."""


class _Header:
    """Reader of the numbers and names of a header, in their order.

    The methods raise ValueError at the end of the header.
    """

    def __init__(self, file: BinaryIO, version: int) -> None:
        self._file, self._offset, self._count = file, _OFFSETS[version], 8 if version == 5 else 4

    def _bytes(self, length: int) -> bytes:
        content = self._file.read(length)
        if len(content) < length:
            raise ValueError("the file ends within its header")
        return content

    def count(self) -> int:
        """Read a number of items."""
        return int.from_bytes(self._bytes(self._count), "big")

    def offset(self) -> int:
        """Read an offset in the file."""
        return int.from_bytes(self._bytes(self._offset), "big")

    def word(self) -> int:
        """Read a tag or a type."""
        return int.from_bytes(self._bytes(4), "big")

    def items(self) -> int:
        """Read the number of items of a list, after its tag."""
        self.word()
        return self.count()

    def skip(self, length: int) -> None:
        """Skip values, which are padded to words."""
        self._file.seek(_pad_length(length), 1)

    def skip_attributes(self) -> None:
        """Skip a list of attributes."""
        for _ in range(self.items()):
            self.skip(self.count())
            width = _WIDTHS.get(self.word(), 0)
            self.skip(width * self.count())


def _pad_length(length: int) -> int:
    return -(-length // 4) * 4


def needed_bytes(file: BinaryIO) -> int | None:
    """Return the minimum size of a netCDF-3 file in bytes; None if it has another format.

    Raises ValueError for a damaged header.
    """
    file.seek(0)
    magic = file.read(4)
    if magic[:3] != b"CDF" or magic[3] not in _OFFSETS:
        return None
    try:
        return _size(_Header(file, magic[3]))
    except (IndexError, OverflowError, OSError):  # offsets outside of the file
        raise ValueError("damaged header") from None


def _size(header: _Header) -> int | None:
    """Return the end of the last value of any variable."""
    records = header.count()
    sides = []
    for _ in range(header.items()):
        header.skip(header.count())
        sides.append(header.count())
    header.skip_attributes()
    fixed, of_records = [0], []
    for _ in range(header.items()):
        header.skip(header.count())
        shape = [sides[header.count()] for _ in range(header.count())]
        header.skip_attributes()
        width = _WIDTHS.get(header.word(), 0)
        header.count()  # the size in the header has only 32 bits
        begin = header.offset()
        if shape[:1] == [0]:
            of_records.append((begin, width * math.prod(shape[1:])))
        else:
            fixed.append(begin + width * math.prod(shape))
    if not of_records or records == 0:
        return max(fixed)
    if records in (2**32 - 1, 2**64 - 1):
        return None  # a file that is being written: the library computes the number of records from the size
    step = sum(_pad_length(size) for _, size in of_records) if len(of_records) > 1 else of_records[0][1]
    return max(*fixed, *(begin + (records - 1) * step + size for begin, size in of_records))


_RIGHT_ANGLE = 2e-5
"""Deviation from 90 degrees that is attributed to single precision."""
_POSITIONS = ("coordinates", "unwrapped_coordinates", "scaled_coordinates")
_LABELS = {"spatial": "xyz", "cell_spatial": "abc"}
_REPLICAS = ("remd_indices", "remd_repidx", "remd_crdidx", "remd_values")
_INTERACTIONS = ("forces", "q", "charge")
_PACKING = ("scale_factor", "add_offset", "missing_value", "valid_min", "valid_max", "valid_range")
"""Attributes that change or mask the numbers of a variable."""
_IDS = ("id", "identifier")
_TYPES = ("type", "atom_types")
_SECONDS = ("second", "microsecond", "nanosecond", "picosecond", "femtosecond", "atomic time unit")


def read_netcdf(path: Path, overrides: Overrides) -> Contents:
    """Read all frames.

    Raises SceneError for contents that cannot be checked. Errors of the library for unreadable files are
    passed on.
    """
    by_gaspart = is_own(path)
    if by_gaspart:
        check_frames(path)
        refuse_open(read_recipe(path).scene, "changes the particles: frames are those of particles that stay")
    file = _OpenFile(open_netcdf(path) if by_gaspart else _foreign(path))
    _check_convention(file, path)
    contents = _contents(file, overrides, path)
    if by_gaspart:
        _add_scene(contents, path)
    return contents


class _OpenFile:
    """Open netCDF4.Dataset, which is closed as soon as no vectors are read from it any more.

    A Dataset alone would stay open until the garbage collector finds the references among its parts.
    """

    def __init__(self, dataset: Any) -> None:
        self._dataset = dataset

    def __getattr__(self, name: str) -> Any:
        return getattr(self._dataset, name)

    def __getitem__(self, name: str) -> Any:
        return self._dataset[name]

    def __del__(self) -> None:
        self._dataset.close()


def is_own(path: Path) -> bool:
    """Return True if gaspart wrote a file.

    Several attributes are tested, so that damage to one of them does not matter.
    """
    with open_regular(path) as file:
        head = file.read(4096)
    return any(name.encode() in head for name in BOOKKEEPING)


def _foreign(path: Path) -> Any:
    """Open a netCDF file of another program; reject a file that ends before its last value."""
    with open_regular(path) as file:
        minimum, size = needed_bytes(file), os.fstat(file.fileno()).st_size
        if minimum is not None and size < minimum:
            rule = f"is truncated: {size} bytes, where its header states {minimum}"
            raise SceneError("file", str(path), rule)
        return open_descriptor(file)


def _check_convention(file: Any, path: Path) -> None:
    """Raise SceneError for another convention, another version, or frames of several systems."""
    conventions = re.split(r"[,\s]+", str(getattr(file, "Conventions", "")))
    if not {"AMBER", "AMBERRESTART"} & set(conventions):
        raise SceneError("Conventions", " ".join(conventions), "must be AMBER or AMBERRESTART", str(path))
    version = str(getattr(file, "ConventionVersion", "1.0"))
    if version != "1.0":
        raise SceneError("ConventionVersion", version, "must be 1.0", str(path))
    for name, label in _LABELS.items():
        stated = _read(file, name)
        if stated is not None and stated.dtype.kind == "S":
            text = b"".join(stated.ravel().tolist()).decode("ascii", "replace").strip("\0 ")
            if text not in ("", label):
                raise SceneError(name, text, f"must be {label}", str(path))
    temperatures = _read(file, "temp0")
    exchanged = [name for name in _REPLICAS if name in file.variables]
    if temperatures is not None and np.ptp(temperatures) != 0.0:
        exchanged = ["temp0", *exchanged]
    if exchanged:
        raise SceneError("file", str(path), f"is of replica exchange ({exchanged[0]}), not of one system")


def _read(file: Any, name: str) -> np.ndarray | None:
    """Read the values of a variable, with NaN for values that were never written.

    Return None if the variable does not exist or is empty.
    """
    if name not in file.variables:
        return None
    _check_packing(file[name])
    values, absent = _values(file[name], ...)
    return None if absent.size and absent.all() else values


def _check_packing(variable: Any) -> None:
    """Raise ValueError for text in the place of a number that changes the values of a variable."""
    for attribute in _PACKING:
        if isinstance(getattr(variable, attribute, None), str) and variable.dtype.kind != "S":
            raise ValueError(f"{attribute} of {variable.name} must be a number")


def _values(variable: Any, index: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return values of a variable, NaN where they were never written, and the mask of the latter."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the library says which of these numbers it does not use
        values = variable[index]
    absent = np.ma.getmaskarray(values)
    if not absent.any():
        return np.asarray(np.ma.getdata(values)), absent
    return np.ma.filled(values.astype(float) if values.dtype.kind in "iu" else values, np.nan), absent


def _read_vectors(file: Any, name: str, path: Path) -> Vectors | None:
    """Return the vectors of all frames, which are read when they are used.

    Return None in the same cases as `_read`.
    """
    variable = file.variables.get(name)
    if variable is None or variable.ndim != 3 or variable.dimensions[0] != "frame":
        return _read_frames(file, name, path)
    _check_packing(variable)
    if all(_values(variable, n)[1].all() for n in range(len(variable))):
        return None
    return read_in_blocks(variable.shape, lambda frames: _values(file[name], frames)[0])


def _read_frames(file: Any, name: str, path: Path, width: int | None = None) -> np.ndarray | None:
    """Read the values (frame, ...) of a variable in every frame, or in a restart file.

    A restart file has a single frame. Return None in the same cases as `_read`.
    """
    values = _read(file, name)
    if values is None:
        return None
    values = values if file[name].dimensions[:1] == ("frame",) else values[None]
    if width is not None and values.shape[1:] != (width,):
        raise SceneError("file", str(path), f"has {name} of the shape {values.shape}, not (frame, {width})")
    return values


def _contents(file: Any, overrides: Overrides, path: Path) -> Contents:
    """Return the fields of a file whose frames all have a complete set of particles."""
    lengths = _read_frames(file, "cell_lengths", path, 3)
    origin = _read_frames(file, "cell_origin", path, 3)
    angles = _read_frames(file, "cell_angles", path, 3)
    if angles is not None and lengths is not None and lengths.any():
        tilted = np.any(np.abs(angles - 90.0) > _RIGHT_ANGLE, axis=1)
        if tilted.any():
            rule = "a tilted cell cannot be checked"
            raise SceneError("cell_angles", angles[tilted.argmax()].tolist(), rule, str(path))
    positions, resolution = _positions(file, overrides, lengths, origin, path)
    time, time_resolution = (None, 0.0) if overrides.time_step is not None else _times(file)
    if overrides.time_step is None:
        _check_units(file, path)
    radii, diameters = (_read(file, _find_variable(file, name)) for name in ("radius", "diameter"))
    velocities, reason = _velocities(file, path)
    acting = (_read(file, _find_variable(file, name)) for name in _INTERACTIONS)
    contents = Contents(
        positions=positions,
        velocities=velocities,
        time=time,
        radii=0.5 * diameters if radii is None and diameters is not None else radii,
        masses=_read(file, _find_variable(file, "mass")),
        ids=_read_frames(file, _find_variable(file, *_IDS), path),
        lengths=lengths,
        origin=origin,
        plain=not any(np.any(values) for values in acting if values is not None),
        resolution=resolution,
        time_resolution=time_resolution,
        no_velocities=reason,
    )
    kinds = _find_variable(file, *_TYPES)
    if kinds in file.variables and file[kinds].ndim == 2:
        contents.species = _read_frames(file, kinds, path)
    _check_shapes(contents, path)
    return contents


def _find_variable(file: Any, *names: str) -> str:
    """Return the first of several names that exists in a file.

    Names in lower and upper case (Radius) are accepted. If none exists, return the first name.
    """
    there = {name.lower(): name for name in file.variables} | {name: name for name in file.variables}
    return next((there[name] for name in names if name in there), names[0])


def _velocities(file: Any, path: Path) -> tuple[Vectors | None, str | None]:
    """Return the velocities (T, N, 3), or None and the reason if some frames have none."""
    values = _read_vectors(file, "velocities", path)
    if values is None or len(values.shape) != 3:
        return values, None
    stored = sum(bool(np.isfinite(frame).any()) for frame in values)
    if stored == len(values):
        return values, None
    return None, f"velocities are stored in {stored} of {len(values)} frames only"


def _positions(
    file: Any, overrides: Overrides, lengths: np.ndarray | None, origin: np.ndarray | None, path: Path
) -> tuple[Vectors, float]:
    """Return the positions and their resolution.

    Positions are (T, N, 3), or (T, N, 2) if z was never written.
    """
    name = next((name for name in _POSITIONS if name in file.variables), None)
    if name is None or "atom" not in file.dimensions:
        raise SceneError("file", str(path), "has no coordinates in frames: not AMBER's convention")
    positions = _read_vectors(file, name, path)
    if positions is None or len(positions.shape) != 3:
        raise SceneError("file", str(path), f"has no frame of {name}")
    if positions.shape[2] == 3 and all(np.isnan(frame[:, 2]).all() for frame in positions):
        positions = map_frames(positions, lambda frame, n: frame[:, :2], 2)
    scale = 1.0
    if name == "scaled_coordinates":
        sides = lengths if overrides.lengths is None else np.array([overrides.lengths])
        d = positions.shape[2]
        if sides is None or sides.shape[1] < d or not (sides[:, :d] > 0.0).all():
            rule = f"does not state them, and {name} are multiples of them: give --lengths X,Y[,Z]"
            raise SceneError("lengths", None, f"{path} {rule}")
        low = np.zeros((1, d)) if origin is None else origin
        positions = map_frames(
            positions, lambda frame, n: frame * sides[n % len(sides), :d] + low[n % len(low), :d]
        )
        scale = float(sides.max())
    reach = 0.0
    for n, frame in enumerate(positions):
        if not np.isfinite(frame).all():
            count = np.isfinite(frame).all(axis=1).sum()
            rule = f"has {count} particles in frame {n}, of {positions.shape[1]}"
            raise SceneError("file", str(path), f"{rule}: a changing number cannot be checked")
        reach = max(reach, float(np.abs(frame).max(initial=0.0)))
    kind, factor = file[name].dtype, abs(float(getattr(file[name], "scale_factor", 1.0)))
    if kind.kind in "iu":
        return positions, factor * scale
    extents = np.zeros(1) if lengths is None else lengths[np.isfinite(lengths)]
    return positions, float(np.finfo(kind).eps * max(reach, float(extents.max(initial=0.0))))


def _times(file: Any) -> tuple[np.ndarray | None, float]:
    """Return the times in double precision, and their resolution.

    LAMMPS may store steps and a scale factor instead. OVITO stores frame numbers in `time`, and the time, if
    it is known, in `Time`.
    """
    name = "Time" if str(getattr(file, "program", "")) == "OVITO" else "time"
    if name not in file.variables:
        return None, 0.0
    variable = file[name]
    variable.set_auto_scale(False)
    time = _read_frames(file, name, Path())
    if time is None:
        return None, 0.0
    factor = float(getattr(variable, "scale_factor", 1.0))
    eps = float(np.finfo(variable.dtype).eps) if variable.dtype.kind == "f" else 0.0
    steps = eps > 0.0 and factor != 1.0 and bool(np.all(time == np.round(time)))
    resolution = 0.0 if steps else eps * abs(factor) * float(np.abs(time[np.isfinite(time)]).max(initial=0.0))
    return time.astype(float) * factor + float(getattr(variable, "add_offset", 0.0)), resolution


def _check_units(file: Any, path: Path) -> None:
    """Raise SceneError if velocities and times have different time units.

    An example is LAMMPS `units electron`.
    """
    units = [str(getattr(file.variables.get(name), "units", "")).lower() for name in ("velocities", "time")]
    of_velocity, of_time = (unit.rpartition("/")[2].removesuffix("s") for unit in units)
    if of_velocity in _SECONDS and of_time in _SECONDS and of_velocity != of_time:
        rule = f"of time differ, {units[0]} and {units[1]}: give --time-step in the unit of the velocities"
        raise SceneError("units", units, rule, str(path))


def _check_shapes(contents: Contents, path: Path) -> None:
    """Raise SceneError for fields with another number of frames or particles than the positions."""
    frames, count, _ = contents.positions.shape
    expected: dict[str, list[tuple[int, ...]]] = {
        "velocities": [(frames, count, 3), (frames, count, 2)],
        "time": [(frames,)],
        "radii": [(count,), (frames, count)],
        "masses": [(count,), (frames, count)],
        "ids": [(frames, count)],
        "species": [(frames, count)],
        "lengths": [(frames, 3)],
        "origin": [(frames, 3)],
    }
    for name, shapes in expected.items():
        values = getattr(contents, name)
        if values is not None and values.shape not in shapes:
            raise SceneError("file", str(path), f"has {name} of the shape {values.shape}, not {shapes[0]}")


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
