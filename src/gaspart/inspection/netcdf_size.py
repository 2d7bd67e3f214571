"""The size of a netCDF-3 file by its header: of a shorter file, the library reads zeros without a word.

The format: https://docs.unidata.ucar.edu/netcdf-c/current/file_format_specifications.html
"""

from __future__ import annotations

import math
from typing import BinaryIO

_WIDTHS = {1: 1, 2: 1, 3: 2, 4: 4, 5: 4, 6: 8, 7: 1, 8: 2, 9: 4, 10: 8, 11: 8}
"""Bytes of a value of each type, by the number of the type."""
_OFFSETS = {1: 4, 2: 8, 5: 8}
"""Bytes of an offset, by the version of the format; of a count 8 in version 5, else 4."""


class _Header:
    """The numbers and names of a header, in their order. Raises ValueError at its end."""

    def __init__(self, file: BinaryIO, version: int) -> None:
        self._file, self._offset, self._count = file, _OFFSETS[version], 8 if version == 5 else 4

    def _bytes(self, length: int) -> bytes:
        content = self._file.read(length)
        if len(content) < length:
            raise ValueError("the file ends within its header")
        return content

    def count(self) -> int:
        """A number of things."""
        return int.from_bytes(self._bytes(self._count), "big")

    def offset(self) -> int:
        """A place in the file."""
        return int.from_bytes(self._bytes(self._offset), "big")

    def word(self) -> int:
        """A tag or a type."""
        return int.from_bytes(self._bytes(4), "big")

    def items(self) -> int:
        """The number of items of a list, after its tag."""
        self.word()
        return self.count()

    def skip(self, length: int) -> None:
        """Pass over values, which are padded to words."""
        self._file.seek(_padded(length), 1)

    def skip_attributes(self) -> None:
        """Pass over a list of attributes."""
        for _ in range(self.items()):
            self.skip(self.count())
            width = _WIDTHS.get(self.word(), 0)
            self.skip(width * self.count())


def _padded(length: int) -> int:
    return -(-length // 4) * 4


def needed_bytes(file: BinaryIO) -> int | None:
    """The least size of a netCDF-3 file; None for other formats. Raises ValueError for a damaged header."""
    file.seek(0)
    magic = file.read(4)
    if magic[:3] != b"CDF" or magic[3] not in _OFFSETS:
        return None
    try:
        return _size(_Header(file, magic[3]))
    except (IndexError, OverflowError, OSError):  # numbers that lead nowhere
        raise ValueError("damaged header") from None


def _size(header: _Header) -> int | None:
    """The end of the last value of any variable."""
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
        header.count()  # its size, which has 32 bits only
        begin = header.offset()
        if shape[:1] == [0]:
            of_records.append((begin, width * math.prod(shape[1:])))
        else:
            fixed.append(begin + width * math.prod(shape))
    if not of_records or records == 0:
        return max(fixed)
    if records in (2**32 - 1, 2**64 - 1):
        return None  # being written: the library derives the number from the size
    step = sum(_padded(size) for _, size in of_records) if len(of_records) > 1 else of_records[0][1]
    return max(*fixed, *(begin + (records - 1) * step + size for begin, size in of_records))
