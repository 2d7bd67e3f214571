"""The trajectory's file format: AMBER NetCDF, https://ambermd.org/netcdf/nctraj.xhtml, version 1.0.

A netCDF-3 file is a header and then frames of equal size. The netCDF library makes the header; frames are
appended to it as they come, and the number of frames in the header is raised when a frame is complete, so
that a file cut short at any moment is a readable one.
"""

from __future__ import annotations

import os
import struct
from dataclasses import fields
from typing import BinaryIO

import numpy as np

from gaspart.state.tally import Tally

NOTE = (
    "Reduced units: lengths and times are in the scene's own units, masses relative to the reference "
    "species, k_B = 1. Picosecond and angstrom stand for these, because readers of AMBER files insist on it."
)
COUNTERS = tuple(field.name for field in fields(Tally) if field.name != "time")
"""Sums since time 0, one variable each."""

_PER_FACE = tuple(field.name for field in fields(Tally) if field.type == "np.ndarray")
_MAGIC = b"CDF\x02"  # a netCDF-3 file of 64-bit offsets
_FRAME_COUNT_AT = 4  # where a netCDF-3 header keeps the number of frames, as a big-endian uint32
_INT = 4  # the netCDF library's number for this type
MOST_FRAMES = 2**31 - 1


def face_names(dimension: int, walls: int = 0) -> list[str]:
    """(2d + walls,) what faces and interior walls are called, in the order of the counters."""
    faces = [f"{axis} {end}" for axis in "xyz"[:dimension] for end in ("low", "high")]
    return faces + [f"wall {n}" for n in range(walls)]


class Layout:
    """The variables of one frame, in their order in the file: name -> (type, dimensions, attributes).

    count: bodies in the file; displacements, spins, vibrations: whether these are there; walls: interior
    ones.
    """

    def __init__(
        self,
        count: int,
        dimension: int,
        displacements: bool,
        walls: int = 0,
        spins: bool = False,
        vibrations: bool = False,
    ) -> None:
        self.sizes = {
            "spatial": 3,
            "atom": count,
            "cell_spatial": 3,
            "cell_angular": 3,
            "label": 5,
            "face": 2 * dimension + walls,
        }
        vectors = ("atom", "spatial")
        faces = {"faces": ", ".join(face_names(dimension, walls))}
        self.variables = {
            "time": (">f8", (), {"units": "picosecond"}),
            "cell_lengths": (">f8", ("cell_spatial",), {"units": "angstrom"}),
            "cell_angles": (">f8", ("cell_angular",), {"units": "degree"}),
            "kinetic_energy": (">f8", (), {"long_name": "kinetic energy of all bodies"}),
            **{
                name: (">f8", ("face",) if name in _PER_FACE else (), faces if name in _PER_FACE else {})
                for name in COUNTERS
            },
            "coordinates": (">f4", vectors, {"units": "angstrom"}),
            "velocities": (">f4", vectors, {"units": "angstrom/picosecond"}),
        }
        if spins:
            meaning = "angular velocity, in two dimensions along z"
            self.variables["spins"] = (">f4", vectors, {"units": "1/picosecond", "long_name": meaning})
        if vibrations:
            self.variables["vibrations"] = (">f4", ("atom",), {"long_name": "energy of a body's vibration"})
        if displacements:
            meaning = "way since time 0, unwrapped"
            self.variables["displacements"] = (">f8", vectors, {"units": "angstrom", "long_name": meaning})

    def shape(self, name: str) -> tuple[int, ...]:
        """The shape of a variable in one frame."""
        return tuple(self.sizes[dimension] for dimension in self.variables[name][1])

    @property
    def frame(self) -> np.dtype:
        """One frame as it is in the file; every variable fills whole words, so there is no padding."""
        return np.dtype([(name, kind, self.shape(name)) for name, (kind, _, _) in self.variables.items()])

    def header(self, attributes: dict, radii: np.ndarray, types: np.ndarray) -> bytes:
        """A file of no frames. Its attributes also tell the bytes of the header and of a frame."""
        sizes = {"header_bytes": np.int32(0), "frame_bytes": np.float64(self.frame.itemsize)}
        header = self._header({**attributes, **sizes}, radii, types)
        told = b"header_bytes" + struct.pack(">II", _INT, 1)  # name, type, and how many of these follow
        before, _, after = header.partition(told)
        return before + told + struct.pack(">I", len(header)) + after[4:]

    def _header(self, attributes: dict, radii: np.ndarray, types: np.ndarray) -> bytes:
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
            "radius": ("f8", ("atom",), radii),
            "type": ("i4", ("atom",), types),
        }
        for name, (kind, dimensions, _) in fixed.items():
            file.createVariable(name, kind, dimensions)  # filled, lest the padding be what memory held
        file["radius"].units = "angstrom"
        for name, (kind, dimensions, extra) in self.variables.items():
            file.createVariable(name, kind[1:], ("frame", *dimensions), fill_value=False).setncatts(extra)
        for name, (kind, _, values) in fixed.items():
            file[name][:] = np.array(values, dtype=kind)
        return bytes(file.close())


def same_header(file: BinaryIO, header: bytes) -> bool:
    """Whether a file begins with this header, however many frames it counts."""
    after = _FRAME_COUNT_AT + 4
    file.seek(0)
    found = file.read(len(header))
    return found[:_FRAME_COUNT_AT] == header[:_FRAME_COUNT_AT] and found[after:] == header[after:]


def is_blank(file: BinaryIO) -> bool:
    """Whether a file is empty, or its header was never finished."""
    file.seek(0)
    return not any(file.read(len(_MAGIC)))


def frame_count(file: BinaryIO) -> int:
    """The number of complete frames that a file's header tells of."""
    file.seek(_FRAME_COUNT_AT)
    return struct.unpack(">I", file.read(4))[0]


class Frames:
    """The frames of an unbuffered open file, of which the first `kept` stay and the others are cut off.

    With `kept` = 0 the header is written too. Every method may raise OSError.
    """

    def __init__(self, file: BinaryIO, layout: Layout, header: bytes, kept: int = 0) -> None:
        self._file, self._frame = file, np.zeros((), layout.frame)
        self.count = kept
        if kept == 0:
            self._begin(header)
        else:
            self._count_frames()
        file.truncate(len(header) + kept * layout.frame.itemsize)
        file.seek(0, os.SEEK_END)

    def _begin(self, header: bytes) -> None:
        """Write the header, its first word last: where that stands, the header is whole."""
        self._file.truncate(0)
        self._file.seek(0)
        try:
            self._write(bytes(len(_MAGIC)) + header[len(_MAGIC) :])
        except OSError:
            self._file.truncate(0)
            raise
        os.pwrite(self._file.fileno(), header[: len(_MAGIC)], 0)

    def append(self, values: dict[str, np.ndarray | float]) -> None:
        """Write one frame: a value for every variable of the layout, vectors of 2 or 3 components."""
        for name in self._frame.dtype.fields:
            given = np.asarray(values[name])
            there = self._frame[name]
            components = there[..., : given.shape[-1]] if given.ndim else there  # 2D leaves z = 0
            components[...] = given
        self._write(self._frame.reshape(1).view(np.uint8).data)
        self.count += 1
        self._count_frames()

    def _write(self, data: bytes | memoryview) -> None:
        left = memoryview(data).cast("B")
        while left:
            left = left[self._file.write(left) :]

    def _count_frames(self) -> None:
        os.pwrite(self._file.fileno(), struct.pack(">I", self.count), _FRAME_COUNT_AT)

    def sync(self) -> None:
        """Return when all is on the disk."""
        os.fsync(self._file.fileno())
