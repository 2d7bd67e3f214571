"""The same bits for any number of threads, sampling and restart; conservation laws of random scenes."""

import math

import numpy as np
import pytest
from engines.dsmc.steps import advanced
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import gas

import gaspart as gp
from gaspart.engines.dsmc import arrays


@st.composite
def scenes(draw):
    """Scenes of two kinds, so that few kernels are compiled: rough discs that fall between thermal faces, and
    elastic spheres of one or two species between walls or none."""
    dimension = draw(st.sampled_from([2, 3]))
    lengths = draw(st.lists(st.floats(4.0, 9.0), min_size=dimension, max_size=dimension))
    boundary = draw(st.lists(st.sampled_from(["wall", "periodic"]), min_size=dimension, max_size=dimension))
    radii, masses = st.floats(0.01, 0.1), st.sampled_from([1.0, 0.1])
    kinds = st.builds(gp.Species, st.integers(1, 60), radii, mass=masses, temperature=st.just(1.0))
    species = draw(st.lists(kinds, min_size=1, max_size=2))
    if dimension == 3:
        return gp.Scene(gp.Container(lengths, boundary), species)
    boundary[1] = "wall"
    law = gp.Restitution(draw(st.sampled_from([1.0, 0.8])), draw(st.sampled_from([-0.5, 0.5, 1.0])))
    faces = {"y_low": gp.Thermal(draw(st.floats(0.2, 5.0)), draw(st.sampled_from(["all", "normal"])))}
    container = gp.Container(lengths, boundary)
    return gp.Scene(container, species, faces=faces, gravity=(0.0, -0.3), restitution=law)


def drawn(scene, model, seed):
    """A simulation, or None if the sizes of the particles are too different."""
    try:
        return gp.Simulation(scene, gp.DSMC(time_step=0.1, model=model), seed)
    except gp.SceneError as error:
        assert error.key == "radius"
        return None


@pytest.mark.thorough
@settings(max_examples=settings.default.max_examples // 2)
@given(scenes(), st.sampled_from(["boltzmann", "enskog"]), st.integers(0, 2**32))
@pytest.mark.filterwarnings("ignore:gaspart")
def test_random_scenes_keep_what_is_conserved(scene, model, seed):
    sim = drawn(scene, model, seed)
    if sim is None:
        return
    before = sim.state
    sim.advance(duration=5.0)
    sim.check_invariants()
    after, tally = sim.state, sim.tally
    assert sim._dynamics._workspace.counts[0, 2] == 0  # chances above 1
    periodic = np.array(scene.container.periodic)
    low, high = scene.reach(scene.smallest_radius)
    assert (after.positions >= np.array(low) - 1e-12).all()
    assert (after.positions <= np.array(high) + 1e-12).all()
    scale = float(np.abs(after.masses[:, None] * after.velocities).sum()) + 1.0
    given_to = tally.wall_impulse.reshape(-1, 2)
    change = after.momentum - before.momentum
    for k in range(scene.dimension):
        pull = 0.0 if scene.gravity is None else scene.gravity[k] * after.masses.sum() * sim.time
        if not (scene.gravity and k == 0) and not (scene.rough and not periodic.all()):
            assert change[k] == pytest.approx(given_to[k, 0] - given_to[k, 1] + pull, abs=1e-9 * scale)
    if scene.dimension == 3:
        assert after.kinetic_energy == pytest.approx(before.kinetic_energy, rel=1e-12)
    if periodic.all():
        assert np.allclose(change, 0.0, atol=1e-12 * scale)


DENSE = {"model": "enskog", "cells_per_side": (16, 2, 2)}
"""Cells in slabs, between which collisions pass."""


@pytest.mark.thorough
@pytest.mark.parametrize("boundary", ["periodic", "wall"])
@pytest.mark.filterwarnings("ignore:gaspart")
def test_threads_share_the_slabs_of_a_dense_gas(boundary):
    """With the bits of one thread, and as many collisions as cell after cell gives, none beyond its bound."""
    ends = []
    for threads in (1, 2, 3):
        sim = advanced(gas(3, 3000, 0.1, boundary), 40, threads=threads, **DENSE)
        assert len(sim._dynamics._resolution.dense.slabs) > 4
        assert sim._dynamics._workspace.counts[:, 2].sum() == 0
        ends.append((sim.state.unwrapped, sim.state.velocities, str(sim.tally)))
    for positions, velocities, tally in ends[1:]:
        assert np.array_equal(positions, ends[0][0]) and np.array_equal(velocities, ends[0][1])
        assert tally == ends[0][2]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(arrays, "_FEWEST_CELLS", 10**9)
        other = advanced(gas(3, 3000, 0.1, boundary), 40, **DENSE)
    assert len(other._dynamics._resolution.dense.slabs) == 2
    met, expected = sim.tally.collisions, other.tally.collisions
    assert met > 1000 and abs(met - expected) < 4.0 * math.sqrt(met + expected)


@pytest.mark.interpreted
def test_slabs_are_two_reaches_wide_and_even_in_number():
    for cells in ((64, 1, 1), (9, 30, 7), (13, 13), (1000, 3)):
        for reach in (1, 2, 3):
            axis, edges = arrays.slabs_of(np.array(cells), np.full(len(cells), reach))
            assert edges[0] == 0 and edges[-1] == cells[axis]
            number = len(edges) - 1
            assert number == 1 or (number % 2 == 0 and np.diff(edges).min() >= 2 * reach)
    assert len(arrays.slabs_of(np.array([16, 1, 1]), np.ones(3, np.int64))[1]) == 2  # too few cells
    assert len(arrays.slabs_of(np.array([25, 25, 25]), np.ones(3, np.int64))[1]) == 13
