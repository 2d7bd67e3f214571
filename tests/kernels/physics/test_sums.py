"""Exact sums: of any size and order, and without an end."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import gas

import gaspart as gp
from gaspart.kernels.compile.policy import kernel
from gaspart.kernels.physics.exact_sum import DIGITS, WIDTH, add_exact, exact_parts, sum_over_threads
from gaspart.kernels.physics.running_sum import add, add_whole, net, values, whole_parts

NUMBERS = st.floats(allow_nan=False, allow_infinity=False, width=64)


@kernel
def add_all(total, terms):
    for x in terms:
        add_exact(total, x)


def summed(*lists):
    """The sums (threads, WIDTH) of lists of numbers, one by each thread."""
    total = np.zeros((len(lists), WIDTH), np.int64)
    for row, terms in zip(total, lists, strict=True):
        add_all(row, np.array(terms, dtype=float))
    return total


@given(st.lists(NUMBERS, max_size=40), st.lists(NUMBERS, max_size=40))
def test_a_sum_is_exact_whatever_the_sizes_of_its_terms(one, other):
    exact = sum(map(Fraction, one + other), Fraction(0))
    if abs(exact) < Fraction(2) ** 1000:
        value, rest = exact_parts(summed(one, other))
        assert value == float(exact)
        assert abs(exact - Fraction(value) - Fraction(rest)) <= abs(exact) * Fraction(2) ** -64


def test_order_and_threads_do_not_matter():
    rng = np.random.default_rng(3)
    terms = rng.standard_normal(1000) * 10.0 ** rng.integers(-300, 300, 1000)
    found = sum_over_threads(summed(terms))
    for parts in ((terms[::-1],), (terms[:300], terms[300:]), (terms[700:], [], terms[:700])):
        assert np.array_equal(sum_over_threads(summed(*parts)), found)


def test_what_is_left_of_large_terms_is_kept():
    value, _ = exact_parts(summed([1e300, 1e-300, -1e300]))
    assert value == 1e-300
    assert exact_parts(summed([1e16, 1.0, -1e16, 0.0, -0.0])).tolist() == [1.0, 0.0]


@pytest.mark.parametrize("x", [1.0, -math.pi, 2.0**-1074, 1e-40, 1e200])
def test_nothing_overflows(x):
    """Sums of the most terms that are added without a carry, and one more."""
    total = summed([x])
    total *= 2**29 - 1
    total[0, DIGITS] = 2**29 - 1  # as many terms
    add_all(total[0], np.array([x]))  # makes the carries
    assert total[0, DIGITS] == 0 and (total[0, : DIGITS - 1] < 2**32).all()
    for _ in range(10):
        total *= 2
        sum_over_threads(total[None])
    assert exact_parts(total)[0] == x * 2.0**39


# The tally's sums do not lose digits as they grow, and do not depend on where a run is split.


@kernel
def add_all_to_tally(sums, terms):
    for x in terms:
        add(sums, 1, x)


@kernel
def add_all_whole(sums, terms, largest):
    for x in terms:
        add_whole(sums[1], x, largest)


@kernel
def add_many(sums, start, factor, number):
    """Terms of a linear congruential sequence, which need no memory."""
    x = start
    for _ in range(number):
        x = (x * factor) % 1.0
        add(sums, 0, x)


def summed_by_tally(terms):
    sums = np.zeros((2, 2))
    add_all_to_tally(sums, np.asarray(terms, dtype=float))
    return sums


@given(st.lists(st.floats(-1e30, 1e30, allow_subnormal=False), max_size=60))
def test_the_sum_is_the_exact_one_to_its_last_place(terms):
    exact = float(sum(map(Fraction, terms)))
    assert net(summed_by_tally(terms)[1]) == pytest.approx(exact, rel=2e-16, abs=1e-30 * sum(map(abs, terms)))


def test_what_a_plain_sum_loses_is_kept():
    terms = np.full(1_000_000, 0.1)
    sums = summed_by_tally(terms)
    assert sums[1, 0] != pytest.approx(1e5, rel=1e-12)  # the plain sum, which the first part still is
    assert values(sums)[1] == float(1_000_000 * Fraction(0.1))
    assert (sums[0] == 0.0).all()


def test_large_sums_that_cancel_leave_the_small_one():
    rng = np.random.default_rng(1)
    there, back = rng.random((2, 100_000)) * 1e6
    into = summed_by_tally(np.concatenate([there, [0.3]]))
    out = summed_by_tally(-np.concatenate([there[::-1], back, -back]))
    assert net(into[1], out[1]) == pytest.approx(0.3, abs=1e-15)


def test_integer_sums_do_not_depend_on_the_order():
    rng = np.random.default_rng(2)
    terms = rng.standard_normal(10_000) * 10.0 ** rng.integers(-9, 2, 10_000)
    found = []
    for order in (terms, terms[::-1], np.sort(terms)):
        sums = np.zeros((2, 2), dtype=np.int64)
        add_all_whole(sums, order, 64.0)
        found.append(sums)
        parts = whole_parts(sums, 64.0)
        assert net(parts) == pytest.approx(math.fsum(terms), abs=10_000 * 64.0 * 2.0**-58)
    assert np.array_equal(found[0], found[1]) and np.array_equal(found[0], found[2])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_integer_sums_hold_ten_thousand_million_of_the_largest_terms(sign):
    sums = np.zeros((2, 2), dtype=np.int64)
    add_all_whole(sums, np.array([sign * (64.0 - 64.0 * 2.0**-29)]), 64.0)  # the largest remainder too
    assert (abs(sums[1].astype(float)) * 1e10 < 2.0**63).all()


def scenes():
    """A gas of two masses between plain walls; a granular gas that a thermal wall heats."""
    box = gp.Container((10.0, 10.0))
    species = [gp.Species(2, 0.5, temperature=1.0), gp.Species(2, 0.3, mass=0.1, temperature=1.0)]
    law = gp.Restitution(0.9, 0.5)
    yield gp.Scene(box, species)
    yield gp.Scene(box, species, restitution=law, faces={"x_low": gp.Thermal(1.0)})


SUMS = ("virial_sum", "wall_impulse", "wall_energy", "dissipated_energy")


def exact_sums(scene, engine, chunks, **chunk):
    """The sums of tallies that begin anew after every chunk, added exactly."""
    sim = gp.Simulation(scene, engine, seed=5)
    parts = {name: [] for name in SUMS}
    for _ in range(chunks):
        sim.advance(**chunk)
        tally = sim.tally
        for name in SUMS:
            parts[name].append(np.atleast_1d(getattr(tally, name)))
        sim.reset_tally()
    sim.check_invariants()
    return {name: [math.fsum(column) for column in np.array(found).T] for name, found in parts.items()}


def check_sums(scene, engine, chunks, rel, **chunk):
    exact = exact_sums(scene, engine, chunks, **chunk)
    sim = gp.Simulation(scene, engine, seed=5)
    for _ in range(chunks):
        sim.advance(**chunk)
    for name in SUMS:
        found = np.atleast_1d(getattr(sim.tally, name))
        assert found == pytest.approx(np.array(exact[name]), rel=rel), name


@pytest.mark.thorough
@pytest.mark.parametrize("scene", list(scenes()))
def test_a_tally_is_the_sum_of_its_parts(scene):
    check_sums(scene, gp.EventDriven(), 300, 1e-15, max_events=1000)


@kernel
def exact_terms(start, factor, number):
    """The sum of the terms of `add_many`, times 2^33."""
    x, total, mask = start, np.uint64(0), np.uint64(2**33 - 1)
    for _ in range(number):
        x = (x * factor) & mask
        total += x
    return total


@pytest.mark.thorough
def test_a_thousand_million_terms():
    """Against integers: the terms are multiples of 2^-33, so that products with the factor are exact."""
    sums, number, factor = np.zeros((2, 2)), 1_000_000_000, 5741
    add_many(sums, 2.0**-33, float(factor), number)
    total = int(exact_terms(np.uint64(1), np.uint64(factor), number))
    assert net(sums[0]) == float(Fraction(total, 2**33))


@pytest.mark.thorough
@pytest.mark.parametrize("settings", [{}, {"precision": "float32"}, {"threads": 2}])
def test_the_steps_tally_is_the_sum_of_its_parts(settings):
    scene = gas(2, 30, 0.1, "wall")
    check_sums(scene, gp.TimeStepped(0.01, **settings), 100, 1e-14, duration=1.0)
