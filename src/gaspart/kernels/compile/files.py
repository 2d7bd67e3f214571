"""Files of compiled kernels: one file per function and types of arguments.

numba names its files by the folder of the source and lists them in an index. Therefore two copies of a
project never share a file. Processes that compile at the same time overwrite this index, so that two kernels
may get the same file name. Here the name of a file depends only on what was compiled. The file begins with a
checksum; a damaged file is compiled and written again. If a file cannot be written, other processes only lose
time. If this user has not compiled a kernel, it may have been shipped with the package (`shipped_content`).
"""

from __future__ import annotations

import hashlib
import inspect
import os
import pickle
import sys
import zlib
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any, ClassVar

from gaspart.files import scratch_beside
from gaspart.kernels.compile.cache import load_numba, report_unwritable, shipped_content, shipped_key
from gaspart.kernels.compile.sources import KERNELS, closure_digests
from gaspart.system import is_own

caching: Any = load_numba().core.caching


_LENGTH = 4  # length of a checksum in bytes


def _checksum(content: bytes) -> bytes:
    return zlib.crc32(content).to_bytes(_LENGTH, "little")


def _code(content: bytes | None) -> bytes | None:
    """Return the content after the checksum, or None if the checksum is wrong."""
    if content is None or len(content) <= _LENGTH:
        return None
    kept, code = content[:_LENGTH], content[_LENGTH:]
    return code if kept == _checksum(code) else None


def _own_content(path: str) -> bytes | None:
    """Read a file of this user; None for any other, because its code would run with this user's rights."""
    try:
        with open(path, "rb") as file:
            return file.read() if is_own(os.fstat(file.fileno())) else None
    except OSError:
        return None


class KernelLocator(caching.UserProvidedCacheLocator):
    """Locator of the folder of a function's files, shared by all copies of the package. For functions of
    `kernels` the hash of the modules that their module needs suffices. numba uses the hash of the file, the
    line number and the bytecode, which change with comments and docstrings.
    """

    def __init__(self, folder: Path, function: Callable) -> None:
        self._py_file = inspect.getfile(function)
        self._lineno = function.__code__.co_firstlineno
        self._cache_path = str(folder / Path(self._py_file).parent.name)
        self.digested = Path(self._py_file).is_relative_to(KERNELS)
        if not os.path.exists(self._py_file):
            raise OSError(0, f"{function.__qualname__} is not from a file")
        _make_folder(self._cache_path)

    def get_source_stamp(self) -> Any:
        """Return the hash of what the function was compiled from."""
        if self.digested:
            return closure_digests()[self._py_file]
        return super().get_source_stamp()

    def get_disambiguator(self) -> str:
        """Return the suffix that distinguishes functions of one name in a file; "" for `kernels`."""
        return "" if self.digested else super().get_disambiguator()


@cache
def _make_folder(path: str) -> None:
    """Create a folder if it is missing. May raise OSError."""
    os.makedirs(path, exist_ok=True)


class KernelFiles(caching.IndexDataCacheFile):
    """Files of one function, without an index."""

    def __init__(self, folder: str, name: str, stamp: Any, suffix: str) -> None:
        super().__init__(folder, name, stamp)
        self._data_name_pattern = f"{name}.{{digest}}.{suffix}"

    def save(self, key: tuple, data: Any) -> None:
        """Write the compiled code for `key` atomically. May raise OSError."""
        path = Path(self._data_path(self._name(key)))
        content = self._dump(data)
        with scratch_beside(path) as scratch:
            scratch.write_bytes(_checksum(content) + content)
            scratch.replace(path)

    def load(self, key: tuple) -> Any:
        """Return the compiled code for `key`, of this user rather than of the package; None without a
        complete file.
        """
        code = _code(_own_content(self._data_path(self._name(key))))
        if code is None:
            code = _code(self._read_shipped(key))
        return None if code is None else pickle.loads(code)

    def _read_shipped(self, key: tuple) -> bytes | None:
        """Return the content of the file that was shipped with the package, in folders of the same names."""
        for_many = shipped_key(key)
        if for_many is None:
            return None
        folder = Path(self._cache_path)
        return shipped_content(f"{folder.parent.name}/{folder.name}/{self._name(for_many)}")

    def _name(self, key: tuple) -> str:
        """Return the name of the file for a key: types of arguments, processor, bytecode; options are in the
        stamp.
        """
        compiled = repr((self._version, self._source_stamp, key))
        digest = hashlib.sha256(compiled.encode()).hexdigest()
        return str(self._data_name_pattern.format(digest=digest[:24]))


class KernelContents(caching.CompileResultCacheImpl):
    """Content of the file of a kernel: its machine code."""

    suffix = "nbc"

    def __init__(self, folder: Path, function: Callable) -> None:
        self._lineno = function.__code__.co_firstlineno
        self._locator = KernelLocator(folder, function)
        name = f"{Path(inspect.getfile(function)).stem}.{function.__qualname__}"
        self._filename_base = self.get_filename_base(name, getattr(sys, "abiflags", ""))


class KernelCache(caching.FunctionCache):
    """Cache of a function with given options, instead of numba's own; the constructor may raise OSError."""

    contents: ClassVar = KernelContents

    def __init__(self, folder: Path, function: Callable, options: dict[str, Any]) -> None:
        self._impl_class = partial(self.contents, folder)
        super().__init__(function)
        stamp = self._impl.locator.get_source_stamp(), repr(sorted(options.items()))
        self._cache_file = KernelFiles(self.cache_path, self._impl.filename_base, stamp, self._impl.suffix)

    def _index_key(self, sig: Any, codegen: Any) -> tuple:
        types, system, (code, variables) = super()._index_key(sig, codegen)
        return types, system, ("" if self._impl.locator.digested else code, variables)

    def save_overload(self, sig: Any, data: Any) -> None:
        """Store the compiled code for a signature; a failure causes only a warning."""
        try:
            super().save_overload(sig, data)
        except OSError as error:
            report_unwritable(Path(self.cache_path).parent, error)
