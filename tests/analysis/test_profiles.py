"""Profiles in scenes with obstacles: uniform where centres can be, as in an ideal gas."""

import math

import numpy as np
import pytest

import gaspart as gp

A = gp.analysis


@pytest.mark.parametrize(
    ("side", "dimension", "count", "reach"), [(20.0, 2, 40, 4.0), (20.0, 3, 200, 6.0), (20.0, 2, 40, 9.0)]
)
def test_an_obstacle_is_not_counted_and_takes_its_volume(side, dimension, count, reach):
    place = (3.0, 10.0, 5.0)[:dimension]  # across a periodic face
    post = gp.Particle(place, (0.0,) * dimension, reach - 0.05, fixed=True)
    gas = gp.Species(count, 0.05, temperature=1.0)
    scene = gp.Scene(gp.Container((side,) * dimension, "periodic"), [gas], [post])
    simulation = gp.Simulation(scene, gp.EventDriven(), seed=1)
    simulation.advance(duration=700.0)
    excluded = math.pi * reach**2 if dimension == 2 else 4.0 / 3.0 * math.pi * reach**3
    found = A.profile(simulation, axis="x", bins=10)
    apart = (found.estimate - count / (side**dimension - excluded)) / found.error
    assert float((apart**2).mean()) < 1.0 + 3.0 * math.sqrt(2.0 / 10.0) + 2.0 / 15.0
    assert found.theory is None


def test_bins_inside_an_obstacle_are_empty_of_room():
    species = [gp.Species(20, 0.5, temperature=1.0), gp.Species(10, 1.0, temperature=1.0)]
    lid = gp.Particle((15.0, 15.0), (0.0, 0.0), 9.0, fixed=True)
    scene = gp.Scene(gp.Container((18.0, 30.0), ("periodic", "wall")), species, [lid])
    simulation = gp.Simulation(scene, gp.EventDriven(), seed=1)
    simulation.advance(duration=10.0)
    found = A.profile(simulation, bins=30)
    blocked = np.flatnonzero(np.isnan(found.estimate))
    assert len(blocked) and set(blocked) <= set(range(11, 19))


def test_without_obstacles_the_sum_is_the_number_of_particles():
    species = [gp.Species(20, 0.5, temperature=1.0), gp.Species(10, 1.0, temperature=1.0)]
    simulation = gp.Simulation(gp.Scene(gp.Container((20.0, 20.0)), species), gp.EventDriven(), seed=1)
    simulation.advance(duration=10.0)
    assert float(A.profile(simulation, bins=20).estimate.sum()) * 20.0 == pytest.approx(30.0)


def test_some_particles_of_one_kind_stand_for_all(tmp_path):
    scene = gp.Scene(gp.Container((20.0, 20.0), "periodic"), [gp.Species(50, 0.5, temperature=1.0)])
    path = gp.run(scene, gp.EventDriven(), 1, 20.0, 0.5, tmp_path / "a.nc", follow=10)
    found = A.profile(path, bins=5)
    assert float(found.estimate.mean()) * 400.0 == pytest.approx(50.0)
    assert float(found.theory[0]) == pytest.approx(50.0 / 400.0)


def test_what_one_particle_brings_along_has_no_error():
    """Its velocity is the same in all cells that it passes: nothing is known of the scatter of others."""
    ends = (gp.Particle((x, 2.0, 2.0), (v, 0.0, 0.0), 0.5) for x, v in ((1.0, 0.5), (9.0, -0.25)))
    scene = gp.Scene(gp.Container((10.0, 4.0, 4.0), "wall"), particles=list(ends))
    simulation = gp.Simulation(scene, gp.EventDriven(), 1)
    simulation.advance(until=4.0)
    found = gp.analysis.velocity_profile(simulation, "x", bins=10, start=0.0)
    passed = found.estimate.sel(component="x").notnull()
    assert int(passed.sum()) > 4 and np.isnan(found.error.sel(component="x").values).all()
    assert not (found["velocity_freedom"].sel(component="x").where(passed) > 0.0).any()
    rest = gp.Scene(scene.container, [gp.Species(3, 0.5, speed=0.0)])
    simulation = gp.Simulation(rest, gp.EventDriven(), 1)
    simulation.advance(until=4.0)
    density = gp.analysis.profile(simulation, "density", "x", bins=4, start=0.0)
    assert (density.error.where(density.estimate > 0.0, 0.0) == 0.0).all()
