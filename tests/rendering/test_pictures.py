from dataclasses import replace

import numpy as np
import pytest

import gaspart as gp
from gaspart.rendering.camera import camera_for
from gaspart.rendering.discs import Canvas
from gaspart.rendering.frames import parameters_of, particles_of, render
from gaspart.rendering.particles import FIXED, DrawnParticles, colours_of, legend_of
from gaspart.rendering.pictures import picture, pixels_per_length
from gaspart.rendering.surfaces import surfaces_of

BLACK = np.zeros((1, 3))


def state(positions, radii, lengths, velocities=None):
    """A state of particles at rest, or not."""
    particles = [
        gp.Particle(tuple(x), tuple(v), r)
        for x, r, v in zip(positions, radii, velocities or np.zeros_like(positions), strict=True)
    ]
    scene = gp.Scene(gp.Container(tuple(lengths)), particles=particles)
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


def test_a_path_is_dark_with_a_bright_border_on_any_disc():
    canvas = Canvas(np.array([10.0, 10.0]), (100, 100))
    canvas.discs(np.array([[5.0, 5.0]]), np.array([4.0]), np.full((1, 3), 0.5))
    canvas.path([[2.0, 5.0], [8.0, 5.0]])
    column = canvas.image[40:60, 50].mean(axis=1)  # from above to below
    assert column.min() < 0.25 and (column > 0.9).sum() >= 2
    dark, bright = np.flatnonzero(column < 0.25), np.flatnonzero(column > 0.9)
    assert np.ptp(dark) >= 2 and bright[0] < dark[0] and bright[-1] > dark[-1]


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_picture_is_the_same_pixels_each_time(dimension):
    scene = gp.Scene(gp.Container((9.0,) * dimension), [gp.Species(30, 0.5, temperature=1.0)])
    shown = gp.Simulation(scene, gp.EventDriven(search="direct"), seed=3).initial_state
    image = render(shown, size=(80, 60))
    assert image.shape == (60, 80, 3) and image.dtype == np.uint8
    assert (image == render(shown, size=(80, 60))).all()
    assert (image != render(shown, size=(80, 60), colour="species")).any()
    assert len(np.unique(image.reshape(-1, 3), axis=0)) > 30


@pytest.mark.interpreted
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


@pytest.mark.interpreted
@pytest.mark.parametrize("size", [(0, 10), (100,), "100x100", (100, 10**6), (30.5, 40)])
def test_an_impossible_size_is_refused(size):
    with pytest.raises(gp.SceneError, match="size"):
        render(state([[2.0, 2.0]], [1.0], [8.0, 8.0]), size=size)


@pytest.mark.interpreted
def test_a_disc_at_a_periodic_face_is_drawn_on_both_sides():
    particle = gp.Particle((0.5, 4.0), (0.0, 0.0), 1.0)
    white = np.zeros((1, 3))
    areas = []
    for boundary in ("wall", ("periodic", "wall")):
        scene = gp.Scene(gp.Container((16.0, 8.0), boundary), particles=[particle], centres_to_walls=True)
        simulation = gp.Simulation(scene, gp.EventDriven(search="direct"))
        image = render(simulation, size=(400, 100), colour=white)
        empty = render(gp.Simulation(gp.Scene(scene.container), gp.EventDriven()), size=(400, 100))
        areas.append(float((empty.astype(int) - image)[..., 0].sum()) / 255)
    # the whole disc, over the wall or in two parts; the dark lines of the faces hide a little of it
    assert areas[1] == pytest.approx(areas[0], rel=0.03)


@pytest.mark.interpreted
def test_nothing_is_drawn_beyond_a_periodic_face():
    scene = gp.Scene(gp.Container((12.0, 6.0), "periodic"), [gp.Species(20, 0.6, temperature=1.0)])
    image = render(gp.Simulation(scene, gp.EventDriven(search="direct")), size=(200, 104))
    inside = np.zeros(image.shape[:2], dtype=bool)
    inside[2:102, 1:199] = True  # the container, with its frame
    assert (image[~inside] == 255).all() and (image[inside] < 255).any()


@pytest.mark.interpreted
def test_fixed_particles_are_grey_among_those_coloured_by_speed():
    fixed = gp.Particle((2.0, 4.0), (0.0, 0.0), 1.0, fixed=True)
    scene = gp.Scene(gp.Container((16.0, 8.0)), particles=[fixed, gp.Particle((12.0, 4.0), (1.0, 0.0), 1.0)])
    image = render(gp.Simulation(scene, gp.EventDriven(search="direct")), size=(320, 160))
    at = image[80, 40], image[80, 240]
    assert tuple(at[0]) == tuple(round(255 * part) for part in FIXED) and np.ptp(at[1].astype(int)) > 30


def test_a_path_a_simulation_and_a_state_give_one_picture(tmp_path):
    scene = gp.Scene(gp.Container((9.0, 9.0), "periodic"), [gp.Species(20, 0.5, temperature=1.0)])
    gp.run(scene, gp.EventDriven("direct"), 3, 1.0, 0.5, tmp_path / "a.nc")
    simulation = gp.Simulation(scene, gp.EventDriven("direct"), seed=3)
    simulation.advance(duration=1.0)
    size = (80, 60)
    with gp.open_trajectory(tmp_path / "a.nc") as trajectory:
        image = render(trajectory, size=size)
    assert (image == render(tmp_path / "a.nc", size=size)).all()
    assert np.abs(image.astype(int) - render(simulation, size=size)).max() <= 1  # frames are in float32
    assert (render(simulation.state, size=size) != render(simulation, size=size)).any()  # has no images
    with pytest.raises(gp.SceneError, match="a film needs frames"):
        gp.film(simulation, tmp_path / "a.mp4")


@pytest.mark.thorough
def test_the_sides_of_plates_are_drawn():
    plate = gp.Plate((4.0, 1.0, 1.0), ((0.0, 6.0, 0.0), (0.0, 0.0, 6.0)))
    scene = gp.Scene(gp.Container((8.0, 8.0, 8.0)), walls=[plate])
    walls = particles_of(gp.Simulation(scene, gp.EventDriven())).walls
    assert walls.shape == (4, 2, 3) and (walls[:, 0] == np.roll(walls[:, 1], 1, axis=0)).all()
    assert sorted(np.linalg.norm(walls[:, 1] - walls[:, 0], axis=1)) == [6.0] * 4
    with_plate, without = (
        render(gp.Simulation(one, gp.EventDriven()), size=(200, 150)).astype(int)
        for one in (scene, gp.Scene(scene.container))
    )
    assert 200 < (with_plate != without).any(axis=-1).sum() < 3000


@pytest.mark.interpreted
def test_the_scale_of_speeds_is_written_beside_its_colours():
    shown = state([[4.0, 4.0]], [1.0], [8.0, 8.0], [(3.0, 4.0)])
    row = render(shown, size=(600, 400), clock=True)[11].astype(float) / 255.0
    ramp = legend_of(particles_of(shown), "speed").colours
    assert all(np.abs(row - colour).sum(axis=1).min() < 0.02 for colour in ramp)
    assert legend_of(particles_of(shown), "speed").texts == ("0", "10")
    assert legend_of(particles_of(shown), "speed", 3.0).texts == ("0", "3")
    assert legend_of(particles_of(shown), "species") is None  # of one species
    assert legend_of(particles_of(shown), np.zeros((1, 3))) is None


@pytest.mark.interpreted
@pytest.mark.parametrize("camera", [(298.0, 24.0), (0.0, 90.0), (45.0, 0.0)])
def test_the_bar_of_spheres_is_that_of_the_middle_of_the_container(camera):
    lengths, size = np.array([8.0, 6.0, 5.0]), (400, 300)
    view = camera_for(lengths, *size, camera)
    away = 0.5 * lengths + 0.01 * np.array([view.right, np.zeros(3)]) - view.eye
    columns = 0.5 * size[0] * (away @ view.right) / (away @ view.forward) / view.half_width
    shown = particles_of(state([[4.0, 3.0, 2.0]], [1.0], lengths))
    assert pixels_per_length(shown, size, camera) == pytest.approx((columns[0] - columns[1]) / 0.01)


@pytest.mark.parametrize("corner", [[0.0, 0.0, 0.0], [8.0, 0.0, 8.0], [8.0, 8.0, 8.0], [0.0, 8.0, 0.0]])
def test_a_sphere_that_reaches_out_of_the_container_is_completely_in_the_picture(corner):
    radii, none = np.array([2.0, 1.0]), np.zeros(2, dtype=int)
    one = DrawnParticles(
        np.array([corner, [4.0] * 3]), radii, none, none, np.full(3, 8.0), np.zeros((0, 2, 3))
    )
    assert one.reach == 2.0
    image = picture(one, (120, 120), np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])).astype(int)
    red = image[..., 0] - image[..., 1] > 60
    assert red.sum() > 100
    assert not (red[0].any() or red[-1].any() or red[:, 0].any() or red[:, -1].any())


def test_spheres_are_seen_from_the_direction_of_the_camera():
    """From above, x to the right: the upper of two spheres hides the lower one."""
    one = state([[4.0, 4.0, 1.0], [4.0, 4.0, 7.0]], [1.0, 1.0], [8.0] * 3)
    colours = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    above = render(one, size=(80, 60), colour=colours, camera=(270.0, 90.0)).astype(int)
    aside = render(one, size=(80, 60), colour=colours, camera=(270.0, 0.0)).astype(int)
    red = [(image[..., 0] - image[..., 2] > 80).sum() for image in (above, aside)]
    assert red[0] == 0 and red[1] > 50


@pytest.mark.interpreted
def test_a_piston_is_drawn_where_it_is(tmp_path):
    """It falls freely: no particle is in its way."""
    for lengths, sides in (((8.0, 6.0), 1), ((8.0, 6.0, 7.0), 4)):
        container = gp.Container(lengths, ("periodic", "wall", "wall")[: len(lengths)])
        particle = gp.Particle((1.0,) * len(lengths), (0.0,) * len(lengths), 0.5)
        push = lengths[0] * (1.0 if sides == 1 else 7.0) / 56.0
        scene = gp.Scene(container, particles=[particle], faces={"y_high": gp.Piston(56.0, 1.0)})
        path = gp.run(scene, gp.EventDriven(), 0, 2.0, 2.0, tmp_path / f"{sides}.nc")
        sim = gp.Simulation(scene, gp.EventDriven())
        sim.advance(until=2.0)
        with gp.open_trajectory(path) as run:
            for walls in (particles_of(sim).walls, particles_of(run).walls):
                assert walls.shape == (sides, 2, len(lengths))
                assert np.allclose(walls[..., 1], 6.0 - 0.5 * push * 4.0)
                assert np.ptp(walls[..., 0]) == 8.0


@pytest.mark.thorough
@pytest.mark.interpreted
def test_an_interior_wall_that_moves_is_drawn_where_it_is(tmp_path):
    """A particle at speed 1 pushes one of its own mass, which rests between it and another."""
    for lengths, sides in (((8.0, 6.0), 1), ((8.0, 6.0, 7.0), 4)):
        container = gp.Container(lengths, ("wall", "periodic", "periodic")[: len(lengths)])
        near, far = (3.0, 1.0, 1.0)[: len(lengths)], (7.0, 1.0, 1.0)[: len(lengths)]
        speed = (1.0, 0.0, 0.0)[: len(lengths)]
        particles = [gp.Particle(near, speed, 0.5), gp.Particle(far, (0.0,) * len(lengths), 0.5)]
        wall = gp.Wall((4.0, 0.0), (4.0, 6.0), mass=1.0)
        if sides == 4:
            wall = gp.Plate((4.0, 0.0, 0.0), ((0.0, 6.0, 0.0), (0.0, 0.0, 7.0)), mass=1.0)
        scene = gp.Scene(container, particles=particles, walls=[wall])
        assert np.allclose(particles_of(scene).walls[..., 0], 4.0)
        path = gp.run(scene, gp.EventDriven(), 0, 2.0, 2.0, tmp_path / f"{sides}.nc")
        with gp.open_trajectory(path) as run:
            walls = particles_of(run).walls
            assert walls.shape == (sides, 2, len(lengths))
            assert np.allclose(walls[..., 0], 5.5)
            assert np.ptp(walls[..., 1]) == 6.0
            (surface,) = particles_of(run).surfaces
            assert surface.text == "wall: mass 1, moves freely" and np.allclose(surface.ends[:, 0], 5.5)


def test_moving_faces_are_in_the_legend_not_among_the_parameters():
    scene = gp.Scene(gp.Container((8.0, 8.0)), [gp.Species(10, 0.3)])
    assert parameters_of(scene) == ("10 discs", "packing fraction 0.0442")
    shaken = replace(scene, faces={"y_low": gp.Vibrating(0.1, 2.0)})
    assert parameters_of(shaken) == ("10 discs", "packing fraction 0.0442")
    assert [one.text for one in surfaces_of(shaken)] == ["y low: vibrates, amplitude 0.1, period 2"]
    pressed = replace(scene, faces={"y_high": gp.Piston(20.0, 0.5)})
    assert parameters_of(pressed) == ("10 discs",)
    assert [one.text for one in surfaces_of(pressed)] == ["y high: piston, mass 20, pressure 0.5"]
