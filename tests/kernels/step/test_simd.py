"""Eight slots at once: what is found in them is what one after another would."""

import numpy as np
import pytest
from numpy import uint32, uint64

from gaspart.kernels.compile.policy import kernel
from gaspart.kernels.model import Space
from gaspart.kernels.step.model import StepParticles
from gaspart.kernels.step.neighbour_list import bits, compact_eight, equals, nearer, roomy
from gaspart.kernels.step.resolve import distance_squared


@kernel
def near_eight(particles, slot, space, skin, first):
    return nearer(particles.positions, particles.radii, space, uint64(slot), skin, uint64(first))


@kernel
def near_one(particles, slot, space, skin, other):
    reach = particles.radii[slot] + particles.radii[other] + skin
    return distance_squared(particles, slot, other, space) < reach * reach


@kernel
def same_eight(values, first, value):
    return equals(values, uint64(first), uint32(value))


@kernel
def compacted(words, first, least, kept, number):
    return compact_eight(words, uint64(first), uint64(least), kept, uint64(number))


@kernel
def count_bits(word):
    return bits(uint64(word))


def marked(word):
    return [n for n in range(8) if int(word) >> n & 1]


@pytest.mark.parametrize(("d", "real"), [(2, np.float32), (3, np.float64)])
def test_which_particles_are_near_is_exact_to_the_bit(d, real):
    rng = np.random.default_rng(d)
    positions, radii = roomy((d, 40), real), roomy((40,), real)
    positions[...] = rng.integers(0, 9, (d, 40)) / 8  # on a grid: many are just as far as a contact
    radii[...] = rng.integers(1, 3, 40) / 16
    none = np.empty(0, np.uint32)
    rest = {"index": none, "masses": radii, "last_pass": none, "bounds": np.zeros(2), "ordinary": 40}
    particles = StepParticles(positions, positions, none, radii, **rest)
    space = Space((real(1.25),) * d, (True, False, True)[:d], real(1.0))
    total = 0
    for skin in (real(0.0), real(0.125)):
        for slot in range(40):
            for first in range(40):
                found = marked(near_eight(particles, slot, space, skin, first))
                there = range(min(8, 40 - first))
                alone = [n for n in there if near_one(particles, slot, space, skin, first + n)]
                assert [n for n in found if n in there] == alone
                total += len(found)
    assert 1000 < total < 15000


def test_which_places_hold_a_value():
    values = roomy((20,), np.uint32)
    values[...] = np.arange(20) % 3
    for first in range(13):
        assert marked(same_eight(values, first, 1)) == [n for n in range(8) if (first + n) % 3 == 1]


def test_words_that_are_kept_follow_one_another():
    rng = np.random.default_rng(5)
    words, kept = rng.integers(0, 2**63, 64, dtype=np.uint64), np.zeros(80, np.uint64)
    number = 0
    for first in range(0, 64, 8):
        number += int(compacted(words, first, 2**62, kept, number))
    assert kept[:number].tolist() == [word for word in words.tolist() if word >= 2**62]
    assert count_bits(2**63 + 5) == 3
