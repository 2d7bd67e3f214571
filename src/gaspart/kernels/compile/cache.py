"""Cache folder of compiled kernels."""

from __future__ import annotations

import gc
import hashlib
import json
import os
import stat
import sys
import tempfile
import warnings
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

from gaspart.system import is_private, user

_REMEDY = "set GASPART_CACHE to a writable folder"


def cache_directory() -> Path:
    """Return $GASPART_CACHE, or gaspart in $XDG_CACHE_HOME or ~/.cache; RuntimeError without a home
    folder.
    """
    chosen = os.environ.get("GASPART_CACHE")
    if chosen:
        return Path(chosen)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "gaspart"


def usable_cache(version: str) -> Path | None:
    """Return the folder `version` of the cache, and create it if necessary. A cache folder must be writable
    by this user and by no other user. Otherwise a temporary folder is used, with a warning. Returns None,
    with a warning, if the temporary folder cannot be written either, or if $GASPART_CACHE cannot be written.
    """
    try:
        directory: Path | None = cache_directory() / version
    except RuntimeError:
        directory = None
    problem = obstacle(directory) if directory else "there is no home for the kernel cache"
    if not problem:
        return directory
    fallback = None if os.environ.get("GASPART_CACHE") else _temporary(version)
    instead = f"using {fallback}" if fallback else "compiling anew in every process"
    warnings.warn(f"gaspart: {problem}; {instead} ({_REMEDY})", stacklevel=3)
    return fallback


_reported: set[Path] = set()


def report_unwritable(directory: Path, error: OSError) -> None:
    """Warn once per process that compiled kernels cannot be stored, for example on a full disk."""
    if directory not in _reported:
        _reported.add(directory)
        problem = f"cannot write the kernel cache {directory}: {error.strerror}"
        warnings.warn(f"gaspart: {problem}; compiling anew in every process ({_REMEDY})", stacklevel=3)


def obstacle(directory: Path) -> str:
    """Return the reason why a folder, made if missing, cannot store kernels, or "" if it can."""
    try:
        directory.parent.mkdir(parents=True, exist_ok=True)
        directory.mkdir(mode=0o700, exist_ok=True)
        private = _is_private(directory.stat())
    except OSError:
        private = True
    if not private:
        return f"others may write to the kernel cache {directory}"
    return "" if os.access(directory, os.W_OK) else f"cannot write the kernel cache {directory}"


def _is_private(status: os.stat_result) -> bool:
    """Return True if only this user can write to a folder, so that nobody else can place machine
    code in it.
    """
    return stat.S_ISDIR(status.st_mode) and is_private(status)


def _temporary(version: str) -> Path | None:
    """Return a folder of this user in the folder for temporary files, or None. Another user may have created
    a folder with this name before; such a folder is not used.
    """
    try:
        own = Path(tempfile.gettempdir()) / f"gaspart-{user()}"
        own.mkdir(mode=0o700, exist_ok=True)
        private = _is_private(own.lstat())
    except OSError:
        return None
    return own / version if private and not obstacle(own / version) else None


# numba is loaded without unnecessary work, which would take half of the start-up time of a job.


_LOOKED_FOR = {"coverage", "scipy.linalg.cython_blas"}
"""Optional imports of numba: for reporting which lines of kernels run, and for matrix products in kernels."""


def load_numba(ours: bool = False) -> ModuleType:
    """Import numba and all modules that it would load with the first kernel. This creates half a million
    objects that stay in memory, so the garbage collector is switched off during the import. `ours`: True if
    the process belongs to gaspart and to no other program. Then the collector ignores these objects also
    later and at the end of the process, and optional imports of numba that kernels of gaspart do not use are
    hidden from it.
    """
    if "numba.np.arraymath" in sys.modules:
        return import_module("numba")
    collecting = gc.isenabled()
    gc.disable()
    hidden: dict[str, Any] = dict.fromkeys(_LOOKED_FOR - set(sys.modules)) if ours else {}
    sys.modules.update(hidden)
    try:
        numba = import_module("numba")
        import_module("numba.core.registry").cpu_target.target_context.refresh()
    finally:
        for name in hidden:
            del sys.modules[name]
        if ours:
            gc.freeze()
        if collecting:
            gc.enable()
    return numba


# Kernels that are shipped with the package: machine code that was compiled when the wheel was built.
#
# The code runs on every processor of the level x86-64-v3. The name of a file contains the function, the
# Python version, and a hash of the sources, the numba release and the types of its arguments. So a file for a
# different combination is never found. The list of the files contains their sha256. A file is as trustworthy
# as the modules of the package, because both are installed in the same place. A file that differs from the
# list is not executed.


FOLDER = Path(__file__).parents[1] / "shipped"
LIST = "sha256.json"
PROCESSOR = "x86-64-v3"
FEATURES = (
    "+avx,+avx2,+bmi,+bmi2,+cx16,+f16c,+fma,+lzcnt,+movbe,+popcnt,+sahf,+sse3,+sse4.1,+sse4.2,+ssse3,+xsave"
)
"""Processor features required by the level x86-64-v3, by their LLVM names."""


def shipped_key(key: tuple) -> tuple | None:
    """Convert the key of a kernel on this processor to the key of a shipped kernel. A key contains the types
    of the arguments, the processor and the hash of the bytecode. Returns None if the processor lacks a
    feature that shipped kernels use.
    """
    types, (system, _, features), bytecode = key
    if not set(FEATURES.split(",")) <= set(features.split(",")):
        return None
    return types, (system, PROCESSOR, FEATURES), bytecode


def shipped_content(path: str) -> bytes | None:
    """Return a shipped file's content; None if it is not in the list, missing, or different from its hash."""
    expected = _digests().get(path)
    if expected is None:
        return None
    try:
        content = (FOLDER / path).read_bytes()
    except OSError:
        return None
    return content if hashlib.sha256(content).hexdigest() == expected else None


@cache
def _digests() -> dict[str, str]:
    """Return the sha256 of each shipped file by its path; empty in a copy of the repository."""
    try:
        listed = json.loads((FOLDER / LIST).read_bytes())
    except (OSError, ValueError, RecursionError):
        return {}
    return listed if isinstance(listed, dict) else {}
