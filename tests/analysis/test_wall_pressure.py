"""Pressures, forces and fluxes on faces where not all particles reach the same area, against exact values."""

import math

import numpy as np
import pytest

import gaspart as gp

STILL = (0.0, 0.0)


def run(scene, duration, interval, path, engine=None, seed=1):
    return gp.run(scene, engine or gp.EventDriven(), seed, duration, interval, path)


def agrees(value, error, exact):
    """|z| < 4, and an error that can tell the value from that of another area."""
    assert error < 0.03 * abs(exact)
    assert abs(value - exact) < 4.0 * error, (value, error, exact)


def test_a_fixed_disc_covers_part_of_the_face_that_it_is_near(tmp_path):
    """One disc of a billiard: the density of centres is even, and the pressure k_B T / A on each face."""
    gas = gp.Species(1, 0.1, speed=1.0)
    post = gp.Particle((2.2, 0.9), STILL, 0.8, fixed=True)
    scene = gp.Scene(gp.Container((5.0, 4.0)), [gas], particles=[post])
    path = run(scene, 60000.0, 20.0, tmp_path / "a.nc")
    covered = 2.0 * math.sqrt(0.9**2 - 0.8**2)
    found = gp.analysis.wall_pressure(path)
    force = gp.analysis.wall_force(path).estimate.values
    np.testing.assert_allclose(force / found.estimate.values, [3.8, 3.8, 4.8 - covered, 4.8], rtol=1e-12)
    exact = 0.5 / (4.8 * 3.8 - math.pi * 0.9**2)
    for value, error in zip(found.estimate.values, found.error.values, strict=True):
        agrees(value, error, exact)


def mixture_of_two():
    """Two discs in a box, of which each is a gas of one: exact by quadrature of the area where both fit."""
    species = [gp.Species(1, radius, speed=1.0, mass=mass) for radius, mass in ((0.5, 1.0), (0.2, 1.0))]
    return gp.Scene(gp.Container((3.0, 2.5)), species)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("engine", "speed"), [(gp.EventDriven(), 1.0), (gp.TimeStepped(0.005), 0.0), (gp.DSMC(0.02, (6, 5)), 1.0)]
)
def test_the_tally_per_area_is_that_of_the_size_that_hits(engine, speed):
    """The larger disc is too heavy to come to a face: all is over the area of the small ones, to rounding."""
    low = gp.Thermal(1.0, velocity=(0.0, speed)) if speed else gp.Thermal(1.0)
    scene = gp.Scene(
        gp.Container((6.0, 5.0)),
        [gp.Species(30, 0.1, temperature=1.0)],
        particles=[gp.Particle((3.0, 2.5), STILL, 0.12, mass=1e12)],
        faces={"x_low": low, "x_high": gp.Thermal(2.0)},
    )
    sim = gp.Simulation(scene, engine, 1)
    sim.advance(duration=30.0)
    tally, areas, faces = sim.tally, np.array([4.8, 4.8, 5.8, 5.8]), np.arange(4)
    normal = tally.momentum_per_area[faces, faces // 2]
    np.testing.assert_allclose(normal * areas, tally.wall_impulse, rtol=1e-9)
    np.testing.assert_allclose((tally.heat_per_area * areas)[:2], tally.wall_energy[:2], rtol=1e-9)
    if speed:
        shear = tally.momentum_per_area[:2, 1] * areas[:2]
        np.testing.assert_allclose(shear, tally.wall_shear[:2, 1], rtol=1e-9)


@pytest.mark.thorough
def test_heat_is_given_per_area_that_moving_particles_reach(tmp_path):
    post = gp.Particle((3.0, 3.0), STILL, 2.0, fixed=True)
    faces = {"x_low": gp.Thermal(1.0), "x_high": gp.Thermal(2.0)}
    scene = gp.Scene(
        gp.Container((6.0, 6.0)), [gp.Species(20, 0.05, temperature=1.0)], particles=[post], faces=faces
    )
    sim = gp.Simulation(scene, gp.EventDriven(), 1)
    sim.advance(duration=400.0)
    heat = gp.analysis.heat_flux(sim, start=0.0).estimate.values
    np.testing.assert_allclose(heat, sim.tally.wall_energy[:2] / (400.0 * 5.9), rtol=0.1)


@pytest.mark.interpreted
def test_a_file_without_the_tally_refuses_the_pressure_and_has_the_force(tmp_path):
    path = run(mixture_of_two(), 20.0, 0.5, tmp_path / "a.nc")
    with gp.open_trajectory(path) as data:
        lacking = data.drop_vars(["momentum_per_area", "heat_per_area"]).load()
    assert np.isfinite(gp.analysis.wall_force(lacking).estimate).all()
    with pytest.raises(gp.SceneError, match="make the run again, or measure force"):
        gp.analysis.wall_pressure(lacking)


@pytest.mark.interpreted
def test_sides_of_a_mixture_beside_a_wall_that_moves_have_a_force_only(tmp_path):
    species = [gp.Species(10, 0.3, temperature=1.0), gp.Species(10, 0.1, temperature=1.0)]
    faces = {"x_low": gp.Piston(mass=5.0, pressure=1.0)}
    path = run(gp.Scene(gp.Container((12.0, 3.0)), species, faces=faces), 40.0, 0.5, tmp_path / "a.nc")
    assert np.isnan(gp.analysis.wall_pressure(path).estimate.values).tolist() == [False, False, True, True]
    assert np.isfinite(gp.analysis.wall_force(path).estimate.values).all()


@pytest.mark.parametrize(("lengths", "count"), [((5.0, 12.0), 22), ((4.0, 7.0, 9.0), 60)])
def test_walls_at_different_distances_have_pressures_of_their_own(tmp_path, lengths, count):
    scene = gp.Scene(gp.Container(lengths), [gp.Species(count, 0.5, temperature=1.0, exact_temperature=True)])
    found = gp.analysis.wall_pressure(gp.run(scene, gp.EventDriven(), 5, 4000.0, 4.0, tmp_path / "a.nc"))
    assert np.unique(found.theory).size == len(lengths)
    assert (abs(found.deviation) < 4.0).all()
    narrow, wide = (found.estimate.values[ends].mean() for ends in (slice(0, 2), slice(-2, None)))
    error = math.hypot(*found.error.values[[0, 1, -2, -1]]) / 2.0
    assert wide - narrow > 6.0 * error  # edges and corners press less on walls that are close
