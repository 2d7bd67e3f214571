"""Compilation of kernels for this processor, which replace the kernels in the package.

The kernels of a wheel run on every processor of the level x86-64-v3. On a processor with AVX-512, kernels
compiled for this processor are faster, and their results are bitwise identical. Such kernels are compiled at
the end of a long run, if they would save more time in a run of the same length than the compilation costs.
They are stored in the user's kernel cache, which has precedence over the kernels of the package. The next
process therefore uses them.
"""

from __future__ import annotations

import hashlib
import os
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

from gaspart.kernels.compile import cache
from gaspart.kernels.compile.sources import source_digest
from gaspart.workers import in_processes

Kernel = tuple[str, str, tuple]
"""Module and name of a kernel, and types of its arguments."""

GAIN = 1.2
"""Ratio of the speeds of the event-driven engine with native kernels and with kernels of the wheel.

The ratio was measured on a processor with AVX-512, for 1000 spheres at a packing fraction of 0.2.
"""
COMPILATION = 20.0
"""CPU time of compiling the kernels of a run, in seconds."""
_STORED = "native"  # folder in the cache with an empty file for each compiled set of kernels


def pays(seconds: float, features: dict[str, bool]) -> bool:
    """Return True if native kernels save more than they cost after a run of `seconds` of CPU time."""
    return features.get("avx512f", False) and seconds * (1.0 - 1.0 / GAIN) > COMPILATION


def replace_shipped_kernels(seconds: float) -> bool:
    """Compile the kernels of this process for this processor, if this saves time. Returns True if native
    kernels were stored. Nothing is compiled in three further cases: no kernels of the package are in use; the
    settings of numba name a processor; or another process is compiling the same kernels.
    """
    if not (cache.FOLDER / cache.LIST).exists() or not pays(seconds, _features()):
        return False
    kernels = loaded_kernels()
    stamp = _stamp(kernels)
    if stamp is None:
        return False
    try:
        stamp.parent.mkdir(exist_ok=True)
        stamp.touch(exist_ok=False)
    except OSError:  # the kernels are stored already, or the cache is not writable
        return False
    results: list[Any] = []
    try:
        in_processes(compile_kernels, [(kernels,)], 1, lambda _, result: results.append(result))
    finally:
        is_stored = results == [len(kernels)]
        if not is_stored:
            stamp.unlink(missing_ok=True)
    return is_stored


def _features() -> dict[str, bool]:
    """Return the features of this processor; {} if the settings of numba name a processor."""
    config = cache.load_numba().config
    if config.CPU_NAME is not None or config.CPU_FEATURES is not None:
        return {}
    return dict(import_module("llvmlite.binding").get_host_cpu_features())


def loaded_kernels() -> list[Kernel]:
    """Return the kernels that this process loaded from the cache or the package."""
    kernels = {
        (function.__module__, function.__name__, types)
        for function in _dispatchers()
        for types in function.signatures
        if function.stats.cache_hits.get(types)
    }
    return sorted(kernels, key=str)


def _dispatchers() -> list[Any]:
    """Return all compiled functions in modules of `kernels` that this process imported."""
    modules = [module for name, module in list(sys.modules.items()) if name.startswith("gaspart.kernels.")]
    return [
        value
        for module in modules
        for value in list(vars(module).values())
        if hasattr(value, "signatures") and hasattr(value, "stats")
    ]


def _stamp(kernels: list[Kernel]) -> Path | None:
    """Return the path of the file that marks native kernels as stored; None without a cache."""
    folders = (function.stats.cache_path for function in _dispatchers())
    folder = next(filter(None, folders), None)
    if folder is None or not kernels:
        return None
    compiled = f"{source_digest()} {kernels}"
    return Path(folder).parent / _STORED / hashlib.sha256(compiled.encode()).hexdigest()[:24]


def compile_kernels(send: Callable[[Any], None], kernels: list[Kernel]) -> int:
    """Compile kernels that the cache lacks, in a process of its own, for this processor; return
    their number.
    """
    cache.FOLDER = Path(os.devnull)  # this process must not load kernels of the package
    for module, name, types in kernels:
        getattr(import_module(module), name).compile(types)
    return len(kernels)
