"""How kernels are compiled: one policy, in one place.

IEEE arithmetic in the order written (no fastmath), so that the same source gives the same bits on every
x86-64 machine; cached on disk, under a digest of the sources, because numba does not notice when a helper
in another file changes.
"""

from __future__ import annotations

import hashlib
import os
import warnings
from pathlib import Path

import numba

_HERE = Path(__file__).parent
KERNEL_MODULES = (
    "kernel.py",
    "contact.py",
    "boxes.py",
    "insertion.py",
    "engines/calendar.py",
    "engines/event_kernels.py",
    "engines/step_kernels.py",
)


def source_digest() -> str:
    """A short digest of every module that holds compiled code."""
    digest = hashlib.sha256()
    for name in KERNEL_MODULES:
        digest.update(name.encode())
        digest.update((_HERE / name).read_bytes())
    return digest.hexdigest()[:16]


def cache_directory() -> Path:
    """Where compiled kernels are kept: $GASPART_CACHE, or the user's cache folder."""
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(os.environ.get("GASPART_CACHE") or Path(home) / "gaspart") / source_digest()


def _writable(directory: Path) -> bool:
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(directory, os.W_OK)


_CACHE = cache_directory()
_CACHING = _writable(_CACHE)
if not _CACHING:
    warnings.warn(
        f"gaspart: cannot write the kernel cache {_CACHE}; compiling anew in every process "
        "(set GASPART_CACHE to a writable folder)",
        stacklevel=2,
    )


def kernel(function):
    """Compile `function` with numba under the package's policy."""
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(_CACHE)
    try:
        return numba.njit(cache=_CACHING, nogil=True, error_model="numpy")(function)
    finally:
        numba.config.CACHE_DIR = before
