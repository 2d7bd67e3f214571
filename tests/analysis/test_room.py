"""Pressures and densities in containers whose faces move."""

import math

import numpy as np
import pytest

import gaspart as gp
from gaspart.analysis.flow import accessible_lengths, face_areas, sides
from gaspart.analysis.run import open_run

A = gp.analysis
GAS = [gp.Species(60, 0.1, temperature=1.0)]
TUBE = gp.Container((30.0, 8.0))


@pytest.fixture(scope="module")
def pushed(tmp_path_factory):
    """Small discs that a piston has pushed together, to about a half of the tube."""
    faces = {"x_high": gp.Piston(mass=20.0, pressure=2.0)}
    path = tmp_path_factory.mktemp("piston") / "run.nc"
    return gp.run(gp.Scene(TUBE, GAS, faces=faces), gp.EventDriven(), 1, 1200.0, 1.0, path)


def test_the_side_walls_under_a_piston_feel_its_pressure(pushed):
    """The force per area that centres touch is one, by Pascal: that on the sides, of which only a part is
    touched, too. The load, and the pressure across it, is that on 8.0, of which centres touch 7.8."""
    found = A.wall_pressure(pushed, start=300.0)
    with gp.open_trajectory(pushed) as data:
        length = float(data["piston_position"][300:].mean())
    assert length < 0.6 * 30.0
    exact = np.array([2.0, 2.0, 2.0 * 8.0 / 7.8, 2.0 * 8.0 / 7.8])
    assert (abs(found.estimate - exact) < 3.0 * found.error).all()
    assert (found.error < 0.1).all()


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
