"""The partition: every close pair is in boxes that the table calls neighbours."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart.state.boxes import NOWHERE, boxes_and_largest, make_boxes, sides_for


def neighbours(boxes, at):
    """The (box, shift) that the tables name around a box."""
    found = []
    for steps in itertools.product(range(3), repeat=3):
        parts = [boxes.neighbour[k, at[k], steps[k]] for k in range(3)]
        if NOWHERE not in parts:
            found.append((sum(parts), tuple(boxes.shift[k, at[k], steps[k]] for k in range(3))))
    return found


@pytest.mark.parametrize("boundary", [("wall", "wall"), ("periodic", "periodic"), ("wall", "periodic")])
@pytest.mark.parametrize("per_side", [1, 2, 3, (4, 1), (2, 5)])
@pytest.mark.parametrize("images", [True, False])
def test_neighbours_are_those_within_one_box(boundary, per_side, images):
    lengths = (10.0, 7.0)
    scene = gp.Scene(gp.Container(lengths, boundary), [gp.Species(3, 0.5, speed=1.0)])
    boxes = make_boxes(scene, per_side, images)
    n = boxes.per_side
    for x, y in itertools.product(range(n[0]), range(n[1])):
        expected = set()
        for dx, dy in itertools.product((-1, 0, 1), repeat=2):
            images_x, to_x = divmod(x + dx, n[0])
            images_y, to_y = divmod(y + dy, n[1])
            if (images_x and boundary[0] == "wall") or (images_y and boundary[1] == "wall"):
                continue
            expected.add((to_x + n[0] * to_y, (images_x, images_y, 0)))
        found = neighbours(boxes, (x, y, 0))
        if images:
            assert sorted(found) == sorted(expected)
        else:  # each box once
            assert sorted(box for box, _ in found) == sorted({box for box, _ in expected})


def test_boxes_narrower_than_a_diameter_are_refused():
    scene = gas(2, 10, 0.1)
    with pytest.raises(gp.SceneError, match="boxes_per_side = 50: boxes must not be narrower"):
        make_boxes(scene, 50, images=True)
    make_boxes(scene, 1, images=True)


def test_the_number_of_boxes_follows_the_number_of_particles():
    assert np.prod(sides_for(gas(3, 1000, 0.01))) == 1000
    dense = gas(3, 1000, 0.6)
    assert dense.container.lengths[0] / sides_for(dense)[0] >= 1.0
    assert np.prod(sides_for(dense)) < 1000


@pytest.mark.interpreted
@pytest.mark.parametrize("lengths", [(1e11, 1.0), (1e-6, 1e5), (1e10, 1.0, 1.0), (1e11, 1e11, 1.0)])
def test_a_long_container_has_about_one_box_per_particle(lengths):
    scene = gp.Scene(gp.Container(lengths), [gp.Species(10, 0.1 * min(lengths), temperature=1.0)])
    sides = sides_for(scene)
    assert math.prod(sides) <= 10
    for other in (gp.EventDriven(), gp.TimeStepped(1e-3 * min(lengths))):
        gp.Simulation(scene, other)


@pytest.mark.parametrize(
    ("dimension", "eta", "per_particle"), [(2, 0.01, 0.53), (2, 0.3, 0.68), (3, 0.01, 1.0), (3, 0.2, 1.5)]
)
def test_events_have_wide_boxes_where_a_gas_of_discs_is_dilute(dimension, eta, per_particle):
    scene = gas(dimension, 10_000, eta, "wall")
    boxes, _ = boxes_and_largest(scene, None)
    assert 0.85 * per_particle < boxes.count / scene.count <= 1.1 * per_particle
    pulled = replace(scene, gravity=(0.0,) * (dimension - 1) + (-1.0,))
    per_particle = max(1.0, per_particle)
    assert 0.85 * per_particle < boxes_and_largest(pulled, None)[0].count / scene.count <= 1.1 * per_particle
