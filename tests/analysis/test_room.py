"""Areas and densities in containers whose faces move, and profiles beside obstacles."""

import math

import numpy as np
import pytest

import gaspart as gp
from gaspart.analysis.flow import accessible_lengths, face_areas, sides
from gaspart.analysis.run import open_run

GAS = [gp.Species(60, 0.1, temperature=1.0)]
TUBE = gp.Container((30.0, 8.0))


@pytest.fixture(scope="module")
def pushed(tmp_path_factory):
    """Small discs that a piston has pushed together, to about a half of the tube."""
    faces = {"x_high": gp.Piston(mass=20.0, pressure=2.0)}
    path = tmp_path_factory.mktemp("piston") / "run.nc"
    return gp.run(gp.Scene(TUBE, GAS, faces=faces), gp.EventDriven(), 1, 1200.0, 1.0, path)


@pytest.mark.thorough
def test_the_area_is_that_of_the_moment():
    """Of a floor that vibrates fast and one that rises: means by sums over many instants."""
    for face in (gp.Vibrating(1.0, 0.5), gp.Vibrating(2.0, 40.0, "sawtooth")):
        scene = gp.Scene(TUBE, GAS, faces={"y_low": face})
        sim = gp.Simulation(scene, gp.EventDriven(), 1)
        sim.advance(duration=20.0)
        with open_run(sim, 0.0) as run:
            fine = np.linspace(run.time[3], run.time[4], 20001)
            height = (accessible_lengths(run, fine)[:, 1]).mean()
            areas = face_areas(run)
        assert areas.shape == (len(run.time) - 1, 4)
        assert areas[3] == pytest.approx([height, height, 29.8, 29.8], rel=1e-3)


@pytest.mark.thorough
def test_faces_of_both_ends_and_two_axes_move_at_once():
    faces = {
        "x_low": gp.Vibrating(1.0, 2.0),
        "x_high": gp.Vibrating(0.5, 2.0),
        "y_high": gp.Vibrating(1.0, 2.0),
    }
    scene = gp.Scene(gp.Container((10.0, 10.0, 10.0)), GAS, faces=faces)
    sim = gp.Simulation(scene, gp.EventDriven(), 1)
    sim.advance(duration=4.0)
    with open_run(sim, 0.0) as run:
        found = sides(run, np.array([0.0, 1.0]))
        area = face_areas(run)[:, 4].mean()
    assert found[:, 0].tolist() == [[0.0, 10.0], [2.0, 9.0]]
    assert found[:, 1].tolist() == [[0.0, 10.0], [0.0, 8.0]]
    # (9.8 - 1.5 a) (9.8 - a) with a = 1 - cos, whose square has the mean 3 / 2
    assert area == pytest.approx(9.8**2 - 2.5 * 9.8 + 1.5 * 1.5, rel=1e-3)


@pytest.mark.thorough
def test_density_is_that_of_the_room_in_front_of_the_piston(pushed):
    """Beyond the piston there is nothing, and in a bin which it crosses only what it leaves counts."""
    found = A.profile(pushed, axis="x", bins=30, start=300.0)
    field = A.field(pushed, axes="x", cells=30, start=300.0)
    with gp.open_trajectory(pushed) as data:
        place = data["piston_position"][300:].values
    nearest, furthest = math.floor(place.min()), math.ceil(place.max())
    assert np.isnan(found.estimate[furthest:]).all()
    assert np.allclose(found.estimate, field.estimate, equal_nan=True)
    inner = found.estimate[2 : nearest - 1]
    crossed = found.estimate[nearest : max(nearest + 1, math.floor(place.mean()))]
    assert (abs(crossed / inner.mean() - 1.0) < 0.15).all()


# Observables beside fixed particles.


PERIODIC = gp.Container((6.0, 6.0), "periodic")
OBSTACLES_GAS = gp.Species(20, 0.15, temperature=1.0)
POSTS = [gp.Particle((x, y), (0.0, 0.0), 0.8, fixed=True) for x in (1.5, 4.5) for y in (1.5, 4.5)]


@pytest.mark.interpreted
def test_a_file_that_does_not_count_collisions_with_fixed_particles_apart_is_refused(tmp_path):
    path = gp.run(
        gp.Scene(PERIODIC, [OBSTACLES_GAS], POSTS), gp.EventDriven(), 1, 20.0, 0.5, tmp_path / "a.nc"
    )
    with gp.open_trajectory(path) as data:
        lacking = data.drop_vars("fixed_collisions").load()
    with pytest.raises(gp.SceneError, match="are not counted apart; make the run again"):
        gp.analysis.collision_rate(lacking)


# Profiles in scenes with obstacles: uniform where centres can be, as in an ideal gas.


A = gp.analysis


@pytest.mark.interpreted
def test_bins_inside_an_obstacle_are_empty_of_room():
    species = [gp.Species(20, 0.5, temperature=1.0), gp.Species(10, 1.0, temperature=1.0)]
    lid = gp.Particle((15.0, 15.0), (0.0, 0.0), 9.0, fixed=True)
    scene = gp.Scene(gp.Container((18.0, 30.0), ("periodic", "wall")), species, [lid])
    simulation = gp.Simulation(scene, gp.EventDriven(), seed=1)
    simulation.advance(duration=1.0)
    found = A.profile(simulation, bins=30)
    blocked = np.flatnonzero(np.isnan(found.estimate))
    assert len(blocked) and set(blocked) <= set(range(11, 19))


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
