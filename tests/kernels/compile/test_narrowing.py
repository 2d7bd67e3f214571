"""For what of a named tuple a function is compiled that only kernels call."""

from typing import NamedTuple

import numba
import numpy as np
import pytest

from gaspart.kernels.compile.narrowing import Narrowed, narrow_types
from gaspart.kernels.compile.policy import inner_helper, inner_kernel, kernel

NONE, VECTOR = numba.types.none, numba.typeof(np.zeros(2))


class Inner(NamedTuple):
    used: np.ndarray
    other: float


class Outer(NamedTuple):
    inner: Inner | None
    rest: np.ndarray | None
    more: np.ndarray | None


def inner(used=VECTOR, other=numba.float64):
    return numba.types.NamedTuple((used, other), Inner)


def outer(inner=None, rest=VECTOR, more=VECTOR):
    return numba.types.NamedTuple((inner or INNER, rest, more), Outer)


INNER = inner()


def whole(given):
    """The type for a function that uses a tuple in another way than by its entries."""
    return Narrowed(list(given.types), given.instance_class)


def by_entries(given):
    """The type for a function that uses these entries."""
    if not isinstance(given, numba.types.NamedTuple):
        return given
    return Narrowed([by_entries(kind) for kind in given.types], given.instance_class)


@inner_helper
def entry(outer):
    return outer.inner.used[0]


@inner_helper
def if_there(outer, inner, rest):
    found = 0.0
    if inner is not None:
        found += inner.used[1]
    if rest is None:
        return found
    return found + outer.more[0]


@inner_kernel
def hands_on(outer):
    return entry(outer) + if_there(outer, outer.inner, outer.rest)


@inner_kernel
def hands_on_by_name(outer):
    return entry(outer=outer)


@inner_kernel
def renames(outer):
    same = outer
    return same.inner.used[0]


@inner_kernel
def asks(outer):
    return 1.0 if outer.rest is None else 2.0


@kernel
def called_by_python(outer):
    return hands_on(outer), hands_on_by_name(outer), renames(outer), asks(outer)


@pytest.mark.parametrize(
    ("function", "given", "kept"),
    [
        (entry, outer(), by_entries(outer(inner(other=NONE), NONE, NONE))),
        (hands_on, outer(), by_entries(outer(inner(other=NONE)))),
        (hands_on, outer(rest=NONE), by_entries(outer(inner(other=NONE), NONE, NONE))),
        (hands_on_by_name, outer(), whole(outer())),
        (renames, outer(), whole(outer())),
        (asks, outer(), by_entries(outer(NONE, VECTOR, NONE))),
        (asks, outer(rest=NONE), by_entries(outer(NONE, NONE, NONE))),
    ],
    ids=lambda value: getattr(value, "__name__", ""),
)
def test_a_function_is_compiled_for_the_entries_that_it_uses(function, given, kept):
    """Itself, or what it hands them to, but not in a branch that is left out; else for all."""
    assert narrow_types(function.py_func, (given,)) == (kept,)


def test_what_is_absent_stays_absent_and_functions_of_no_module_get_all():
    nothing = outer(NONE, NONE, NONE)
    assert narrow_types(if_there.py_func, (nothing, NONE, NONE)) == (by_entries(nothing), NONE, NONE)
    assert narrow_types(lambda outer: outer.rest[0], (outer(),)) == (whole(outer()),)


def test_a_call_passes_these_entries_with_their_values():
    given = Outer(Inner(np.array([2.0, 5.0]), 0.0), np.array([7.0]), np.array([11.0]))
    assert called_by_python(given) == (2.0 + 5.0 + 11.0, 2.0, 2.0, 2.0)
    assert called_by_python(given._replace(rest=None))[0] == 2.0 + 5.0
    _, _, types, _ = entry.get_call_template((numba.typeof(given),), {})
    assert types == (by_entries(outer(inner(other=NONE), NONE, NONE)),)


@inner_kernel
def first_or_new(outer, anew):
    if anew:
        outer = Outer(Inner(outer.rest, 1.0), outer.rest, outer.more)
    return entry(outer)


@kernel
def takes_first_or_new(outer, anew):
    return first_or_new(outer, anew)


def test_a_variable_may_hold_an_argument_or_a_new_tuple():
    given = Outer(Inner(np.array([2.0]), 0.0), np.array([7.0]), np.array([11.0]))
    assert [takes_first_or_new(given, anew) for anew in (False, True)] == [2.0, 7.0]
