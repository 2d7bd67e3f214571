"""Compile policy of all kernels.

Kernels use IEEE arithmetic in the written order (no fastmath). So the same source gives the same bits on
every x86-64 machine. They are cached on disk under a hash of the modules that they need, because numba does
not notice changes of a helper in another file.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar, cast

from gaspart.interruption import prevent_interruption
from gaspart.kernels.compile.cache import load_numba, report_unwritable, usable_cache
from gaspart.kernels.compile.sources import source_digest

numba = load_numba()
TESTED = "0.67", "0.68"
"""Releases of numba for which `files`, `parts` and `narrowing` were tested.

Another release compiles and stores kernels in its own way. The bits are the same, but it takes several times
longer.
"""
_tested = numba.__version__.startswith(tuple(f"{release}." for release in TESTED))
if _tested:
    from gaspart.kernels.compile.files import KernelCache
    from gaspart.kernels.compile.parts import KernelCompiler, PartCache, PartCompiler, narrow_calls
else:
    warnings.warn(
        f"gaspart: numba {numba.__version__} is neither {' nor '.join(TESTED)}: kernels compile more slowly",
        stacklevel=2,
    )
F = TypeVar("F", bound=Callable)

_UNWRAPPED = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
_CACHE = usable_cache("kernels" if _tested else source_digest())


def _compile(function: F, part: bool = False, **options: Any) -> F:
    """Compile a function with the options of the policy. `part`: True if only kernels call the function."""
    if part:
        options |= _UNWRAPPED
    if _tested:
        options["pipeline_class"] = PartCompiler if part else KernelCompiler
    compiled = numba.njit(nogil=True, error_model="numpy", **options)(function)
    if numba.config.DISABLE_JIT:
        return compiled
    if _CACHE:
        try:
            if _tested:
                compiled._cache = (PartCache if part else KernelCache)(_CACHE, function, options)
            else:
                _use_own_files(compiled)
        except (OSError, RuntimeError) as error:  # full disk, or a function without a file
            report_unwritable(_CACHE, OSError(0, str(error)))
    if _tested and part:
        narrow_calls(compiled)
    compiled._compiler.compile = _without_interruption(compiled._compiler.compile)
    return compiled


def _use_own_files(compiled: Any) -> None:
    """Enable numba's own cache of a function. Raises RuntimeError if numba finds no folder."""
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(_CACHE)
    try:
        compiled.enable_caching()
    finally:
        numba.config.CACHE_DIR = before


def _without_interruption(compile_: F) -> F:
    """Wrap a compile function so that signals wait until it has finished. If a signal handler raises an
    exception within a callback of LLVM, the exception is lost, and so is the code.
    """

    @wraps(compile_)
    def compile_whole(*arguments: Any) -> Any:
        with prevent_interruption():
            return compile_(*arguments)

    return cast(F, compile_whole)


def kernel(function: F) -> F:
    """Compile a function that Python calls and that creates no arrays. numba's reference counting is switched
    off. Counting the arrays that are passed between helpers would take several times as long as the
    computation. Hence the function must not create arrays.
    """
    return _compile(function, _nrt=False)


def helper(function: F) -> F:
    """Compile a small function like `kernel`, and inline it in its callers. Without this option LLVM makes a
    call, which passes every array as seven words.
    """
    return _compile(function, _nrt=False, forceinline=True)


def allocating_kernel(function: F) -> F:
    """Compile a function that Python calls and that creates arrays."""
    return _compile(function)


def inner_kernel(function: F) -> F:
    """Compile a function that only kernels call, without an entry point for Python. For a function that takes
    the arrays of an engine, this entry point would take longer to compile than the function itself.
    """
    return _compile(function, part=True, _nrt=False)


def inner_helper(function: F) -> F:
    """Compile a function that only kernels call, and inline it in its callers."""
    return _compile(function, part=True, _nrt=False, forceinline=True)


def inner_allocating_kernel(function: F) -> F:
    """Compile a function that only kernels call and that creates arrays."""
    return _compile(function, part=True)


def inner_parallel_kernel(function: F) -> F:
    """Compile a function that only kernels call, whose `prange` loops are divided among threads. The
    iterations must be independent of each other, so that their order does not matter.
    """
    return _compile(function, parallel=True, **_UNWRAPPED)
