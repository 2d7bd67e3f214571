"""How kernels are compiled: one policy, in one place.

IEEE arithmetic in the order written (no fastmath), so that the same source gives the same bits on every
x86-64 machine; cached on disk, under a digest of the sources, because numba does not notice when a helper
in another file changes.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from gaspart.cache import usable_cache
from gaspart.loading import load_numba

numba = load_numba()
F = TypeVar("F", bound=Callable)
_HERE = Path(__file__).parent
KERNEL_MODULES = (
    "kernel.py",
    "contact.py",
    "draws.py",
    "falling.py",
    "coordinates.py",
    "fetch.py",
    "plates.py",
    "segments.py",
    "insertion.py",
    "engines/calendar.py",
    "engines/layout.py",
    "engines/running_sum.py",
    "engines/flight.py",
    "engines/resting.py",
    "engines/eight.py",
    "engines/search.py",
    "engines/ahead.py",
    "engines/lists.py",
    "engines/big.py",
    "engines/impact.py",
    "engines/faces.py",
    "engines/plates.py",
    "engines/surfaces.py",
    "engines/walls.py",
    "engines/event_kernels.py",
    "engines/growth.py",
    "engines/all_pairs.py",
    "engines/step_layout.py",
    "engines/step_rules.py",
    "engines/step_motion.py",
    "engines/step_contacts.py",
    "engines/step_boxes.py",
    "engines/step_eight.py",
    "engines/step_cells.py",
    "engines/step_list.py",
    "engines/step_threads.py",
    "engines/step_kernels.py",
)


def source_digest() -> str:
    """A short digest of every module that holds compiled code."""
    digest = hashlib.sha256()
    for name in KERNEL_MODULES:
        digest.update(name.encode())
        digest.update((_HERE / name).read_bytes())
    return digest.hexdigest()[:16]


_CACHE = usable_cache(source_digest())


def _compile(function: F, **options: Any) -> F:
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(_CACHE or before)
    try:
        return numba.njit(cache=_CACHE is not None, nogil=True, error_model="numpy", **options)(function)
    finally:
        numba.config.CACHE_DIR = before


def kernel(function: F) -> F:
    """Compile `function` with numba under the package's policy. It must not make arrays.

    Without numba's reference counting, that is: counting the arrays that pass between helpers costs several
    times what the helpers compute.
    """
    return _compile(function, _nrt=False)


def helper(function: F) -> F:
    """The same for a small function that is inlined where it is used: LLVM by itself leaves a call, which
    passes every array as seven words."""
    return _compile(function, _nrt=False, forceinline=True)


def inner_kernel(function: F) -> F:
    """A kernel that only kernels call: without the way in from Python, which for a function that takes an
    engine's arrays takes longer to compile than what it does."""
    return _compile(function, _nrt=False, no_cpython_wrapper=True, no_cfunc_wrapper=True)


def inner_helper(function: F) -> F:
    """The same for a function that is inlined."""
    return _compile(function, _nrt=False, forceinline=True, no_cpython_wrapper=True, no_cfunc_wrapper=True)


def allocating_kernel(function: F) -> F:
    """The same for a function that makes arrays."""
    return _compile(function)


def parallel_kernel(function: F) -> F:
    """The same for a function whose `prange` loops are shared among threads. What its parts write must not
    depend on one another, so that it does not matter which is done when."""
    return _compile(function, parallel=True)
