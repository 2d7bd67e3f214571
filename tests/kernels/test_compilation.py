"""Which functions become machine code, and that an inner one gives the bits of a kernel of its own."""

import math

import numpy as np
from numba.core.runtime import _nrt_python, rtsys

from gaspart.kernels import compilation
from gaspart.kernels.compilation import (
    allocating_kernel,
    inner_allocating_kernel,
    inner_helper,
    inner_kernel,
    kernel,
)


def polynomial(x):
    return ((0.1 * x + 0.3) * x - 0.7) * x + math.sqrt(x)


inlined, called, alone = inner_helper(polynomial), inner_kernel(polynomial), kernel(polynomial)


@inner_kernel
def both(x):
    return inlined(x), called(x)


def outer_function(x):
    return both(x)


@inner_allocating_kernel
def powers(x, count):
    found = np.empty(count)
    for n in range(count):
        found[n] = x**n
    return found


@allocating_kernel
def total(x):
    return powers(x, 5).sum()


def machine_code(function):
    """Whether some overload of a function has been compiled to the end."""
    return any(hasattr(one.library, "_compiled_object") for one in function.overloads.values())


def test_inner_functions_give_the_same_bits_and_only_the_outermost_is_machine_code(monkeypatch):
    monkeypatch.setattr(compilation, "_CACHE", None)  # what is loaded from it compiles nothing
    outer = kernel(outer_function)
    for x in (0.1, 1.0 / 3.0, 2.0**40):
        assert outer(x) == (alone(x), alone(x))
    assert machine_code(outer)
    assert both.overloads and not machine_code(both)
    assert inlined.overloads and not machine_code(inlined)


def test_an_inner_function_may_make_arrays_and_none_is_left():
    assert total(2.0) == 31.0
    _nrt_python.memsys_enable_stats()
    before = rtsys.get_allocation_stats()
    for _ in range(100):
        total(2.0)
    after = rtsys.get_allocation_stats()
    assert after.alloc - before.alloc == after.free - before.free
