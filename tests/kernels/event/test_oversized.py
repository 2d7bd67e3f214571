"""Particles too large for the boxes: the same events as without a partition, in less work."""

import pytest
from referee import events_of, same_bits
from scenes import gas

import gaspart as gp
from gaspart.state.boxes import largest_in_boxes, work


def uneven_gas(dimension, count, ratio):
    """Particles of radius 1/ratio around one of radius 1 in the middle of a container of side 4."""
    large = gp.Particle((2.0,) * dimension, (0.0,) * dimension, 1.0, mass=10.0)
    small = gp.Species(count, 1.0 / ratio, temperature=1.0)
    return gp.Scene(gp.Container((4.0,) * dimension), [small], [large])


@pytest.mark.thorough
@pytest.mark.parametrize("dimension", [2, 3])
def test_size_ratios_to_ten_thousand(dimension):
    """The same events, from less than a tenth of the particles looked at, and no energy lost."""
    scene = uneven_gas(dimension, 1000 if dimension == 2 else 3000, 1e4)
    boxes, direct = (events_of(scene, search, 500) for search in ("boxes", "direct"))
    assert same_bits(boxes, direct)
    assert (boxes.events["particles"] == 0).any()
    assert boxes.tally.pair_tests < 0.1 * direct.tally.pair_tests
    boxes.check_invariants()


def test_which_particles_are_kept_outside():
    assert largest_in_boxes(uneven_gas(2, 1000, 100.0)) == 0.01
    assert work(uneven_gas(2, 1000, 100.0), 0.01) < 0.1 * work(uneven_gas(2, 1000, 100.0), 1.0)
    assert largest_in_boxes(gas(3, 1000, 0.1)) == 0.5
    alike = gp.Scene(gp.Container((40.0, 40.0)), [gp.Species(50, 0.5), gp.Species(50, 1.0)])
    assert largest_in_boxes(alike) == 1.0
    assert largest_in_boxes(gp.Scene(gp.Container((4.0, 4.0)))) == 0.0
