"""The files of compiled kernels: one for each function and types of arguments.

numba names them by the folder of the source, so that no two copies of a project share any, and lists them in
an index, which processes that compile at the same time overwrite for one another: two kernels may then be
given the same file. Here a file is named by what was compiled, and nothing else, and begins with a checksum:
a damaged one is compiled and written again. A file that cannot be written costs time in other processes only.
"""

from __future__ import annotations

import hashlib
import pickle
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar

from gaspart.files import scratch_beside
from gaspart.kernels.compile.cache import report_unwritable
from gaspart.kernels.compile.loading import load_numba

caching: Any = load_numba().core.caching


_LENGTH = 4  # bytes of a checksum


def _checksum(content: bytes) -> bytes:
    return zlib.crc32(content).to_bytes(_LENGTH, "little")


class KernelLocator(caching.UserProvidedCacheLocator):
    """Where the files of a function are: a folder for each package, wherever that is installed."""

    @classmethod
    def get_suitable_cache_subpath(cls, py_file: str) -> str:
        """The folder for the functions of a module."""
        return Path(py_file).parent.name


class KernelFiles(caching.IndexDataCacheFile):
    """The files of one function, without an index."""

    def save(self, key: tuple, data: Any) -> None:
        """Write what was compiled for `key`, completely or not at all. May raise OSError."""
        path = Path(self._data_path(self._name(key)))
        content = self._dump(data)
        with scratch_beside(path) as scratch:
            scratch.write_bytes(_checksum(content) + content)
            scratch.replace(path)

    def load(self, key: tuple) -> Any:
        """What was compiled for `key`, or None if there is no file that is undamaged."""
        try:
            content = Path(self._data_path(self._name(key))).read_bytes()
        except OSError:
            return None
        kept, code = content[:_LENGTH], content[_LENGTH:]
        return pickle.loads(code) if code and kept == _checksum(code) else None

    def _name(self, key: tuple) -> str:
        """key: types of arguments, processor, and digest of the bytecode. The stamp holds the options."""
        compiled = repr((self._version, self._source_stamp, key))
        digest = hashlib.sha256(compiled.encode()).hexdigest()
        return str(self._data_name_pattern.replace("{number:d}", digest[:24]))


class KernelContents(caching.CompileResultCacheImpl):
    """What is in the file of a kernel: machine code."""

    _locator_classes: ClassVar = [KernelLocator]


class KernelCache(caching.FunctionCache):
    """numba's cache of a function that is compiled with these `options`, with these files."""

    _impl_class: ClassVar = KernelContents

    def __init__(self, function: Callable, options: dict[str, Any]) -> None:
        super().__init__(function)
        contents = self._impl
        stamp = contents.locator.get_source_stamp(), repr(sorted(options.items()))
        self._cache_file = KernelFiles(self.cache_path, contents.filename_base, stamp)

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep what was compiled for a signature. A warning where that fails, no error."""
        try:
            super().save_overload(sig, data)
        except OSError as error:
            report_unwritable(Path(self.cache_path).parent, error)
