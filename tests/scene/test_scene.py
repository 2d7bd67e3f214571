"""Scenes: invalid ones are refused in one line, and a file returns the scene that was written."""

import math
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import mixtures

import gaspart as gp
from gaspart.scene.boundaries import thermal_face

GOOD = {
    "container": {"lengths": [10.0, 10.0], "boundary": "wall"},
    "species": [{"count": 5, "radius": 0.5, "speed": 1.0}],
}


def changed(path, value):
    """GOOD with one entry replaced (a new key where it has none)."""
    scene = {"container": dict(GOOD["container"]), "species": [dict(GOOD["species"][0])]}
    *way, last = path
    target = scene
    for step in way:
        target = target[step]
    target[last] = value
    return scene


@pytest.mark.parametrize(
    ("path", "value", "key"),
    [
        (("colour",), "red", "colour"),
        (("species", 0, "mass"), -1.0, "species[0].mass"),
        (("species", 0, "radius"), "big", "species[0].radius"),
        (("species", 0, "count"), 2.5, "species[0].count"),
        (("species", 0, "count"), 200, "packing_fraction"),
        (("species", 0, "temperature"), 1.0, "species[0].temperature"),
        (("species", 0, "arrangement"), "neat", "species[0].arrangement"),
        (("species", 0, "region"), [[1.0, 1.0], [5.0]], "species[0].region[1]"),
        (("species", 0, "region"), [[1.0, 1.0], [5.0, 1.9]], "species[0].region"),
        (("container", "boundary"), "fog", "container.boundary"),
        (("centres_to_walls",), "yes", "centres_to_walls"),
        (("species",), {"count": 3}, "species"),
        (
            ("particles",),
            [{"position": [0.1, 5], "velocity": [0, 0], "radius": 0.5}],
            "particles[0].position",
        ),
        (
            ("particles",),
            [{"position": [5, y], "velocity": [0, 0], "radius": 0.5} for y in (5, 5.5)],
            "particles[1].position",
        ),
    ],
)
def test_one_line_names_file_key_and_value(path, value, key):
    with pytest.raises(gp.SceneError) as caught:
        gp.Scene.from_dict(changed(path, value), file="scene.yaml")
    message = str(caught.value)
    assert message.startswith(f"scene.yaml: {key} = ")
    assert "\n" not in message


@given(st.data())
def test_overlaps_are_those_that_a_search_of_all_pairs_finds(data):
    dimension = data.draw(st.sampled_from([2, 3]))
    lengths = data.draw(st.lists(st.floats(2.0, 9.0), min_size=dimension, max_size=dimension))
    boundary = data.draw(
        st.lists(st.sampled_from(["wall", "periodic"]), min_size=dimension, max_size=dimension)
    )
    container, particles = gp.Container(lengths, boundary), []
    for _ in range(data.draw(st.integers(2, 12))):
        radius = data.draw(st.floats(0.05, 0.6))
        at = tuple(radius + data.draw(st.floats(0.001, 0.999)) * (length - 2 * radius) for length in lengths)
        particles.append(gp.Particle(at, (0.0,) * dimension, radius))
    alone = gp.Scene(container)
    pairs = [
        (n, m)
        for n, one in enumerate(particles)
        for m, other in enumerate(particles[:n])
        if alone.separation(one.position, other.position) < one.radius + other.radius
    ]
    if pairs:
        with pytest.raises(gp.SceneError) as caught:
            gp.Scene(container, particles=particles)
        assert (caught.value.key, caught.value.rule) == (
            f"particles[{pairs[0][0]}].position",
            f"overlaps particles[{pairs[0][1]}]",
        )
    elif alone.container.volume > 60.0:
        assert gp.Scene(container, particles=particles).count == len(particles)


def test_many_single_particles_are_compared_with_their_neighbours_only():
    side = 100
    places = [(x + 0.5, y + 0.5) for x in range(side) for y in range(side)]
    particles = [gp.Particle(place, (0.0, 0.0), 0.4) for place in places]
    begun = time.process_time()
    gp.Scene(gp.Container((side, side)), particles=particles)
    assert time.process_time() - begun < 5.0  # all pairs take ten times as long


@given(mixtures())
def test_a_file_returns_the_scene(tmp_path_factory, scene):
    path = tmp_path_factory.mktemp("scene") / "scene.yaml"
    scene.to_file(path)
    assert gp.Scene.from_file(path) == scene


def test_derived_numbers():
    scene = gp.Scene.from_dict(GOOD)
    assert scene.count == 5
    assert scene.number_density == 0.05
    assert scene.packing_fraction == pytest.approx(5 * math.pi * 0.25 / 100)


ROOM = gp.Container((5.0, 5.0, 5.0), "wall")
FLAT = gp.Container((5.0, 5.0), "wall")
AROUND, HALF = gp.Container((5.0, 5.0), "periodic"), gp.Container((5.0, 5.0), ("wall", "periodic"))
SHEARED = {"y_high": gp.LeesEdwards(1.0)}
BALL = [gp.Species(1, 0.5, speed=1.0)]
HOLED = {"x_low": gp.Well(1.0, 2.0), "x_high": gp.Well(1.0, 2.0)}

FAST, WALL = {"y_high": gp.LeesEdwards(1e60)}, gp.Wall((1.0, 1.0), (2.0, 2.0))
FIXED, KICKS = gp.Species(1, 0.5, fixed=True), gp.Thermostat(1.0, 0.1)


@pytest.mark.parametrize(
    ("make", "complaint"),
    [
        (lambda: gp.Scene(ROOM, walls=[gp.Wall((1.0, 1.0), (2.0, 2.0))]), "a Wall needs a container of two"),
        (lambda: gp.Scene(FLAT, BALL, faces=HOLED), "faces.x_low.width = 2.0: leaves no room outside"),
        (lambda: gp.Scene(FLAT, faces={"y_low": HOLED["x_low"]}, gravity=(0.0, -1.0)), "without gravity"),
        (lambda: gp.Scene(FLAT, restitution=0.9), "restitution = 0.9: must be a Restitution"),
        (lambda: gp.Restitution(1.5), "normal = 1.5: must be from 0 to 1"),
        (lambda: gp.Restitution(1.0, -1.5), "tangential = -1.5: must be from -1 to 1"),
        (lambda: gp.Wall((1.0, 1.0), (1.0, 1.0)), "a wall must have a length"),
        (lambda: gp.Plate((1.0, 1.0, 1.0), ((1, 0, 0), (0, 0, 0))), "must have a length and a width"),
        (lambda: gp.Plate((1.0, 1.0, 1.0), ((1, 0, 0), (1, 1, 0))), "must be at right angles"),
        (lambda: gp.Particle((1.0, 1.0), (1.0, 0.0), 0.5, fixed=True), "must be zero for a fixed particle"),
        (lambda: gp.Particle((1.0, 1.0), (0.0, 0.0), 0.5, vibration=1.0), "requires fixed: true"),
        (lambda: gp.TimeStepped(0.1, skin=0.1, boxes_per_side=3), "skin = 0.1: excludes boxes_per_side"),
        (lambda: gp.TimeStepped(0.1, near_boxes=True), "needs boxes_per_side"),
        (lambda: gp.EventDriven("pairs", boxes_per_side=3), 'needs search "boxes"'),
        (lambda: thermal_face(gp.Scene(FLAT), "y_low"), "faces.y_low = None: must be thermal"),
        (
            lambda: gp.Scene(AROUND, faces={"x_high": SHEARED["y_high"]}),
            "x_high = .*: must be stated for y_high",
        ),
        (lambda: gp.Scene(HALF, faces=SHEARED), "y_high = .*: needs a container that is periodic"),
        (lambda: gp.Scene(AROUND, faces=FAST), "faces.y_high.shear_rate = .*: must be 0 or of a size"),
        (lambda: gp.Scene(AROUND, walls=[WALL], faces=SHEARED), "walls .*: the images of walls would slide"),
        (lambda: gp.Scene(AROUND, [FIXED], faces=SHEARED), "fixed .*: the images of fixed particles would"),
        (lambda: gp.Scene(AROUND, thermostat=KICKS, faces=SHEARED), "thermostat .*: kicks need faces"),
    ],
)
def test_a_mistake_in_python_is_refused_in_one_line_too(make, complaint):
    with pytest.raises(gp.SceneError, match=complaint) as caught:
        make()
    assert "\n" not in str(caught.value)


def test_the_mean_velocity_of_faces_is_that_of_all_that_drag():
    container = gp.Container((4.0, 4.0), ("wall", "periodic"))

    def mean(low, high):
        faces = {"x_low": low, "x_high": high}
        return gp.Scene(container, faces=faces).frame_velocity

    still, sliding = gp.Thermal(1.0), gp.Thermal(1.0, velocity=(0.0, 3.0))
    assert mean(still, sliding) == (0.0, 1.5)
    assert mean(gp.Thermal(1.0, "normal"), sliding) == (0.0, 3.0)
    assert mean(still, still) == (0.0, 0.0)
