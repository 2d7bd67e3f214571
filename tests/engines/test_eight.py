"""Eight pairs at once: whether they may touch is what the time of their contact says."""

import numpy as np
import pytest
from numpy import uint64

from gaspart.engines.eight import LAP_BITS, LAP_FIRST, lowest, which_meet
from gaspart.engines.flight import pair_time
from gaspart.engines.layout import Gravity, Space
from gaspart.kernel import kernel


@kernel
def meets(rows, near, first, body, space, gravity):
    return which_meet(rows, near, uint64(first), uint64(body), space, gravity)


@kernel
def time(rows, i, j, offset, space, gravity):
    return pair_time(rows, i, j, offset, space, gravity)


@kernel
def first_bit(bits):
    return lowest(uint64(bits))


def scene_of(d, seed):
    """Rows of bodies of which some just touch, and candidates in all images."""
    rng = np.random.default_rng(seed)
    n = 64
    rows = np.zeros((n, 8))
    lengths = tuple(rng.uniform(3.0, 5.0, d))
    rows[:, :d] = rng.uniform(0.0, 1.0, (n, d)) * lengths
    rows[:, d : 2 * d] = rng.normal(size=(n, d))
    rows[:, 2 * d] = rng.uniform(0.0, 0.3, n)
    rows[:, 2 * d + 1] = rng.choice([0.0, 0.5, 0.8], n)
    rows[:8, 2 * d + 1] = 0.8
    rows[rng.random(n) < 0.2, 2 * d] = 0.3
    others = rng.integers(0, n, 800)
    laps = rng.choice([-1, 0, 0, 0, 1], (800, d))
    near = others.astype(np.uint64)
    for k in range(d):
        near |= (laps[:, k] + 1).astype(np.uint64) << np.uint64(LAP_FIRST + LAP_BITS * k)
    return rows, lengths, others, laps, near


@pytest.mark.parametrize("d", [2, 3])
def test_which_meet_is_which_have_a_time(d):
    rows, lengths, others, laps, near = scene_of(d, seed=d)
    space = Space(lengths, (True,) * d, 1.0)
    found, expected = [], []
    for first in range(0, len(near), 8):
        bits = meets(rows, near, first, 7, space, None)
        assert bits < 256
        found += [bits >> n & 1 for n in range(8)]
    for other, lap in zip(others, laps, strict=True):
        offset = tuple(float(a * b) for a, b in zip(lap, lengths, strict=True))
        expected.append(time(rows, 7, other, offset, space, None) < np.inf)
    assert found == expected
    assert 20 < sum(found) < 400
    assert not any(bit for bit, other in zip(found, others, strict=True) if other == 7)


def test_falling_bodies_that_rest_or_are_fixed_may_meet():
    rows, lengths, others, laps, near = scene_of(3, seed=5)
    rows[::3, 5], rows[::3, 2] = 0.0, rows[::3, 7]
    fixed = np.zeros(len(rows), dtype=np.bool_)
    fixed[::5] = True
    rows[::5, 3:6] = 0.0
    space = Space(lengths, (True, True, False), 1.0)
    gravity = Gravity((0.0, 0.0, -1.0), fixed, 0.0)
    laps[:, 2] = 0
    near &= ~(np.uint64(3) << np.uint64(LAP_FIRST + 2 * LAP_BITS))
    near |= np.uint64(1) << np.uint64(LAP_FIRST + 2 * LAP_BITS)
    for body in (0, 3, 5, 7):  # fixed, lying, fixed, falling
        falls = not (fixed[body] or body % 3 == 0)
        found, expected, alike = [], [], []
        for first in range(0, len(near), 8):
            bits = meets(rows, near, first, body, space, gravity)
            found += [bits >> n & 1 for n in range(8)]
        for other, lap in zip(others, laps, strict=True):
            offset = tuple(float(a * b) for a, b in zip(lap, lengths, strict=True))
            expected.append(time(rows, body, other, offset, space, gravity) < np.inf)
            alike.append((not (fixed[other] or other % 3 == 0)) == falls)
        found, expected, alike = map(np.array, (found, expected, alike))
        assert (found[alike] == expected[alike]).all()
        assert found[~alike].all()
        assert not falls or expected[alike].sum() > 10


def test_lowest_bit():
    assert [first_bit(1 << n | 1 << 63) for n in (0, 5, 62, 63)] == [0, 5, 62, 63]
