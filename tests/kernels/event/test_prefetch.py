"""Prefetching: it asks for the right boxes, and changes nothing."""

import numba
import numpy as np
import pytest

import gaspart as gp
from gaspart.kernels.compile.policy import kernel
from gaspart.kernels.event.boxes import empty_lists
from gaspart.kernels.event.prefetch import CACHED, fetch_about, next_search
from gaspart.kernels.model import BOX_FACES, PREDICTION, WELL_EDGES, flight_dtype
from gaspart.state.boxes import make_boxes


@kernel
def look(predictions, i):
    return next_search(predictions, i)


@kernel
def ask_for(flights, boxes, at, side, members):
    fetch_about(flights, boxes, at, side, members)


def predicted(contact_time, face_time, face):
    predictions = np.zeros(1, PREDICTION)
    predictions["contact_time"], predictions["face_time"] = contact_time, face_time
    predictions["face"], predictions["box"] = face, (4, 5, 6)
    return predictions


@pytest.mark.parametrize(
    ("times", "face", "at", "side"),
    [
        ((1.0, 2.0), BOX_FACES, (4, 5, 6), (0, 0, 0)),  # a contact: all boxes about the particle
        ((2.0, 1.0), BOX_FACES, (3, 5, 6), (-1, 0, 0)),  # a crossing: those beyond the next box
        ((2.0, 1.0), BOX_FACES + 1, (5, 5, 6), (1, 0, 0)),
        ((2.0, 1.0), BOX_FACES + 4, (4, 5, 5), (0, 0, -1)),
        ((2.0, 1.0), BOX_FACES + 3, (4, 6, 6), (0, 1, 0)),
        *(((2.0, 1.0), face, (4, 5, 6), (0, 0, 0)) for face in (0, 5, WELL_EDGES)),  # of the container
    ],
)
def test_boxes_that_the_next_event_needs_are_asked_for(times, face, at, side):
    assert look(predicted(*times, face), 0) == (at, side)


def test_the_machine_code_fetches():
    scene = gp.Scene(gp.Container((10.0,) * 3, "periodic"), [gp.Species(4, radius=0.5)])
    lists = empty_lists(make_boxes(scene, 5, images=True), 4)
    fresh = numba.njit(nogil=True, error_model="numpy", _nrt=False)(
        ask_for.py_func
    )  # the cache keeps no text
    fresh(np.zeros(4, flight_dtype(3)), lists, (0, 4, 2), (0, 0, 1), True)
    assert "prefetch" in next(iter(fresh.inspect_asm().values()))


def test_a_gas_beyond_the_cache_does_not_depend_on_its_boxes():
    """Of so many particles, what they meet next is prefetched; other boxes ask for others."""
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
