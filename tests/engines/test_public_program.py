"""Four things that the public program of Spencer 2022 (*Billiards*) gets wrong, one test each."""

import math

import pytest
from scenes import sent

import gaspart as gp

pytestmark = pytest.mark.thorough


@pytest.mark.parametrize("boxes_per_side", [1, 2, 3, 4, 7, 11])
def test_interior_walls_are_there_in_any_number_of_sectors(boxes_per_side):
    """There, particles pass through them from 3 x 3 sectors up."""
    wall = gp.Wall((6.0, 0.0), (6.0, 12.0))
    for x, v in ((2.0, 1.0), (10.0, -1.0)):  # from both sides
        sim = sent((x, 6.1), (v, 0.0), [wall], boxes_per_side=boxes_per_side)
        sim.advance(duration=4.0)
        assert sim.tally.wall_hits.tolist() == [0, 0, 0, 0, 1]
        assert sim.tally.wall_impulse[4] == 2.0
        assert sim.state.velocities.tolist() == [[-v, 0.0]]
        assert sim.state.positions[0, 0] == pytest.approx(x + 3.0 * v, rel=1e-15)


@pytest.mark.parametrize("degrees", [0, 10, 45, 80])
@pytest.mark.parametrize("boxes_per_side", [1, 5])
def test_the_ends_of_walls_are_solid(degrees, boxes_per_side):
    """There, particles pass through them. A particle that comes along y at an impact parameter b = R sin(a)
    from the end leaves at the angle 2a."""
    a = math.radians(degrees)
    wall = gp.Wall((6.0, 6.0), (6.0, 11.0))  # its lower end is in the way
    sim = sent((6.0 + 0.5 * math.sin(a), 2.0), (0.0, 1.0), [wall], boxes_per_side=boxes_per_side)
    sim.record_events = True
    sim.advance(max_events=1)
    assert sim.events["particles"].tolist() == [[0, -5]]
    assert sim.events["time"] == pytest.approx([4.0 - 0.5 * math.cos(a)], rel=1e-14)
    expected = [math.sin(2 * a), -math.cos(2 * a)]
    assert sim.state.velocities[0] == pytest.approx(expected, abs=1e-14)


def test_a_run_stops_exactly_when_it_should():
    """There, it goes on to the next event; here the time is kept before, at and after a hit."""
    wall = gp.Wall((6.0, 0.0), (6.0, 12.0))
    sim = sent((2.0, 6.0), (1.0, 0.0), [wall])
    for until, x, v in ((3.0, 5.0, 1.0), (3.5, 5.5, -1.0), (3.75, 5.25, -1.0)):
        sim.advance(until=until)
        assert sim.time == until
        assert sim.state.positions[0, 0] == x
        assert sim.state.velocities[0, 0] == v


@pytest.mark.parametrize(
    ("position", "problem"),
    [
        ((6.0, 6.4), "overlaps particles"),
        ((0.4, 6.0), "completely inside the container"),
        ((9.0, 2.3), "overlaps walls"),
    ],
)
def test_overlapping_input_is_refused(position, problem):
    """There, discs may begin within each other, within walls and outside of the container."""
    sim = sent((6.0, 6.0), (1.0, 0.0), [gp.Wall((8.0, 2.0), (10.0, 2.0))])
    with pytest.raises(gp.SceneError, match=problem):
        sim.add(position, (0.0, 0.0), 0.5)
    assert sim.scene.count == 1
