"""Accessible volumes and areas against closed forms."""

import math

import numpy as np
import pytest

import gaspart as gp
from gaspart.scene.accessible import Accessible

BOX, SQUARE = gp.Container((6.0, 6.0, 6.0)), gp.Container((6.0, 6.0))
STILL = {2: (0.0, 0.0), 3: (0.0, 0.0, 0.0)}
GAS = gp.Species(5, 0.3)


def post(position, radius):
    return gp.Particle(position, STILL[len(position)], radius, fixed=True)


def areas(scene, radius):
    return Accessible(scene).areas(np.array([radius]))[0]


def test_without_obstacles_it_is_that_of_the_box():
    found = Accessible(gp.Scene(BOX, [GAS]))
    assert found.volume(0.3) == (pytest.approx(5.4**3), 0.0)
    assert found.areas(np.array([0.3, 1.0])).tolist() == [
        [pytest.approx(5.4**2)] * 6,
        [pytest.approx(16.0)] * 6,
    ]
    centres = gp.Scene(BOX, [GAS], centres_to_walls=True)
    assert Accessible(centres).volume(0.3).value == pytest.approx(216.0)
    slit = gp.Scene(gp.Container((6.0, 6.0, 6.0), ("wall", "periodic", "periodic")), [GAS])
    assert areas(slit, 0.3).tolist() == [pytest.approx(36.0)] * 2 + [pytest.approx(5.4 * 6.0)] * 4


def test_a_disc_covers_a_chord_of_a_face_and_its_area():
    scene = gp.Scene(SQUARE, [GAS], particles=[post((3.0, 1.2), 1.0)])
    chord = 2.0 * math.sqrt(1.3**2 - 0.9**2)
    np.testing.assert_allclose(areas(scene, 0.3), [5.4, 5.4, 5.4 - chord, 5.4], rtol=1e-12)
    # a segment of the grown disc is beyond the line that centres reach
    angle = 2.0 * math.acos(0.9 / 1.3)
    beyond = 0.5 * 1.3**2 * (angle - math.sin(angle))
    value, error = Accessible(scene).volume(0.3)
    assert 0.0 < error < 1e-3
    assert abs(value - (5.4**2 - math.pi * 1.3**2 + beyond)) < 4.0 * error


def test_discs_that_overlap_count_once():
    scene = gp.Scene(SQUARE, [GAS], particles=[post((2.0, 3.0), 0.5), post((3.2, 3.0), 0.5)])
    lens = 2.0 * 0.8**2 * math.acos(0.75) - 0.6 * math.sqrt(4.0 * 0.8**2 - 1.2**2)
    value, error = Accessible(scene).volume(0.3)
    assert abs(value - (5.4**2 - 2.0 * math.pi * 0.8**2 + lens)) < max(4.0 * error, 1e-3)


def test_images_of_a_disc_cover_the_opposite_side():
    container = gp.Container((6.0, 6.0), ("periodic", "wall"))
    scene = gp.Scene(container, [GAS], particles=[post((0.2, 3.0), 1.0)])
    assert Accessible(scene).volume(0.3) == (pytest.approx(6.0 * 5.4 - math.pi * 1.3**2), 0.0)
    near = gp.Scene(container, [GAS], particles=[post((0.2, 1.1), 1.0)])
    chord = 2.0 * math.sqrt(1.3**2 - 0.8**2)
    np.testing.assert_allclose(areas(near, 0.3)[2:], [6.0 - chord, 6.0], rtol=1e-12)


def test_walls_cover_their_lengths_and_their_rounded_ends():
    wall = gp.Wall((1.0, 3.0), (4.0, 3.0))
    scene = gp.Scene(SQUARE, [GAS], walls=[wall])
    assert Accessible(scene).volume(0.3).value == pytest.approx(5.4**2 - 3.0 * 0.6 - math.pi * 0.09)
    upright = gp.Scene(SQUARE, [GAS], walls=[gp.Wall((0.0, 3.0), (6.0, 3.0))])
    np.testing.assert_allclose(areas(upright, 0.3), [4.8, 4.8, 5.4, 5.4], rtol=1e-12)
    slanted = gp.Scene(SQUARE, [GAS], walls=[gp.Wall((3.0, 0.0), (5.0, 2.0))])
    np.testing.assert_allclose(areas(slanted, 0.3)[2], 5.4 - 0.6 * math.sqrt(2.0), rtol=1e-12)


def test_a_plate_covers_its_parallel_body():
    plate = gp.Plate((1.0, 1.0, 3.0), ((3.0, 0.0, 0.0), (0.0, 3.0, 0.0)))
    covered = 9.0 * 0.6 + math.pi * 0.09 * 6.0 + 4.0 / 3.0 * math.pi * 0.027
    found = Accessible(gp.Scene(BOX, [GAS], walls=[plate]))
    assert found.volume(0.3) == (pytest.approx(5.4**3 - covered), 0.0)


@pytest.mark.parametrize("edges", [((2.0, 2.0, 0.0), (-1.0, 1.0, 0.0)), ((0.0, 2.0, 2.0), (2.0, 0.0, 0.0))])
def test_quadrature_agrees_with_the_closed_form_of_a_tilted_plate(edges, monkeypatch):
    plate = gp.Plate((2.5, 1.5, 2.0), edges)
    scene = gp.Scene(BOX, [GAS], walls=[plate])
    exact = Accessible(scene).volume(0.3).value
    monkeypatch.setattr("gaspart.scene.accessible._apart", lambda *given: None)
    value, error = Accessible(scene).volume(0.3)
    assert 0.0 < error < 0.02
    assert abs(value - exact) < 5.0 * error


def test_a_sphere_covers_a_disc_of_a_face():
    scene = gp.Scene(BOX, [GAS], particles=[post((3.0, 3.0, 1.2), 1.0)])
    exact = 5.4**2 - math.pi * (1.3**2 - 0.9**2)
    assert areas(scene, 0.3)[4] == pytest.approx(exact, abs=2e-3)
    assert areas(scene, 0.3)[5] == pytest.approx(5.4**2)


def test_fixed_species_are_known_of_a_run_only():
    scene = gp.Scene(SQUARE, [GAS, gp.Species(1, 0.5, fixed=True)])
    with pytest.raises(gp.SceneError, match="positions in a run only"):
        Accessible(scene)
    found = Accessible(scene, (np.array([[3.0, 3.0]]), np.array([0.5])))
    assert found.volume(0.3).value == pytest.approx(5.4**2 - math.pi * 0.64)
