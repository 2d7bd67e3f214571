import numpy as np
import pytest

import gaspart as gp
from gaspart.rendering.discs import Canvas
from gaspart.rendering.particles import colours_of, particles_of
from gaspart.rendering.pictures import render

BLACK = np.zeros((1, 3))


def state(positions, radii, lengths, velocities=None):
    """A state of particles at rest, or not."""
    bodies = [
        gp.Body(tuple(x), tuple(v), r)
        for x, r, v in zip(positions, radii, velocities or np.zeros_like(positions), strict=True)
    ]
    scene = gp.Scene(gp.Container(tuple(lengths)), bodies=bodies)
    return gp.Simulation(scene, gp.EventDriven(search="direct")).initial_state


@pytest.mark.parametrize("radius", [0.3, 1.0, 3.3])
def test_a_disc_covers_its_area(radius):
    canvas = Canvas(np.array([20.0, 10.0]), (400, 220))
    canvas.discs(np.array([[11.03, 4.7]]), np.array([radius]), BLACK)
    covered = (1.0 - canvas.image[..., 0]).sum()
    assert covered == pytest.approx(np.pi * (radius * canvas.scale) ** 2, rel=0.003)
    rows, columns = np.nonzero(canvas.image[..., 0] < 1.0)
    centre = canvas.corner + canvas.scale * np.array([11.03, 4.7])
    assert columns.mean() + 0.5 == pytest.approx(centre[0], abs=0.3)
    assert 220 - (rows.mean() + 0.5) == pytest.approx(centre[1], abs=0.3)


def test_later_discs_lie_over_earlier_ones_and_lines_over_discs():
    canvas = Canvas(np.array([10.0, 10.0]), (100, 100))
    canvas.discs(np.array([[5.0, 5.0], [5.0, 5.0]]), np.array([3.0, 2.0]), np.eye(3)[:2])
    assert canvas.image[50, 50].tolist() == [0.0, 1.0, 0.0]
    assert canvas.image[50, 26].tolist() == [1.0, 0.0, 0.0]
    canvas.line([[1.0, 5.0], [9.0, 5.0]], colour=(0.0, 0.0, 0.0))
    assert canvas.image[49:51, 50].max() < 0.3 and canvas.image[47, 50].tolist() == [0.0, 1.0, 0.0]
    before = canvas.image.copy()
    canvas.discs(np.array([[50.0, -50.0]]), np.array([2.0]), BLACK)  # outside
    canvas.line([[2.0, 2.0], [2.0, 2.0]])  # a point, for paths that stand still
    assert (canvas.image != before).any(axis=-1).sum() <= 9


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_picture_is_the_same_pixels_each_time(dimension):
    scene = gp.Scene(gp.Container((9.0,) * dimension), [gp.Species(30, 0.5, temperature=1.0)])
    shown = gp.Simulation(scene, gp.EventDriven(search="direct"), seed=3).initial_state
    image = render(shown, size=(80, 60))
    assert image.shape == (60, 80, 3) and image.dtype == np.uint8
    assert (image == render(shown, size=(80, 60))).all()
    assert (image != render(shown, size=(80, 60), colour="species")).any()
    assert len(np.unique(image.reshape(-1, 3), axis=0)) > 30


def test_colours():
    found = particles_of(state([[2.0, 2.0], [5.0, 5.0]], [1.0, 1.0], [8.0, 8.0], [(0.0, 0.0), (3.0, 4.0)]))
    assert found.speeds.tolist() == [0.0, 5.0]
    slow, fast = colours_of(found, "speed", fastest=5.0)
    assert slow.mean() < 0.3 < 0.5 < fast.mean()
    assert colours_of(found, "speed")[1].mean() < fast.mean()
    same = colours_of(found, "species")
    assert (same[0] == same[1]).all()
    assert (colours_of(found, np.eye(3)[:2]) == np.eye(3)[:2]).all()
    for wrong in ("heat", np.zeros((3, 3))):
        with pytest.raises(gp.SceneError, match="colour"):
            colours_of(found, wrong)


@pytest.mark.parametrize("size", [(0, 10), (100,), "100x100", (100, 10**6), (30.5, 40)])
def test_an_impossible_size_is_refused(size):
    with pytest.raises(gp.SceneError, match="size"):
        render(state([[2.0, 2.0]], [1.0], [8.0, 8.0]), size=size)
