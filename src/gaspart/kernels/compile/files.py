"""The files of compiled kernels: one for each function and types of arguments.

numba names them by the folder of the source, so that no two copies of a project share any, and lists them in
an index, which processes that compile at the same time overwrite for one another: two kernels may then be
given the same file. Here a file is named by what was compiled, and nothing else.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar

from gaspart.kernels.compile.loading import load_numba

caching: Any = load_numba().core.caching


class KernelLocator(caching.UserProvidedCacheLocator):
    """Where the files of a function are: a folder for each package, wherever that is installed."""

    @classmethod
    def get_suitable_cache_subpath(cls, py_file: str) -> str:
        """The folder for the functions of a module."""
        return Path(py_file).parent.name


class KernelFiles(caching.IndexDataCacheFile):
    """The files of one function, without an index."""

    def save(self, key: tuple, data: Any) -> None:
        """Write what was compiled for `key`."""
        self._save_data(self._name(key), data)

    def load(self, key: tuple) -> Any:
        """What was compiled for `key`, or None."""
        try:
            return self._load_data(self._name(key))
        except FileNotFoundError:
            return None

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
