"""Particles that touch: what is exact in decimals is accepted, and then a contact, not an overlap."""

import numpy as np
import pytest

import gaspart as gp
from gaspart.scene.sizes import CLOSE_PACKING

TRIPLES = (
    (3, 4, 0, 5),
    (5, 12, 0, 13),
    (1, 2, 2, 3),
    (2, 3, 6, 7),
    (4, 4, 7, 9),
    (0, 1, 0, 1),
    (8, 15, 0, 17),
)


def decimal_pair(rng):
    """Two particles that touch exactly in decimals of up to four digits, somewhere in a container."""
    dimension = int(rng.integers(2, 4))
    *step, distance = TRIPLES[rng.integers(len(TRIPLES))]
    if dimension == 2:
        step, distance = ((3, 4), 5) if step[2] else (step[:2], distance)
    step = rng.permutation(step) * rng.choice([-1, 1], dimension)
    unit = int(rng.integers(1, 40))  # of 1e-4
    first = int(rng.integers(1, 2 * unit * distance)) if unit * distance > 1 else 1
    radii = [first, unit * distance - first] if first < unit * distance else [unit * distance / 2] * 2
    at = rng.integers(20_000, 60_000, dimension)
    decimals = [[float(f"{x}e-4") for x in place] for place in (at, at + unit * step)]
    return gp.Container((10.0,) * dimension), decimals, [float(f"{r}e-4") for r in radii]


def scene_of(container, places, radii, apart=0.0):
    still = (0.0,) * container.dimension
    particles = [gp.Particle(tuple(at), still, r - apart) for at, r in zip(places, radii, strict=True)]
    return gp.Scene(container, particles=particles)


def test_pairs_that_touch_in_decimals_are_accepted_and_overlaps_are_not():
    rng = np.random.default_rng(1)
    overlapping = 0
    for _ in range(500):
        container, places, radii = decimal_pair(rng)
        assert scene_of(container, places, radii).count == 2
        overlapping += np.linalg.norm(np.subtract(*places)) < sum(radii)  # in binary numbers
        with pytest.raises(gp.SceneError, match=r"particles\[1\]\.position.*overlaps particles\[0\]"):
            scene_of(container, places, radii, apart=-1e-12)
    assert overlapping > 100  # so that the tolerance is what accepts them


def row(*places, radius=0.05, speed=2.0):
    particles = [gp.Particle((x, 0.2, 0.2), (0.0,) * 3, radius) for x in places]
    first = gp.Particle((0.2, 0.2, 0.2), (speed, 0.0, 0.0), radius)
    return gp.Scene(gp.Container((1.0, 0.4, 0.4)), particles=[first, *particles])


@pytest.mark.interpreted
@pytest.mark.parametrize("engine", [gp.EventDriven(), gp.EventDriven(search="pairs"), gp.TimeStepped(0.001)])
def test_a_row_of_touching_balls_hands_on_the_momentum(engine):
    """Newton's cradle: the last ball leaves with the speed of the first, at the time of the first contact."""
    sim = gp.Simulation(row(0.5, 0.6, 0.7), engine)
    sim.advance(until=0.2)
    assert np.allclose(sim.state.velocities[:, 0], [0.0, 0.0, 0.0, 2.0], atol=1e-14)
    assert np.allclose(sim.state.positions[:, 0], [0.4, 0.5, 0.6, 0.7 + 2.0 * 0.1], atol=1e-12)


def test_a_particle_in_a_corner_touches_both_walls():
    scene = gp.Scene(gp.Container((0.3, 0.3)), particles=[gp.Particle((0.2, 0.1), (-1.0, 0.0), 0.1)])
    sim = gp.Simulation(scene, gp.EventDriven())
    assert sim.state.positions[0, 0] == 0.3 - 0.1  # exactly where the wall stops it
    sim.advance(until=0.35)
    assert sim.tally.wall_hits.tolist() == [2, 1, 0, 0]
    assert np.allclose(sim.state.positions, [[0.15, 0.1]], atol=1e-15)
    for x in (0.2 + 1e-14, 0.1 - 1e-14):
        with pytest.raises(gp.SceneError, match="completely inside"):
            gp.Scene(gp.Container((0.3, 0.3)), particles=[gp.Particle((x, 0.1), (0.0, 0.0), 0.1)])


def test_touching_across_a_periodic_face():
    box = gp.Container((0.7, 0.7), "periodic")
    particles = [gp.Particle((x, 0.3), (0.0, 0.0), 0.1) for x in (0.6, 0.1)]
    assert gp.Scene(box, particles=particles).count == 2
    with pytest.raises(gp.SceneError, match="overlaps"):
        gp.Scene(box, particles=[particles[0], gp.Particle((0.1, 0.3), (0.0, 0.0), 0.1 + 1e-14)])


@pytest.mark.thorough
def test_a_tower_on_the_floor_stands():
    """Four discs that touch, at rest under gravity, with contacts that lose energy: nothing moves."""
    particles = [gp.Particle((1.0, y), (0.0, 0.0), 0.1) for y in (0.1, 0.3, 0.5, 0.7)]
    law = {"gravity": (0.0, -9.81), "restitution": gp.Restitution(0.5)}
    sim = gp.Simulation(gp.Scene(gp.Container((2.0, 6.0)), particles=particles, **law), gp.EventDriven())
    sim.advance(until=0.5)
    assert np.allclose(sim.state.positions[:, 1], [0.1, 0.3, 0.5, 0.7], atol=1e-6)


def test_a_triangular_crystal_at_close_packing_is_valid():
    places = [(0.1 + 0.2 * x + 0.1 * (y % 2), 0.1 * np.sqrt(3.0) * y) for y in range(6) for x in range(5)]
    box = gp.Container((1.0, 6 * 0.1 * np.sqrt(3.0)), "periodic")
    scene = gp.Scene(box, particles=[gp.Particle(at, (0.0, 0.0), 0.1) for at in places])
    assert scene.packing_fraction == pytest.approx(CLOSE_PACKING[2], rel=1e-12)


def rock_salt(gap):
    """Eight unit cells of large and small spheres, which touch at a gap of 0: a ratio of sqrt(2) - 1."""
    large, small, edge = 0.5, 0.5 * (np.sqrt(2.0) - 1.0), np.sqrt(2.0) * (1.0 + gap)
    particles = []
    for place in np.ndindex(4, 4, 4):
        at = tuple(0.5 * edge * np.array(place))
        particles.append(gp.Particle(at, (0.0,) * 3, small if sum(place) % 2 else large))
    return gp.Scene(gp.Container((2.0 * edge,) * 3, "periodic"), particles=particles)


def test_mixtures_may_be_denser_than_equal_particles():
    scene = rock_salt(0.005)
    assert scene.packing_fraction == pytest.approx(0.793 / 1.005**3, abs=1e-3)
    assert scene.packing_fraction > CLOSE_PACKING[3]
    pushed = [
        gp.Particle(it.position, (0.1, 0.2, -0.3), it.radius) if n == 0 else it
        for n, it in enumerate(scene.particles)
    ]
    sim = gp.Simulation(gp.Scene(scene.container, particles=pushed), gp.EventDriven())
    sim.advance(max_events=500)
    sim.check_invariants()
    assert sim.tally.collisions == 500


def test_no_mixture_fills_more_than_the_container():
    kinds = [gp.Species(60, 0.5), gp.Species(40, 0.49)]
    with pytest.raises(gp.SceneError, match="packing_fraction = 1.*exceeds close packing"):
        gp.Scene(gp.Container((8.0, 8.0)), [*kinds, gp.Species(30, 0.3)])
    with pytest.raises(gp.SceneError, match="exceeds close packing"):
        gp.Scene(gp.Container((8.0, 8.0)), [gp.Species(75, 0.5), gp.Species(0, 0.1)])
