"""Fetching ahead: it asks for the right boxes, and changes nothing."""

import numba
import numpy as np
import pytest

import gaspart as gp
from gaspart.boxes import make_boxes
from gaspart.engines.ahead import CACHED, fetch_about, searched
from gaspart.engines.calendar import PLAN
from gaspart.engines.layout import EDGES, INNER
from gaspart.engines.lists import empty_partition
from gaspart.kernel import kernel


@kernel
def look(plans, body):
    return searched(plans, body)


@kernel
def ask_for(rows, partition, at, side, whom):
    fetch_about(rows, partition, at, side, whom)


def plans_of(contact, face_time, face):
    plans = np.zeros(1, PLAN)
    plans["contact"], plans["face_time"], plans["face"], plans["at"] = contact, face_time, face, (4, 5, 6)
    return plans


def test_before_a_contact_all_boxes_about_the_body_are_asked_for():
    assert look(plans_of(1.0, 2.0, INNER), 0) == ((4, 5, 6), (0, 0, 0))


@pytest.mark.parametrize(
    ("face", "at", "side"),
    [
        (INNER, (3, 5, 6), (-1, 0, 0)),
        (INNER + 1, (5, 5, 6), (1, 0, 0)),
        (INNER + 4, (4, 5, 5), (0, 0, -1)),
        (INNER + 3, (4, 6, 6), (0, 1, 0)),
    ],
)
def test_before_a_crossing_those_beyond_the_next_box(face, at, side):
    assert look(plans_of(2.0, 1.0, face), 0) == (at, side)


@pytest.mark.parametrize("face", [0, 5, EDGES])
def test_at_the_faces_of_the_container_all(face):
    assert look(plans_of(2.0, 1.0, face), 0) == ((4, 5, 6), (0, 0, 0))


def test_the_machine_code_fetches():
    scene = gp.Scene(gp.Container((10.0,) * 3, "periodic"), [gp.Species(4, radius=0.5)])
    partition = empty_partition(make_boxes(scene, 5, images=True), 4)
    fresh = numba.njit(nogil=True, error_model="numpy", _nrt=False)(
        ask_for.py_func
    )  # the cache keeps no text
    fresh(np.zeros((4, 8)), partition, (0, 4, 2), (0, 0, 1), True)
    assert "prefetch" in next(iter(fresh.inspect_asm().values()))


def test_a_gas_beyond_the_cache_does_not_depend_on_its_boxes():
    """Of so many bodies, what they meet next is fetched ahead; other boxes ask for others."""
    count = CACHED + 1000
    scene = gp.Scene(
        gp.Container(((count / 0.2) ** (1 / 3),) * 3, "periodic"),
        [gp.Species(count, radius=0.5, temperature=1.0, arrangement="lattice")],
    )
    ends = []
    for boxes in (None, 20):
        sim = gp.Simulation(scene, gp.EventDriven(boxes_per_side=boxes), seed=3)
        sim.advance(max_events=3000)
        ends.append(sim.state)
    assert np.array_equal(ends[0].positions, ends[1].positions)
    assert np.array_equal(ends[0].velocities, ends[1].velocities)
