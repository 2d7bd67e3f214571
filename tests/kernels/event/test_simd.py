"""Eight pairs at once: the times of their contacts are those of one pair at a time."""

import numpy as np
import pytest
from numpy import uint64

import gaspart as gp
from gaspart.kernels.compile.policy import kernel
from gaspart.kernels.event.boxes import empty_lists
from gaspart.kernels.event.simd import earliest
from gaspart.kernels.model import IMAGE_BITS, NUMBER_BITS, Gravity, Space, flight_dtype
from gaspart.kernels.physics.flight import mark_resting, time_of_contact
from gaspart.kernels.simd import lowest
from gaspart.state.boxes import make_boxes


@kernel
def compiled_first(flights, i, count, present, boxes, space, gravity):
    return earliest(flights, uint64(i), (uint64(0), uint64(count)), present, boxes, space, gravity)


BOXES = empty_lists(make_boxes(gp.Scene(gp.Container((9.0,) * 3)), 1, images=True), 64)


def first_of(flights, candidates, count, i, present, space, gravity=None, resting=None):
    """The earliest contact with the first of some candidates, and which are not known."""
    boxes = BOXES._replace(candidates=candidates, resting=BOXES.resting if resting is None else resting)
    return compiled_first(flights, i, count, present, boxes, space, gravity)


@kernel
def time(flights, i, j, offset, space, gravity):
    return time_of_contact(flights, i, j, offset, space, gravity)


@kernel
def mark(flights, i, space, gravity, resting):
    mark_resting(flights, i, space, gravity, resting)


@kernel
def first_bit(bits):
    return lowest(uint64(bits))


def scene_of(d, seed):
    """Flights of particles of which some just touch, and candidates in all images."""
    rng = np.random.default_rng(seed)
    n = 64
    flights = np.zeros(n, flight_dtype(d))
    lengths = tuple(rng.uniform(3.0, 5.0, d))
    flights["position"] = rng.uniform(0.0, 1.0, (n, d)) * lengths
    flights["velocity"] = rng.normal(size=(n, d))
    flights["clock"] = rng.uniform(0.0, 0.3, n)
    flights["radius"] = rng.choice([0.0, 0.5, 0.8], n)
    flights["radius"][:8] = 0.8
    flights["clock"][rng.random(n) < 0.2] = 0.3
    others = rng.integers(0, n, 800)
    images = rng.choice([-1, 0, 0, 0, 1], (800, d))
    near = others.astype(np.uint32)
    for k in range(d):
        near |= (images[:, k] & 3).astype(np.uint32) << np.uint32(NUMBER_BITS + IMAGE_BITS * k)
    return flights, lengths, others, images, near


def offset_of(image, lengths):
    return tuple(float(a * b) for a, b in zip(image, lengths, strict=True))


@pytest.mark.parametrize("d", [2, 3])
def test_eight_times_are_those_of_the_pairs_to_the_bit(d):
    flights, lengths, others, images, near = scene_of(d, seed=d)
    space = Space(lengths, (True,) * d, 1.0)
    finite = 0
    for n, (other, image) in enumerate(zip(others, images, strict=True)):
        alone = np.concatenate([near[n : n + 1], np.full(7, 7, dtype=np.uint32)])
        expected = time(flights, 7, other, offset_of(image, lengths), space, None)
        found = first_of(flights, alone, 1, 7, (np.inf, -1), space)
        assert found == ((expected, other, 0) if expected < np.inf else (np.inf, -1, 0))
        finite += expected < np.inf
    assert 20 < finite < 400


def test_the_earliest_of_many_and_of_simultaneous_ones_the_lowest():
    flights, lengths, others, images, near = scene_of(3, seed=3)
    flights[40:48] = flights[32:40]
    space = Space(lengths, (True,) * 3, 1.0)
    for first in range(0, 736, 3):
        for met in (1, 8, 21, 64):
            chosen = near[first : first + 72].copy()
            chosen[met : met + 8] = 7
            times = [
                (time(flights, 7, others[n], offset_of(images[n], lengths), space, None), others[n])
                for n in range(first, first + met)
            ]
            best = min(times)
            best = best if best[0] < np.inf else (np.inf, -1)
            assert first_of(flights, chosen, met, 7, (np.inf, -1), space) == (*best, 0)
            before = (best[0], 0) if best[0] < np.inf else (5.0, 3)
            assert first_of(flights, chosen, met, 7, before, space) == (*before, 0)


def test_pairs_that_may_not_fall_alike_are_left_to_be_looked_at():
    flights, lengths, others, images, near = scene_of(3, seed=5)
    flights["velocity"][::3, 2], flights["position"][::3, 2] = 0.0, flights["radius"][::3]
    fixed = np.zeros(len(flights), dtype=np.bool_)
    fixed[::5] = True
    flights["velocity"][::5] = 0.0
    space = Space(lengths, (True, True, False), 1.0)
    gravity = Gravity((0.0, 0.0, -1.0), fixed, 0.0, None)
    images[:, 2] = 0
    near &= ~(np.uint32(3) << np.uint32(NUMBER_BITS + 2 * IMAGE_BITS))
    resting = np.zeros(len(flights), dtype=np.uint8)
    for i in range(len(flights)):
        mark(flights, i, space, gravity, resting)
    finite = 0
    for i in (0, 3, 5, 7):  # fixed, resting, fixed, falling
        assert resting[i] == (i != 7)
        for n, (other, image) in enumerate(zip(others, images, strict=True)):
            alone = np.concatenate([near[n : n + 1], np.full(7, i, dtype=np.uint32)])
            found = first_of(flights, alone, 1, i, (np.inf, -1), space, gravity, resting)
            if i != 7 or fixed[other] or other % 3 == 0:
                assert (*found[:2], found[2] & 1) == (np.inf, -1, 1)
                continue
            expected = time(flights, i, other, offset_of(image, lengths), space, gravity)
            assert found == ((expected, other, 0) if expected < np.inf else (np.inf, -1, 0))
            finite += expected < np.inf
    assert finite > 10


def test_lowest_bit():
    assert [first_bit(1 << n | 1 << 63) for n in (0, 5, 62, 63)] == [0, 5, 62, 63]
