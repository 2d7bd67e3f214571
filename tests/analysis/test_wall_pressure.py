"""Pressures, forces and fluxes on faces where not all particles reach the same area, against exact values."""

import math

import numpy as np
import pytest

import gaspart as gp

WALL = ("wall", "wall")
STILL = (0.0, 0.0)


def run(scene, duration, interval, path, engine=None, seed=1):
    return gp.run(scene, engine or gp.EventDriven(), seed, duration, interval, path)


def agrees(value, error, exact):
    """|z| < 4, and an error that can tell the value from that of another area."""
    assert error < 0.03 * abs(exact)
    assert abs(value - exact) < 4.0 * error, (value, error, exact)


def small_and(*particles):
    gas = gp.Species(200, 0.02, temperature=1.0, exact_temperature=True)
    return gp.Scene(gp.Container((10.0, 10.0)), [gas], particles=particles)


@pytest.mark.thorough
@pytest.mark.parametrize("fixed", [True, False])
def test_a_body_that_touches_no_face_leaves_the_pressure_of_an_ideal_gas(fixed, tmp_path):
    """n k_B T of the area that centres can reach, with the second virial coefficient of small discs, 0.6 %.
    The mobile disc is so heavy that it stays."""
    mass = 1.0 if fixed else 1e9
    scene = small_and(gp.Particle((5.0, 5.0), STILL, 2.0, mass=mass, fixed=fixed))
    path = run(scene, 150.0, 1.0, tmp_path / "a.nc")
    area = 9.96**2 - math.pi * 2.02**2
    density = 200.0 / area
    exact = density * (1.0 + 2.0 * math.pi * 0.02**2 * density)
    found = gp.analysis.wall_pressure(path)
    agrees(found.estimate.values.mean(), math.hypot(*found.error.values) / 4.0, exact)


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


def exact_pressures(sizes, lengths, number=400):
    """P / k_B T on the faces across x and y of two discs in a box: the sum over discs of the mean density of
    centres where they touch the face, from the areas in which the other one may be."""
    (r, s), contact = sizes, sum(sizes)

    def left(x, y, radius):
        """Area that is left to centres of the other disc, of this radius, when one is at (x, y)."""
        grid = (np.arange(number) + 0.5) / number
        u = radius + (lengths[0] - 2.0 * radius) * grid[:, None]
        half = np.sqrt(np.maximum(contact**2 - (u - x) ** 2, 0.0))
        low, high = radius, lengths[1] - radius
        covered = np.clip(y + half, low, high) - np.clip(y - half, low, high)
        return (high - low - covered).mean() * (lengths[0] - 2.0 * radius)

    grid = (np.arange(60) + 0.5) / 60
    inner = [[length - 2.0 * radius for length in lengths] for radius in sizes]
    whole = np.mean([[left(r + inner[0][0] * a, r + inner[0][1] * b, s) for b in grid] for a in grid])
    whole *= inner[0][0] * inner[0][1]
    found = np.zeros(2)
    for radius, other, sides in ((r, s, inner[0]), (s, r, inner[1])):
        along_y = [left(radius, radius + sides[1] * b, other) for b in grid]
        along_x = [left(radius + sides[0] * a, radius, other) for a in grid]
        found += np.array([np.mean(along_y), np.mean(along_x)]) / whole
    return found


@pytest.mark.thorough
def test_two_discs_of_two_sizes_press_as_the_contact_theorem_states(tmp_path):
    """k_B T is m <v^2> of a component, 2 E / 4 at fixed energy."""
    path = run(mixture_of_two(), 30000.0, 15.0, tmp_path / "a.nc")
    exact = 0.5 * np.repeat(exact_pressures((0.5, 0.2), (3.0, 2.5)), 2)
    found = gp.analysis.wall_pressure(path)
    for value, error, one in zip(found.estimate.values, found.error.values, exact, strict=True):
        agrees(value, error, one)


@pytest.mark.thorough
def test_a_mixture_of_points_presses_as_an_ideal_one(tmp_path):
    """Ideal mixtures: the sum over species of N k_B T over the volume that each can reach."""
    sizes = (0.03, 0.02)
    species = [gp.Species(40, r, temperature=1.0, exact_temperature=True) for r in sizes]
    scene = gp.Scene(gp.Container((4.0, 3.0)), species)
    exact = sum(40.0 / ((4.0 - 2.0 * r) * (3.0 - 2.0 * r)) for r in sizes)
    path = run(scene, 400.0, 1.0, tmp_path / "a.nc", gp.DSMC(0.025, (8, 6)))
    found = gp.analysis.wall_pressure(path)
    agrees(found.estimate.values.mean(), math.hypot(*found.error.values) / 4.0, exact)


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
def test_the_pressure_on_a_loaded_piston_is_its_load(tmp_path):
    faces = {"x_low": gp.Thermal(1.0), "x_high": gp.Piston(mass=5.0, pressure=1.0)}
    scene = gp.Scene(gp.Container((16.0, 3.0)), [gp.Species(10, 0.4, temperature=1.0)], faces=faces)
    found = gp.analysis.wall_pressure(run(scene, 2000.0, 1.0, tmp_path / "a.nc"))
    for face in ("x low", "x high"):
        one = found.sel(face=face)
        agrees(float(one.estimate), float(one.error), 1.0)
    assert float(found.estimate.sel(face="y low")) > 1.1  # over the length that centres reach


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


@pytest.mark.thorough
@pytest.mark.parametrize("interval", [0.02, 6.0])
def test_the_force_beside_a_well_does_not_depend_on_the_interval_between_frames(interval, tmp_path):
    """The edge of a well pulls at particles, so that the face gets impulses of both signs."""
    gas = gp.Species(20, 0.2, temperature=1.0)
    scene = gp.Scene(gp.Container((9.0, 9.0)), [gas], faces={"x_low": gp.Well(depth=2.0, width=0.5)})
    simulation = gp.Simulation(scene, seed=1)
    simulation.advance(96.0)
    found = gp.analysis.wall_force(run(scene, 96.0, interval, tmp_path / "a.nc"), start=0.0)
    np.testing.assert_allclose(found.estimate.values, simulation.tally.wall_impulse[:4] / 96.0, rtol=1e-12)


@pytest.mark.parametrize(("lengths", "count"), [((5.0, 12.0), 22), ((4.0, 7.0, 9.0), 60)])
def test_walls_at_different_distances_have_pressures_of_their_own(tmp_path, lengths, count):
    scene = gp.Scene(gp.Container(lengths), [gp.Species(count, 0.5, temperature=1.0, exact_temperature=True)])
    found = gp.analysis.wall_pressure(gp.run(scene, gp.EventDriven(), 5, 4000.0, 4.0, tmp_path / "a.nc"))
    assert np.unique(found.theory).size == len(lengths)
    assert (abs(found.deviation) < 4.0).all()
    narrow, wide = (found.estimate.values[ends].mean() for ends in (slice(0, 2), slice(-2, None)))
    error = math.hypot(*found.error.values[[0, 1, -2, -1]]) / 2.0
    assert wide - narrow > 6.0 * error  # edges and corners press less on walls that are close
