"""File format of trajectories: AMBER NetCDF 1.0, https://ambermd.org/netcdf/nctraj.xhtml.

A netCDF-3 file consists of a header, which the netCDF library makes, and frames of the same size. A checksum
(CRC-32) in the header detects damage; programs other than gaspart ignore it. The checksum is computed without
the number of frames in the header, which changes during a run.
"""

from __future__ import annotations

import os
import struct
import weakref
import zlib
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import fields
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from gaspart.engines import ENGINES, Engine
from gaspart.state.optional_tallies import OptionalTally
from gaspart.state.tally import Tally
from gaspart.trajectory.correlator import meaning_of
from gaspart.trajectory.run_options import KEPT, tallied_fields

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene


NOTE = (
    "Reduced units: lengths and times are in the scene's own units, masses relative to the reference "
    "species, k_B = 1. Picosecond and angstrom stand for these, because readers of AMBER files insist on it."
)
_ALONG = {field.name: field.metadata.get("along", ()) for field in fields(Tally)}
MAGIC = b"CDF\x02"
"""First bytes of a netCDF-3 file with 64-bit offsets."""
FRAME_COUNT_AT = 4
"""Offset of the number of frames in a netCDF-3 header; this number is a big-endian uint32."""
WORD = 4
"""Size in bytes of a checksum, and of every count in a netCDF-3 header."""
_HEAD = 1024  # the attributes `BOOKKEEPING` are within this number of bytes from the start of a file
_VECTORS = ("atom", "spatial")
_ORIGIN = "cell_origin"
_EXTRA: dict[str, tuple[str, tuple[str, ...], dict[str, str]]] = {
    "spins": (
        ">f4",
        _VECTORS,
        {"units": "1/picosecond", "long_name": "angular velocity, in two dimensions along z"},
    ),
    "vibrations": (">f4", ("atom",), {"long_name": "energy of a particle's vibration"}),
    "displacements": (">f8", _VECTORS, {"units": "angstrom", "long_name": "way since time 0, unwrapped"}),
    "pair_collisions": (">f8", ("pair",), {"long_name": "collisions of each pair of species so far"}),
    "piston": (">f8", ("motion",), {"long_name": "place along its axis, and velocity, of the piston"}),
}
"""Variables that only some files have, in the form of `Layout` and in the order of the file."""
INITIAL: tuple[str, ...] = tuple(
    f"initial_{name}" for name in ("positions", "velocities", "spins", "piston", "displaced", "vibrations")
)
"""Variables of a run with a prescribed initial state: arrays of a `State` for all particles of the scene."""
_OF_INITIAL = ("particle", "component")
BOOKKEEPING = ("header_bytes", "header_crc32", "frame_bytes")
"""Attributes by which a file is checked: size and checksum of the header, and size of a frame."""
MOST_FRAMES = 2**31 - 1
_UNFINISHED = bytes(2 * WORD) + struct.pack(">I", 10)
"""First bytes of a file before its first word is written: no frames, and the tag of dimensions."""
_FIRST_NAME = struct.pack(">I", 5) + b"frame"
"""Name of the first dimension, which follows the number of dimensions."""


def counters(engine: Engine, tallies: Iterable[OptionalTally] = ()) -> tuple[str, ...]:
    """Return the cumulative sums, from time 0, of a file of this engine with optional `tallies`."""
    absent = {name for kind in ENGINES.values() for name in kind.counters} - set(engine.counters)
    return tuple(name for name in tallied_fields(tallies) if name not in {"time", *absent})


def cell(scene: Scene, lengths: np.ndarray, piston: np.ndarray | None) -> dict[str, np.ndarray]:
    """Return the variables of a frame that describe the container, which may end at a piston. In two
    dimensions the height along z is the longest side, because other programs assume that z is periodic too.
    """
    sides, origin = np.full(3, float(np.max(lengths))), np.zeros(3)
    sides[: len(lengths)] = lengths
    variables = {"cell_lengths": sides, "cell_angles": np.full(3, 90.0)}
    if piston is None:
        return variables
    for number, _ in scene.pistons:
        axis, high = divmod(number, 2)
        sides[axis] = piston[0] if high else sides[axis] - piston[0]
        origin[axis] = 0.0 if high else piston[0]
    return variables | {_ORIGIN: origin}


def face_names(dimension: int, walls: int = 0) -> list[str]:
    """Return the names (2d + walls,) of faces and interior walls, in the order of counters."""
    faces = [f"{axis} {end}" for axis in "xyz"[:dimension] for end in ("low", "high")]
    return faces + [f"wall {n}" for n in range(walls)]


class Layout:
    """Variables of a frame in file order: (type, dimensions, attributes) by name.

    count : number of particles in the file
    extra : names of the variables of `_EXTRA` that the file has
    walls : number of interior walls
    counters : names of the counters of the file
    sums : names of the sums of the correlations
    axes : lengths of the axes that not every file has: axes of optional tallies, `lag` and `pair`
    keep : key of `KEPT`: the only stored property of the particles
    """

    def __init__(
        self,
        count: int,
        dimension: int,
        extra: Collection[str],
        walls: int,
        counters: Collection[str],
        sums: Collection[str],
        axes: Mapping[str, int],
        keep: str | None = None,
    ) -> None:
        self.sizes = {
            "spatial": 3,
            "atom": count,
            "cell_spatial": 3,
            "cell_angular": 3,
            "label": 5,
            "face": 2 * dimension + walls,
            **axes,
            **({"motion": 2} if "piston" in extra else {}),
        }
        faces = {"faces": ", ".join(face_names(dimension, walls))}
        self.variables = {
            "time": (">f8", (), {"units": "picosecond"}),
            "cell_lengths": (">f8", ("cell_spatial",), {"units": "angstrom"}),
            "cell_angles": (">f8", ("cell_angular",), {"units": "degree"}),
            **({_ORIGIN: (">f8", ("cell_spatial",), {"units": "angstrom"})} if "piston" in extra else {}),
            "kinetic_energy": (">f8", (), {"long_name": "kinetic energy of all particles"}),
            **{name: (">f8", _ALONG[name], faces if "face" in _ALONG[name] else {}) for name in counters},
        }
        vectors = {"coordinates": "angstrom", "velocities": "angstrom/picosecond"}
        for name in vectors if keep is None else [KEPT[keep]]:
            self.variables[name] = (">f4", _VECTORS, {"units": vectors[name]})
        self.variables |= {name: _EXTRA[name] for name in extra}
        if sums:
            meaning = "samples that are correlated, so far"
            self.variables["correlated_samples"] = (">f8", (), {"long_name": meaning})
        for name in sums:
            meaning = f"{meaning_of(name)}, summed over pairs of samples so far"
            self.variables[name] = (">f8", ("lag",), {"long_name": meaning})
        meaning = (
            "CRC-32 of the bytes of this frame before it, which begins with those of the header and frame"
        )
        self.variables["checksum"] = (">i4", (), {"long_name": meaning})

    def shape(self, name: str) -> tuple[int, ...]:
        """Return the shape of a variable in one frame."""
        return tuple(self.sizes[dimension] for dimension in self.variables[name][1])

    @property
    def frame(self) -> np.dtype:
        """Type of a frame in the file. Every variable occupies complete words, without padding."""
        return np.dtype([(name, kind, self.shape(name)) for name, (kind, _, _) in self.variables.items()])

    def header(
        self,
        attributes: dict,
        particles: Mapping[str, np.ndarray],
        initial: Mapping[str, np.ndarray] | None = None,
    ) -> bytes:
        """Return the bytes of a file without frames. `particles`: radius, mass and type of each particle.
        `initial`: properties of the particles at time 0, in double precision, if the user supplied an initial
        state.
        """
        bookkeeping = dict(
            zip(BOOKKEEPING, (np.int32(0), np.int32(0), np.float64(self.frame.itemsize)), strict=True)
        )
        header = bytearray(self._header({**bookkeeping, **attributes}, particles, initial or {}))
        for name, value in (("header_bytes", len), ("header_crc32", zlib.crc32)):
            at = _value_at(header, name)
            header[at : at + WORD] = struct.pack(">I", value(header))
        return bytes(header)

    def _header(
        self, attributes: dict, particles: Mapping[str, np.ndarray], initial: Mapping[str, np.ndarray]
    ) -> bytes:
        import netCDF4

        file = netCDF4.Dataset("header", "w", format="NETCDF3_64BIT_OFFSET", memory=1)
        for name, size in {"frame": None, **self.sizes}.items():
            file.createDimension(name, size)
        for name, value in attributes.items():
            file.setncattr(name, value)
        fixed = {
            "spatial": ("S1", ("spatial",), list("xyz")),
            "cell_spatial": ("S1", ("cell_spatial",), list("abc")),
            "cell_angular": ("S1", ("cell_angular", "label"), [list("alpha"), list("beta "), list("gamma")]),
            "radius": ("f8", ("atom",), particles["radius"]),
            "mass": ("f8", ("atom",), particles["mass"]),
            "type": ("i4", ("atom",), particles["type"]),
            **{name: ("f8", _initial_axes(name, values), values) for name, values in initial.items()},
        }
        if initial:
            for name, size in zip(_OF_INITIAL, initial[INITIAL[0]].shape, strict=True):
                file.createDimension(name, size)
        for name, (kind, dimensions, _) in fixed.items():
            file.createVariable(name, kind, dimensions)  # filled, so that padding bytes are defined
        file["radius"].units = "angstrom"
        for name, (kind, dimensions, extra) in self.variables.items():
            file.createVariable(name, kind[1:], ("frame", *dimensions), fill_value=False).setncatts(extra)
        for name, (kind, _, values) in fixed.items():
            file[name][:] = np.array(values, dtype=kind)
        written = bytes(file.close())
        return written[: _frames_begin(written)]  # the library may return a larger buffer than it has used


def _initial_axes(name: str, values: np.ndarray) -> tuple[str, ...]:
    """Return the axes of a variable of `INITIAL`."""
    return ("motion",) if name == "initial_piston" else _OF_INITIAL[: values.ndim]


def _frames_begin(header: bytes) -> int:
    """Return the offset of the first variable of a frame, time, which the header contains."""
    after = b"cell_lengths"
    (begin,) = struct.unpack_from(">Q", header, header.index(struct.pack(">I", len(after)) + after) - 8)
    return int(begin)


def _value_at(header: bytes | bytearray, name: str) -> int:
    """Return the offset of the value of a numerical attribute, after name, type and number of values."""
    return header.index(name.encode()) + -(-len(name) // WORD) * WORD + 2 * WORD


def stored_header(file: BinaryIO) -> bytes:
    """Return the header that `Layout.header` made; ValueError, with the rule, if damaged or of another
    program.
    """
    file.seek(0)
    head = file.read(_HEAD)
    if not head.startswith(MAGIC):
        foreign = head.startswith((b"CDF", b"\x89HDF"))
        raise ValueError(f"is not a {'trajectory written by gaspart' if foreign else 'readable NetCDF file'}")
    if not all(name.encode() in head for name in BOOKKEEPING):
        raise ValueError("is not a trajectory written by gaspart, or its header is damaged")
    at = _value_at(head, "header_bytes")
    length = int.from_bytes(head[at : at + WORD], "big")
    size = os.fstat(file.fileno()).st_size
    if not len(head) <= length <= size:
        raise ValueError(f"is truncated or damaged: {size} bytes, where the header alone needs {length}")
    header = bytearray(head + file.read(length - len(head)))
    header[FRAME_COUNT_AT : FRAME_COUNT_AT + WORD] = bytes(WORD)
    at = _value_at(header, "header_crc32")
    checksum, header[at : at + WORD] = header[at : at + WORD], bytes(WORD)
    if struct.pack(">I", zlib.crc32(header)) != checksum:
        raise ValueError("has a damaged or edited header: its checksum does not match")
    header[at : at + WORD] = checksum
    return bytes(header)


def frame_bytes(header: bytes) -> int:
    """Return the size of a frame."""
    (size,) = struct.unpack_from(">d", header, _value_at(header, "frame_bytes"))
    return int(size)


def same_header(file: BinaryIO, header: bytes) -> bool:
    """Return True if a file has this header, except for the number of frames."""
    after = FRAME_COUNT_AT + WORD
    file.seek(0)
    stored = file.read(len(header))
    return stored[:FRAME_COUNT_AT] == header[:FRAME_COUNT_AT] and stored[after:] == header[after:]


def is_blank(file: BinaryIO) -> bool:
    """Return True if a file is empty, or its header lacks its first word, which is written last. The bytes
    after it are compared, too, because a file of zeros may belong to another program.
    """
    file.seek(0)
    start = file.read(len(_UNFINISHED) + WORD + len(_FIRST_NAME))
    return _UNFINISHED.startswith(start[: len(_UNFINISHED)]) and _FIRST_NAME.startswith(
        start[len(_UNFINISHED) + WORD :]
    )


# Frames of a trajectory file, after its header. They are appended during the run. The number of frames in the
# header is increased when a frame is complete, so that a file truncated at any moment is readable. A checksum
# (CRC-32) at the end of each frame detects damage. It depends on the header and on the position of the frame,
# too.


_CHUNK = 1 << 24  # number of bytes per read


def frame_count(file: BinaryIO) -> int:
    """Read the number of complete frames from the header of a file."""
    file.seek(FRAME_COUNT_AT)
    return struct.unpack(">I", file.read(WORD))[0]


def _frame_checksum(frame: bytes | memoryview, number: int, header_checksum: int) -> bytes:
    """Return the last word of a frame, the checksum of the bytes before it."""
    start = zlib.crc32(struct.pack(">I", number), header_checksum)
    return struct.pack(">I", zlib.crc32(frame[:-WORD], start))


def damaged_frame(file: int, header: bytes, numbers: range, checksum: int | None = None) -> int | None:
    """Return the first frame that is damaged or truncated; None if all are correct. Computing the CRC-32
    takes about as long as copying the frames in memory. `numbers`: frames to test. `checksum`: checksum of
    the header, if the caller knows it. The header is long: it has three numbers for each particle.
    """
    size, header_checksum = frame_bytes(header), zlib.crc32(header) if checksum is None else checksum
    at_once = max(1, _CHUNK // size)
    for first in range(numbers.start, numbers.stop, at_once):
        count = min(at_once, numbers.stop - first)
        data = memoryview(os.pread(file, count * size, len(header) + first * size))
        for n in range(count):
            frame = data[n * size : (n + 1) * size]
            if len(frame) < size or frame[-WORD:] != _frame_checksum(frame, first + n, header_checksum):
                return first + n
    return None


def frames_of(file: BinaryIO, header: bytes, count: int) -> Iterator[memoryview]:
    """Yield the bytes of the first `count` frames of an open file."""
    size = frame_bytes(header)
    for n in range(count):
        yield memoryview(bytearray(os.pread(file.fileno(), size, len(header) + n * size)))


class CheckedFrames:
    """Record of the undamaged frames of an open trajectory; each is checked once, before its first use."""

    def __init__(self, file: BinaryIO, header: bytes, frames: int) -> None:
        self._header, self._checksum = header, zlib.crc32(header)
        self._checked = np.zeros(frames, dtype=bool)
        self._file = os.dup(file.fileno())
        self.close = weakref.finalize(self, os.close, self._file)

    def find_damage(self, numbers: np.ndarray) -> int | None:
        """Return the index of the first damaged frame among these frames, or None. May raise OSError."""
        new = np.unique(numbers[~self._checked[numbers]])
        for part in np.split(new, np.flatnonzero(np.diff(new) > 1) + 1) if new.size else []:
            stretch = range(int(part[0]), int(part[-1]) + 1)
            frame = damaged_frame(self._file, self._header, stretch, self._checksum)
            if frame is not None:
                return frame
            self._checked[part] = True
        return None


class Frames:
    """Frames of an unbuffered open file, truncated to `kept`; 0 writes the header too. May raise OSError."""

    def __init__(self, file: BinaryIO, layout: Layout, header: bytes, kept: int = 0) -> None:
        self._file, self._frame = file, np.zeros((), layout.frame)
        self.header, self.count = header, kept
        self._header_checksum = zlib.crc32(header)
        if kept == 0:
            self._begin(header)
        else:
            self._count_frames()
        file.truncate(len(header) + kept * layout.frame.itemsize)
        file.seek(0, os.SEEK_END)

    def _begin(self, header: bytes) -> None:
        """Write the header with its first word last. If the first word is present, the header is complete."""
        self._file.truncate(0)
        self._file.seek(0)
        try:
            self._write(bytes(len(MAGIC)) + header[len(MAGIC) :])
        except OSError:
            self._file.truncate(0)
            raise
        os.pwrite(self._file.fileno(), header[: len(MAGIC)], 0)

    def append(self, values: dict[str, np.ndarray | float]) -> None:
        """Write a frame, with a value (vectors of 2 or 3 components) for every variable of the layout."""
        for name in self._frame.dtype.names[:-1]:
            array = np.asarray(values[name])
            there = self._frame[name]
            # in two dimensions, z remains 0
            components = there[..., : array.shape[-1]] if array.ndim else there
            components[...] = array
        self.append_bytes(self._frame.reshape(1).view(np.uint8).data)

    def append_bytes(self, data: memoryview) -> None:
        """Write one frame from its bytes, with the checksum for this header and position."""
        data[-WORD:] = _frame_checksum(data, self.count, self._header_checksum)
        self._write(data)
        self.count += 1
        self._count_frames()

    def _write(self, data: bytes | memoryview) -> None:
        unwritten = memoryview(data).cast("B")
        while unwritten:
            unwritten = unwritten[self._file.write(unwritten) :]

    def _count_frames(self) -> None:
        os.pwrite(self._file.fileno(), struct.pack(">I", self.count), FRAME_COUNT_AT)

    def sync(self) -> None:
        """Wait until all data are on disk."""
        os.fsync(self._file.fileno())
