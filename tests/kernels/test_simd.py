"""Eight pairs at once: the times of their contacts are those of one pair at a time."""

import numpy as np
import pytest
from numpy import uint64

from gaspart.kernels.compilation import kernel
from gaspart.kernels.event.model import Gravity, Space
from gaspart.kernels.flight import note_still, pair_time
from gaspart.kernels.simd import LAP_BITS, LAP_FIRST, earliest, lowest


@kernel
def first_of(rows, near, met, body, soon, partner, space, gravity, still):
    return earliest(rows, near, uint64(met), uint64(body), soon, partner, space, gravity, still)


@kernel
def time(rows, i, j, offset, space, gravity):
    return pair_time(rows, i, j, offset, space, gravity)


@kernel
def note(rows, body, space, gravity, still):
    note_still(rows, body, space, gravity, still)


@kernel
def first_bit(bits):
    return lowest(uint64(bits))


NONE = np.zeros(64, dtype=np.uint8)


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


def offset_of(lap, lengths):
    return tuple(float(a * b) for a, b in zip(lap, lengths, strict=True))


@pytest.mark.parametrize("d", [2, 3])
def test_eight_times_are_those_of_the_pairs_to_the_bit(d):
    rows, lengths, others, laps, near = scene_of(d, seed=d)
    space = Space(lengths, (True,) * d, 1.0)
    finite = 0
    for n, (other, lap) in enumerate(zip(others, laps, strict=True)):
        alone = np.concatenate([near[n : n + 1], np.full(7, 7, dtype=np.uint64)])
        expected = time(rows, 7, other, offset_of(lap, lengths), space, None)
        found = first_of(rows, alone, 1, 7, np.inf, -1, space, None, NONE)
        assert found == ((expected, other, 0) if expected < np.inf else (np.inf, -1, 0))
        finite += expected < np.inf
    assert 20 < finite < 400


def test_the_earliest_of_many_and_of_simultaneous_ones_the_lowest():
    rows, lengths, others, laps, near = scene_of(3, seed=3)
    rows[40:48] = rows[32:40]
    space = Space(lengths, (True,) * 3, 1.0)
    for first in range(0, 736, 3):
        for met in (1, 8, 21, 64):
            chosen = near[first : first + 72].copy()
            chosen[met : met + 8] = 7
            times = [
                (time(rows, 7, others[n], offset_of(laps[n], lengths), space, None), others[n])
                for n in range(first, first + met)
            ]
            best = min(times)
            best = best if best[0] < np.inf else (np.inf, -1)
            assert first_of(rows, chosen, met, 7, np.inf, -1, space, None, NONE) == (*best, 0)
            before = (best[0], 0) if best[0] < np.inf else (5.0, 3)
            assert first_of(rows, chosen, met, 7, *before, space, None, NONE) == (*before, 0)


def test_pairs_that_may_not_fall_alike_are_left_to_be_looked_at():
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
    still = np.zeros(len(rows), dtype=np.uint8)
    for body in range(len(rows)):
        note(rows, body, space, gravity, still)
    finite = 0
    for body in (0, 3, 5, 7):  # fixed, lying, fixed, falling
        assert still[body] == (body != 7)
        for n, (other, lap) in enumerate(zip(others, laps, strict=True)):
            alone = np.concatenate([near[n : n + 1], np.full(7, body, dtype=np.uint64)])
            found = first_of(rows, alone, 1, body, np.inf, -1, space, gravity, still)
            if body != 7 or fixed[other] or other % 3 == 0:
                assert (*found[:2], found[2] & 1) == (np.inf, -1, 1)
                continue
            expected = time(rows, body, other, offset_of(lap, lengths), space, gravity)
            assert found == ((expected, other, 0) if expected < np.inf else (np.inf, -1, 0))
            finite += expected < np.inf
    assert finite > 10


def test_lowest_bit():
    assert [first_bit(1 << n | 1 << 63) for n in (0, 5, 62, 63)] == [0, 5, 62, 63]
