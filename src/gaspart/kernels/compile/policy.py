"""How kernels are compiled: one policy, in one place.

IEEE arithmetic in the order written (no fastmath), so that the same source gives the same bits on every
x86-64 machine; cached on disk, under a digest of the sources, because numba does not notice when a helper
in another file changes.
"""

from __future__ import annotations

import hashlib
import warnings
from collections.abc import Callable
from functools import cache, wraps
from pathlib import Path
from typing import Any, TypeVar, cast

from gaspart.interruption import uninterrupted
from gaspart.kernels.compile.cache import load_numba, report_unwritable, usable_cache
from gaspart.kernels.compile.sources import file_digests

numba = load_numba()
TESTED = "0.67", "0.68"
"""Releases of numba whose internals `files`, `parts` and `narrowing` use. Another one compiles and keeps
kernels in its own way, to the same bits and in several times as long."""
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
_KERNELS = Path(__file__).parents[1]


@cache
def source_digest() -> str:
    """Return a short digest of every module of `kernels`, which hold all compiled code and nothing else.

    Docstrings and comments do not change it.
    """
    paths = sorted(_KERNELS.rglob("*.py"))
    digest = hashlib.sha256()
    for path, content in zip(paths, file_digests(paths), strict=True):
        digest.update(path.relative_to(_KERNELS).as_posix().encode())
        digest.update(content.encode())
    return digest.hexdigest()[:16]


_UNWRAPPED = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
_CACHE = usable_cache(source_digest())


def _compile(function: F, part: bool = False, **options: Any) -> F:
    """part: whether only kernels call the function."""
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
        except (OSError, RuntimeError) as error:  # as on a full disk; or the function is not from a file
            report_unwritable(_CACHE, OSError(0, str(error)))
    if _tested and part:
        narrow_calls(compiled)
    compiled._compiler.compile = _without_interruption(compiled._compiler.compile)
    return compiled


def _use_own_files(compiled: Any) -> None:
    """Enable numba's own cache of a function. Raises RuntimeError if it finds no folder."""
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(_CACHE)
    try:
        compiled.enable_caching()
    finally:
        numba.config.CACHE_DIR = before


def _without_interruption(compile_: F) -> F:
    """The same, with signals waiting until it has ended: what a handler raises within a callback of LLVM is
    lost, and with it the code."""

    @wraps(compile_)
    def compile_whole(*arguments: Any) -> Any:
        with uninterrupted():
            return compile_(*arguments)

    return cast(F, compile_whole)


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


def allocating_kernel(function: F) -> F:
    """The same for a function that makes arrays."""
    return _compile(function)


def inner_kernel(function: F) -> F:
    """A kernel that only kernels call: without the way in from Python, which for a function that takes an
    engine's arrays takes longer to compile than what it does."""
    return _compile(function, part=True, _nrt=False)


def inner_helper(function: F) -> F:
    """The same for a function that is inlined."""
    return _compile(function, part=True, _nrt=False, forceinline=True)


def inner_allocating_kernel(function: F) -> F:
    """The same for a function that makes arrays."""
    return _compile(function, part=True)


def inner_parallel_kernel(function: F) -> F:
    """The same for a function whose `prange` loops are shared among threads. What its parts write must not
    depend on one another, so that it does not matter which is done when."""
    return _compile(function, parallel=True, **_UNWRAPPED)
