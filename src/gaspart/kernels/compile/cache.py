"""The folder in which compiled kernels are kept."""

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
    """$GASPART_CACHE, or the folder gaspart in $XDG_CACHE_HOME or ~/.cache.

    Raises RuntimeError where neither is set and the user has no home.
    """
    chosen = os.environ.get("GASPART_CACHE")
    if chosen:
        return Path(chosen)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "gaspart"


def usable_cache(version: str) -> Path | None:
    """The folder `version` of the cache, made if it is missing.

    It is a temporary one, with a warning, for a user without a cache folder that this user, and no other, can
    write to. None, also with a warning, where that cannot be written either, or $GASPART_CACHE cannot.
    """
    try:
        wanted: Path | None = cache_directory() / version
    except RuntimeError:
        wanted = None
    why = obstacle(wanted) if wanted else "there is no home for the kernel cache"
    if not why:
        return wanted
    found = None if os.environ.get("GASPART_CACHE") else _temporary(version)
    instead = f"using {found}" if found else "compiling anew in every process"
    warnings.warn(f"gaspart: {why}; {instead} ({_REMEDY})", stacklevel=3)
    return found


_reported: set[Path] = set()


def report_unwritable(directory: Path, error: OSError) -> None:
    """Warn, once in a process, that compiled kernels cannot be kept: on a full disk, for example."""
    if directory not in _reported:
        _reported.add(directory)
        why = f"cannot write the kernel cache {directory}: {error.strerror}"
        warnings.warn(f"gaspart: {why}; compiling anew in every process ({_REMEDY})", stacklevel=3)


def obstacle(directory: Path) -> str:
    """Why kernels are not to be kept in a folder, which is made if it is missing; "" if they are."""
    try:
        directory.parent.mkdir(parents=True, exist_ok=True)
        directory.mkdir(mode=0o700, exist_ok=True)
        private = _is_private(directory.stat())
    except OSError:
        private = True
    if not private:
        return f"others may write to the kernel cache {directory}"
    return "" if os.access(directory, os.W_OK) else f"cannot write the kernel cache {directory}"


def _is_private(found: os.stat_result) -> bool:
    """Whether a folder is one that only this user may write to: no other places machine code in it."""
    return stat.S_ISDIR(found.st_mode) and is_private(found)


def _temporary(version: str) -> Path | None:
    """A folder of this user in the one for temporary files, where others may have made it before."""
    try:
        own = Path(tempfile.gettempdir()) / f"gaspart-{user()}"
        own.mkdir(mode=0o700, exist_ok=True)
        private = _is_private(own.lstat())
    except OSError:
        return None
    return own / version if private and not obstacle(own / version) else None


# How numba is loaded: without what its loading wastes, which would be half of a job's start.


_LOOKED_FOR = {"coverage", "scipy.linalg.cython_blas"}
"""What numba imports where it finds it: to tell which lines kernels run, and for their matrix products."""


def load_numba(ours: bool = False) -> ModuleType:
    """numba, and all that it would load with a first kernel.

    This makes half a million objects, which stay, so the garbage collector does not look through them now.
    ours: whether this process is one of gaspart's, and no other program's. Then the collector does so neither
    later nor when the process ends, and what numba looks for and kernels of gaspart do not use is hidden from
    it.
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


# Kernels that come with the package: machine code that was compiled when its wheel was made.
#
# It is for every processor of the level x86-64-v3. A path has the digest of the sources and one of the
# release of numba, the function and the types of its arguments, and the version of Python: a file for
# anything else is not found. The list of the files has their sha256. It is as trustworthy as the package's
# modules, which stand beside it, and what does not agree with it is never read as code.


FOLDER = Path(__file__).parents[1] / "shipped"
LIST = "sha256.json"
PROCESSOR = "x86-64-v3"
FEATURES = (
    "+avx,+avx2,+bmi,+bmi2,+cx16,+f16c,+fma,+lzcnt,+movbe,+popcnt,+sahf,+sse3,+sse4.1,+sse4.2,+ssse3,+xsave"
)
"""What the level x86-64-v3 requires of a processor, in the words of LLVM."""


def shipped_key(key: tuple) -> tuple | None:
    """The key of a kernel that this package may bring, from that of one for this processor: types of
    arguments, processor, digest of the bytecode. None where the processor lacks what such a kernel uses."""
    types, (system, _, features), bytecode = key
    if not set(FEATURES.split(",")) <= set(features.split(",")):
        return None
    return types, (system, PROCESSOR, FEATURES), bytecode


def shipped_content(path: str) -> bytes | None:
    """The content of a file, by its path in the folder. None where it is not listed, is missing, or differs
    from what the list states."""
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
    """The sha256 of each file, by its path; none in a copy of the repository, which has no kernels."""
    try:
        listed = json.loads((FOLDER / LIST).read_bytes())
    except (OSError, ValueError, RecursionError):
        return {}
    return listed if isinstance(listed, dict) else {}
