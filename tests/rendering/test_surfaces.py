"""Each kind of surface has a look of its own, and a line in the legend."""

import dataclasses

import numpy as np
import pytest

import gaspart as gp
from gaspart.rendering.particles import Labels
from gaspart.rendering.surfaces import INK, arrow_lines, colour_of, surfaces_of

LENGTHS = (20.0, 10.0)


def scene(faces=None, walls=(), **more):
    return gp.Scene(
        container=gp.Container(lengths=LENGTHS),
        species=[gp.Species(count=5, radius=0.3, temperature=1.0)],
        faces=faces or {},
        walls=walls,
        **more,
    )


KINDS = {
    "open, activity 0.1": gp.Open(activity=0.1, temperature=1.0),
    "T = 2": gp.Thermal(temperature=2.0),
    "T = 1 to 4": gp.Thermal(temperature={"y_low": 1.0, "y_high": 4.0}),
    "T = 2, accommodation 0.5": gp.Thermal(temperature=2.0, accommodation=0.5),
    "T = 2, slides at 3": gp.Thermal(temperature=2.0, velocity=(0.0, 3.0)),
    "piston, speed 0.5": gp.Piston(speed=0.5),
    "vibrates, amplitude 0.5, period 2": gp.Vibrating(amplitude=0.5, period=2.0),
    "sticky below momentum 0.7": gp.Sticky(momentum=0.7),
    "well of depth 2": gp.Well(depth=2.0, width=0.5),
}


@pytest.mark.parametrize("text", KINDS)
def test_each_kind_has_a_line_in_the_legend(text):
    made = scene({"x_low": KINDS[text]}, centres_to_walls=text.startswith("open"))
    (surface,) = surfaces_of(made)
    assert surface.text == f"x low: {text}"
    assert surface.ends[:, 0].tolist() == [0.0, 0.0] and surface.inward.tolist() == [1.0, 0.0]


def test_no_two_kinds_look_alike():
    def look(text):
        made = scene({"x_low": KINDS[text]}, centres_to_walls=text.startswith("open"))
        return gp.render(made, size=(320, 160), colour=np.ones((5, 3))).tobytes()

    assert len({look(text) for text in KINDS} | {look_of_a_hard_wall()}) == len(KINDS) + 1


def look_of_a_hard_wall():
    return gp.render(scene(), size=(320, 160), colour=np.ones((5, 3))).tobytes()


def test_cold_is_blue_and_hot_is_red():
    made = scene({"x_low": gp.Thermal(temperature=1.0), "x_high": gp.Thermal(temperature=3.0)})
    cold, hot = (colour_of(one, made) for one in (1.0, 3.0))
    assert cold[2] > cold[0] and hot[0] > hot[2]
    assert colour_of(2.0, made) == pytest.approx(0.5 * (np.array(cold) + hot))


def test_a_piston_is_drawn_where_it_is_with_the_container_shaded_behind():
    made = scene({"x_high": gp.Piston(speed=1.0)})
    simulation = gp.Simulation(made, seed=1)
    (surface,) = surfaces_of(made, 2.0, 18.0)
    assert surface.ends[:, 0].tolist() == [18.0, 18.0] and surface.depth == 2.0
    assert surface.motion.tolist() == [-1.0, 0.0] and surface.hatched
    assert simulation.scene is made


SPANNING = gp.Wall(start=(5.0, 0.0), end=(5.0, 10.0), mass=4.0)


def test_a_wall_between_two_gases_is_drawn_where_it_is_with_an_arrow_both_ways():
    gases = [
        gp.Species(count=2, radius=0.3, temperature=1.0, region=((x, 0.0), (x + 5.0, 10.0)))
        for x in (0.0, 5.0)
    ]
    made = gp.Scene(gp.Container(LENGTHS), gases, walls=[SPANNING])
    (at_start,), (later,) = surfaces_of(made), surfaces_of(made, 2.0, 8.0)
    assert at_start.text == later.text == "wall: mass 4, moves freely"
    assert at_start.ends[:, 0].tolist() == [5.0, 5.0] and later.ends[:, 0].tolist() == [8.0, 8.0]
    assert later.motion.tolist() == [1.0, 0.0] and later.to_and_fro and later.hatched
    pictures = [gp.render(each, size=(320, 160), colour=np.ones((4, 3))) for each in (made, at_rest(made))]
    beside = np.abs(pictures[0].astype(int) - pictures[1])[:, :, 0] > 100
    columns = np.flatnonzero(beside.any(axis=0))
    wall = np.interp(5.0, [0.0, 20.0], [10.0, 310.0])  # in pixels: about, by the margins
    assert columns.min() < wall - 10 and columns.max() > wall + 10, "hatching and arrow on both sides"


def at_rest(made):
    """The scene whose wall has no mass, in a frame with the particles at the same positions."""
    return dataclasses.replace(made, walls=[gp.Wall(start=SPANNING.start, end=SPANNING.end)])


@pytest.mark.parametrize(("rate", "along"), [(0.2, 1.0), (-0.2, -1.0)])
def test_images_that_slide_have_arrows_along_the_flow(rate, along):
    around = gp.Container(LENGTHS, boundary="periodic")
    gas = gp.Species(count=5, radius=0.3, temperature=1.0)
    made = gp.Scene(around, [gas], faces={"y_high": gp.LeesEdwards(shear_rate=rate)})
    high, low = surfaces_of(made)
    assert [high.text, low.text] == [
        f"y high: images above slide at {10.0 * rate:g}",
        f"y low: images below slide at {-10.0 * rate:g}",
    ]
    assert high.motion.tolist() == [along, 0.0] and low.motion.tolist() == [-along, 0.0]
    assert high.ends[:, 1].tolist() == [10.0, 10.0] and low.ends[:, 1].tolist() == [0.0, 0.0]
    assert high.dashed and not high.hatched  # no solid wall
    sheared, still = (
        gp.render(each, size=(320, 160), colour=np.ones((5, 3))).astype(int)
        for each in (made, gp.Scene(around, [gas]))
    )
    upper, lower = (
        np.flatnonzero(np.abs(sheared - still)[rows].any(axis=(0, 2)))
        for rows in (slice(0, 40), slice(120, 160))
    )
    assert len(upper) and len(lower)
    stopped = gp.Scene(around, [gas], faces={"y_high": gp.LeesEdwards(shear_rate=0.0)})
    assert [surface.motion for surface in surfaces_of(stopped)] == [None, None]


def test_arrows_have_heads_where_they_point():
    tail, head = np.array([0.0, 0.0]), np.array([8.0, 0.0])
    shaft, *barbs = arrow_lines(tail, head, two_heads=False)
    assert shaft.tolist() == [[0.0, 0.0], [8.0, 0.0]]
    assert [barb.tolist() for barb in barbs] == [[[6.0, 1.2], [8.0, 0.0]], [[6.0, -1.2], [8.0, 0.0]]]
    tips = [barb[1].tolist() for barb in arrow_lines(tail, head, two_heads=True)[1:]]
    assert tips == [[8.0, 0.0], [8.0, 0.0], [0.0, 0.0], [0.0, 0.0]]


def test_spheres_between_sliding_walls_have_arrows():
    container = gp.Container(lengths=(4.0, 4.0, 4.0), boundary=("periodic", "wall", "periodic"))
    gas = [gp.Species(count=3, radius=0.3, temperature=1.0)]
    slides, rests = (
        gp.render(gp.Scene(container, gas, faces={"y_low": face}), size=(320, 240)).astype(int)
        for face in (gp.Thermal(1.0, velocity=(1.0, 0.0, 0.0)), gp.Thermal(1.0))
    )
    changed = (np.abs(slides - rests).sum(axis=2) > 60).sum()
    assert 60 < changed < 1500


def test_a_warm_wall_has_the_colour_of_its_temperature():
    wall = gp.Wall(start=(5.0, 2.0), end=(8.0, 6.0), temperature=2.0)
    made = scene({"x_low": gp.Thermal(temperature=1.0)}, walls=[wall])
    *_, drawn = surfaces_of(made)
    assert drawn.text == "wall: T = 2" and drawn.ends.tolist() == [[5.0, 2.0], [8.0, 6.0]]
    assert tuple(drawn.colours[0]) == colour_of(2.0, made) != INK


def test_a_legend_names_each_surface_of_a_picture():
    faces = {name: gp.Thermal(temperature=n + 1.0) for n, name in enumerate(("x_low", "x_high", "y_low"))}
    rows = Labels((400, 300), (), None, surfaces_of(scene(faces))).rows
    assert [[one.text for one in row] for row in rows] == [["x low: T = 1", "x high: T = 2", "y low: T = 3"]]
    narrow = Labels((170, 300), (), None, surfaces_of(scene(faces)))
    assert len(narrow.rows) > 1 and narrow.inner[1] < Labels((170, 300)).inner[1]
    assert not Labels((170, 40), (), None, surfaces_of(scene(faces))).rows  # they would leave too little
