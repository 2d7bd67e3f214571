"""Initial states: particles placed where they may be, moving as they should."""

from __future__ import annotations

import math
import tracemalloc

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import closest, gas, mixtures

import gaspart as gp
from gaspart.state.boxes import deepest_overlap
from gaspart.state.initial import initial_state, random_insertion
from gaspart.state.insertion import wall_rows
from gaspart.state.random import stream


@given(mixtures(most=30))
def test_random_insertion_keeps_particles_apart_and_inside(scene):
    state = initial_state(scene, seed=1)
    assert closest(scene, state) >= 0
    for position, radius in zip(state.positions, state.radii, strict=True):
        low, high = scene.reach(radius)
        assert (position >= low).all()
        assert (position <= high).all()


def test_a_region_holds_its_whole_particles():
    kinds = [gp.Species(15, r, region=((2.0, 5.0), (6.0, 9.5))) for r in (0.1, 0.3)]
    scene = gp.Scene(gp.Container((10.0, 10.0), ("periodic", "wall")), [*kinds, gp.Species(20, 0.2)])
    state = initial_state(scene, 1)
    inside = state.species < 2
    low, high = state.positions - state.radii[:, None], state.positions + state.radii[:, None]
    assert ((low >= (2.0, 5.0)) & (high <= (6.0, 9.5)))[inside].all()
    assert not ((low >= (2.0, 5.0)) & (high <= (6.0, 9.5)))[~inside].all()
    assert closest(scene, state) > 0.0


@pytest.mark.parametrize("boundary", ["wall", "periodic"])
@pytest.mark.parametrize(("dimension", "eta"), [(2, 0.3), (2, 0.72), (3, 0.3), (3, 0.58)])
def test_lattices_hold_any_number(dimension, boundary, eta):
    for count in (1, 2, 7, 64, 108, 250):
        wanted = eta if boundary == "periodic" and count in (108, 250) else eta / 3
        scene = gas(dimension, count, wanted if count > 2 else 0.05, boundary, arrangement="lattice")
        state = initial_state(scene, seed=0)
        assert len(np.unique(state.positions, axis=0)) == count
        assert closest(scene, state) > -1e-12


def test_a_lattice_that_would_overlap_is_refused():
    with pytest.raises(gp.SceneError, match="a spacing of"):
        initial_state(gas(3, 100, 0.7, arrangement="lattice"), seed=0)


def advice(scene):
    with pytest.raises(gp.SceneError) as caught:
        initial_state(scene, seed=1)
    assert "does not fit by random insertion" in caught.value.rule
    return caught.value.rule.rpartition("; ")[2]


def test_what_an_overfull_scene_is_told_to_do_works():
    lattice, fewer = "use arrangement: lattice", "use fewer or smaller particles, or a larger container"
    box, obstacle = gp.Container((12.0, 12.0)), gp.Particle((6.0, 6.0), (0.0, 0.0), 0.5, fixed=True)
    kinds = [gp.Species(120, 0.5)]
    scene = gp.Scene(box, kinds)
    assert advice(scene) == lattice
    initial_state(gp.Scene(box, [gp.Species(120, 0.5, arrangement="lattice")]), seed=1)
    assert advice(gp.Scene(box, kinds, [obstacle])) == fewer
    assert advice(gp.Scene(box, kinds, walls=[gp.Wall((3.0, 6.3), (9.0, 6.3))])) == fewer
    assert advice(gp.Scene(box, [gp.Species(120, 0.5, region=((0.0, 0.0), (12.0, 12.0)))])) == fewer
    assert (
        advice(gp.Scene(box, [gp.Species(120, 0.5), gp.Species(400, 0.05)])) == fewer
    )  # all sites are alike


@pytest.mark.parametrize(("dimension", "eta", "boundary"), [(2, 0.4, "wall"), (3, 0.28, "periodic")])
def test_insertion_is_that_of_one_attempt_after_another(dimension, eta, boundary):
    scene = gas(dimension, 300, eta, boundary)
    large, small = (
        gp.Species(2, 1.2),
        gp.Species(40, 0.05),
    )  # outside the boxes; more than a box has places for
    scene = gp.Scene(scene.container, [*scene.species, small, large])
    positions, failures = random_insertion(scene, stream(5))
    lengths, rng, standing = np.array(scene.container.lengths), stream(5), []
    radii = {0: scene.species[0].radius, 1: 0.05, 2: 1.2}
    first = {0: 0, 1: 300, 2: 340}
    for kind in (2, 0, 1):  # the larger ones first
        count, low, high = scene.species[kind].count, *map(np.array, scene.reach(radii[kind]))
        placed = failed = 0
        while placed < count:
            draws = rng.random((max(256, 2 * (count - placed)), dimension))
            for place in low + draws * (high - low):
                gaps = np.abs(place - np.array([p for p, _ in standing]).reshape(-1, dimension))
                gaps = np.where(scene.container.periodic, np.minimum(gaps, lengths - gaps), gaps)
                if (np.sqrt((gaps**2).sum(axis=1)) < radii[kind] + np.array([r for _, r in standing])).any():
                    failed += 1
                    continue
                assert (positions[first[kind] + placed] == place).all()
                assert failures[first[kind] + placed] == failed
                standing.append((place, radii[kind]))
                placed, failed = placed + 1, 0
                if placed == count or kind == 2:  # large ones are tried alone
                    break


def test_failures_at_low_density_are_those_of_the_excluded_volume():
    # the chance that an attempt fails is 2^d eta to first order; here eta grows from 0 to 0.01
    failures = 0
    for seed in range(20):
        _, failed = random_insertion(gas(3, 1000, 0.01), stream(seed))
        failures += failed.sum()
    expected = 20 * 1000 * 8 * 0.005  # mean over the filling; the next order adds some 5 %
    assert failures == pytest.approx(expected * 1.045, abs=4 * math.sqrt(expected))


def test_velocities_have_their_speed_or_temperature():
    speeds = np.sqrt(
        (initial_state(gas(3, 500, 0.01, temperature=None, speed=2.0), 1).velocities ** 2).sum(axis=1)
    )
    assert np.allclose(speeds, 2.0, rtol=1e-14)
    velocities = initial_state(gas(2, 20_000, 0.01, temperature=3.0, mass=2.0), 1).velocities
    assert (velocities**2).mean() == pytest.approx(1.5, abs=4 * 1.5 * math.sqrt(2 / 40_000))
    assert not initial_state(gas(2, 10, 0.01, temperature=None), 1).velocities.any()


def test_explicit_particles_come_first_and_keep_their_positions():
    particle = gp.Particle((5.0, 5.0), (1.0, 0.0), 2.0, mass=7.0)
    scene = gp.Scene(gp.Container((10.0, 10.0)), [gp.Species(20, 0.3, speed=1.0)], [particle])
    state = initial_state(scene, seed=4)
    assert state.positions[0].tolist() == [5.0, 5.0]
    assert state.masses[0] == 7.0
    assert state.species.tolist() == [1] + [0] * 20
    assert closest(scene, state) >= 0


def test_a_slab_is_empty_in_its_upper_half_only():
    edge = 1.6
    container = gp.Container((4 * edge, 4 * edge, 6 * edge), "periodic")
    scene = gp.Scene(container, [gp.Species(364, 0.5, temperature=1.0, arrangement="slab")])
    positions = initial_state(scene, seed=1).positions
    below = positions[:, 2] < 3 * edge - 1e-9
    assert (below.sum(), (~below).sum()) == (4 * 16 * 3, 364 - 4 * 16 * 3)
    assert not np.array_equal(positions, initial_state(scene, seed=2).positions)


def test_a_slab_that_cannot_fill_its_crystal_is_refused():
    scene = gp.Scene(gp.Container((8.0,) * 3, "periodic"), [gp.Species(1, 0.5, arrangement="slab")])
    with pytest.raises(gp.SceneError, match="do not fill the crystal's half"):
        initial_state(scene, seed=1)


def test_random_particles_fill_the_space_between_a_lattice():
    electrons = gp.Species(200, 0.02, temperature=1.0)
    scatterers = gp.Species(160, 0.5, fixed=True, arrangement="lattice")
    scene = gp.Scene(gp.Container((40.0, 20.0), ("wall", "periodic")), [electrons, scatterers])
    state = initial_state(scene, seed=1)
    assert np.array_equal(state.positions, initial_state(scene, seed=1).positions)
    apart = np.abs(state.positions[:, None] - state.positions)
    apart[..., 1] = np.minimum(apart[..., 1], 20.0 - apart[..., 1])
    apart = np.linalg.norm(apart, axis=-1)
    np.fill_diagonal(apart, np.inf)
    assert closest(scene, state) >= 0.0
    nearest = apart[200:, 200:].min(axis=1)
    assert np.allclose(nearest, nearest[0]) and nearest[0] > 2.0  # all at one distance: a lattice


# The deepest overlap of particles of any sizes.


@given(st.integers(0, 10**6))
def test_the_deepest_overlap_is_that_of_all_pairs(seed):
    rng = np.random.default_rng(seed)
    count, d = rng.integers(1, 40), rng.integers(2, 4)
    lengths, periodic = rng.uniform(1.0, 6.0, d), rng.integers(0, 2, d).astype(bool)
    radii, places = 10.0 ** rng.uniform(-2.0, 0.2, count), rng.random((count, d)) * lengths
    gap = places[:, None] - places
    gap -= np.where(periodic, lengths * np.round(gap / lengths), 0.0)
    depth = 1.0 - np.sqrt((gap**2).sum(axis=2)) / (radii[:, None] + radii)
    np.fill_diagonal(depth, 0.0)
    own = 1.0 - np.where(periodic, lengths, np.inf).min() / (2.0 * radii.max())
    found = deepest_overlap(places, radii, lengths, tuple(periodic))
    assert found == pytest.approx(max(0.0, depth.max(), own), abs=1e-12)


def test_a_large_particle_does_not_make_all_small_ones_neighbours():
    rng = np.random.default_rng(4)
    places = rng.random((4000, 3)) * 30.0
    places = places[((places - 15.0) ** 2).sum(axis=1) > 9.0**2]
    places, radii = np.vstack([[[15.0] * 3], places]), np.append(8.0, np.full(len(places), 0.05))
    reached = []

    class Counted(np.ndarray):
        """Positions that tell how many pairs are looked at."""

        def __getitem__(self, key):
            found = super().__getitem__(key)
            reached.append(len(found))
            return found

    deepest_overlap(places.view(Counted), radii, np.full(3, 30.0), (False,) * 3)
    assert sum(reached) < 10 * len(places)


# Initial velocities of exactly the temperature that a scene states.


def scene(boundary="periodic", exact=True, count=50, **more):
    gas = gp.Species(count, 0.3, mass=2.0, temperature=1.7, exact_temperature=exact)
    return gp.Scene(gp.Container((12.0, 9.0, 15.0), boundary), [gas], **more)


@pytest.mark.parametrize("boundary", ["wall", "periodic"])
def test_gases_in_separate_regions_have_each_their_exact_temperature(boundary):
    """Regions may touch. Species that share a region share one factor."""
    regions = ((0.0, 0.0), (10.0, 10.0)), ((10.0, 0.0), (20.0, 10.0))
    species = [
        gp.Species(50, 0.3, temperature=t, mass=m, exact_temperature=True, region=region)
        for t, m, region in ((1.0, 1.0, regions[0]), (3.0, 2.0, regions[1]), (3.0, 0.5, regions[1]))
    ]
    made = initial_state(gp.Scene(gp.Container((20.0, 10.0), boundary), species), 1)
    scaled = (made.velocities**2).sum(axis=1) * made.masses / np.repeat((1.0, 3.0, 3.0), 50)
    left, right = scaled[:50].sum(), scaled[50:].sum()
    share = 2.0 * np.array([50.0, 125.0]) / 175.0 * (boundary == "periodic")
    assert [left, right] == pytest.approx([100.0 - share[0], 200.0 - share[1]], rel=1e-12)
    assert abs(scaled[50:100].sum() / 100.0 - 1.0) > 1e-3


@pytest.mark.parametrize(
    ("boundary", "axes"), [("periodic", 3), (("periodic", "wall", "periodic"), 2), ("wall", 0)]
)
def test_the_temperature_about_the_conserved_momentum_is_exact(boundary, axes):
    for seed in range(3):
        state = initial_state(scene(boundary), seed)
        assert 2.0 * state.kinetic_energy / (3 * 50 - axes) == pytest.approx(1.7, rel=1e-14)
        still = np.array(scene(boundary).container.periodic)
        assert np.abs(state.momentum[still]).max(initial=0.0) < 1e-12
        assert (np.abs(state.momentum[~still]) > 1e-3).all()


def test_without_the_key_velocities_are_as_drawn():
    drawn, exact = (initial_state(scene("wall", exact), 3).velocities for exact in (False, True))
    assert np.ptp(exact / drawn) < 1e-12 and abs((exact / drawn).mean() - 1.0) > 1e-4
    assert "exact_temperature" not in scene(exact=False).to_dict()["species"][0]
    assert gp.Scene.from_dict(scene().to_dict()) == scene()


def test_obstacles_and_friction_take_up_momentum():
    post = gp.Particle((6.0, 4.5, 7.0), (0.0, 0.0, 0.0), 0.5, fixed=True)
    plate = gp.Plate((1.0, 1.0, 1.0), ((2.0, 0.0, 0.0), (0.0, 2.0, 0.0)))
    rough, slit = gp.Restitution(tangential=1.0), ("periodic", "periodic", "wall")
    hot = {"z_low": gp.Thermal(1.0)}
    for boundary, more in (
        ("periodic", {"particles": [post]}),
        ("periodic", {"walls": [plate]}),
        (slit, {"restitution": rough}),
        (slit, {"faces": hot}),
    ):
        assert not any(scene(boundary, **more).conserved_axes)
        state = initial_state(scene(boundary, **more), 1)
        assert 2.0 * state.kinetic_energy == pytest.approx(1.7 * 150.0, rel=1e-14)
    assert all(scene(restitution=rough).conserved_axes)
    assert scene(slit, faces={"z_low": gp.Thermal(1.0, "normal")}).conserved_axes == (True, True, False)


def test_species_that_have_it_are_scaled_together():
    kinds = [
        gp.Species(20, 0.3, temperature=1.5, exact_temperature=True),
        gp.Species(10, 0.3, temperature=1.5),
        gp.Species(20, 0.3, mass=5.0, temperature=1.5, exact_temperature=True),
    ]
    drawn = [gp.Species(it.count, it.radius, mass=it.mass, temperature=1.5) for it in kinds]
    container = gp.Container((20.0, 20.0), "periodic")
    state, plain = (initial_state(gp.Scene(container, it), 1) for it in (kinds, drawn))
    chosen = np.r_[0:20, 30:50]
    energy = 0.5 * (state.masses[chosen, None] * state.velocities[chosen] ** 2).sum()
    assert 2.0 * energy / (2 * 40 - 2) == pytest.approx(1.5, rel=1e-14)
    assert (state.velocities[20:30] == plain.velocities[20:30]).all()


def test_what_has_no_temperature_is_refused():
    with pytest.raises(gp.SceneError, match="exact_temperature = True: needs the temperature of a species"):
        gp.Species(5, 0.5, speed=1.0, exact_temperature=True)
    with pytest.raises(gp.SceneError, match="exact_temperature = True: needs two particles or more"):
        initial_state(scene(count=1), 1)
    assert math.isfinite(initial_state(scene("wall", count=1), 1).kinetic_energy)
    resting = gp.Species(5, 0.5, temperature=0.0, exact_temperature=True)
    assert initial_state(gp.Scene(gp.Container((9.0, 9.0)), [resting]), 1).kinetic_energy == 0.0


@pytest.mark.parametrize("periodic", [True, False])
@pytest.mark.parametrize("width", [0.0, 1e-3])
def test_a_heap_of_particles_is_no_list_of_all_pairs(width, periodic):
    """20000 in one place have 2e8 pairs, of 3 GB; those of a file whose positions were never set are such."""
    rng = np.random.default_rng(5)
    positions = 5.0 + width * rng.random((20000, 3))
    tracemalloc.start()
    deepest = deepest_overlap(positions, np.full(20000, 0.5), np.full(3, 10.0), (periodic,) * 3)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 100e6
    assert deepest == 1.0 if width == 0.0 else 1.0 - 1e-4 < deepest < 1.0


@given(st.integers(0, 10**6), st.floats(1e-6, 0.3))
def test_the_deepest_overlap_in_a_heap_is_that_of_all_pairs(seed, width):
    rng = np.random.default_rng(seed)
    positions = 2.0 + width * rng.random((150, 3))
    radii = rng.uniform(0.3, 0.9, 150)
    apart = np.sqrt(((positions[:, None] - positions) ** 2).sum(axis=2))
    depth = 1.0 - apart / (radii[:, None] + radii)
    np.fill_diagonal(depth, 0.0)
    assert deepest_overlap(positions, radii, np.full(3, 4.0), (False,) * 3) == pytest.approx(depth.max())


@pytest.mark.parametrize(("x", "images"), [(5.0, 1), (0.2, 2), (9.8, 2)])
def test_a_wall_near_a_periodic_face_has_an_image_beyond_the_other(x, images):
    walls = [gp.Wall((x, 3.0), (x, 7.0))]
    container = gp.Container((10.0, 10.0), ("periodic", "wall"))
    rows, numbers = wall_rows(gp.Scene(container, [gp.Species(3, 0.5, temperature=1.0)], walls=walls))
    assert len(rows) == images and numbers.tolist() == [0] * images
