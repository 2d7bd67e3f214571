"""The order of events, and the work of finding it, where many are simultaneous or close to each other."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import gaspart as gp
from gaspart.kernels.event.queue import MOST_UNSORTED, RUNS

SCRIPT = Path(__file__).with_name("drained_queue.py")


def drained(count):
    """Events and times read of each order, by its name; all must come in order."""
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    command = [sys.executable, SCRIPT, str(count)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    rows = [line.split("|") for line in done.stdout.splitlines()]
    assert {ordered for _, ordered, _, _ in rows} == {"True"}
    return {name: int(read) / int(events) for name, _, events, read in rows}


def test_events_come_in_order_and_their_work_hardly_grows_with_their_number():
    """It grew in proportion to it: the first event of a lattice of 512 000 spheres took 13 s."""
    few, many = drained(128), drained(1024)
    assert few.keys() == many.keys() and len(few) == 7
    for name, cost in many.items():
        assert cost < min(2.0 * few[name], 5.0 * MOST_UNSORTED), name
    assert many["evenly spread"] < 7.0


@pytest.mark.thorough
def test_a_lattice_on_edges_of_boxes_has_the_same_bits_in_all_searches():
    """Many particles cross into another box, or a periodic face, at the beginning."""
    scene = gp.Scene(
        gp.Container((12.0, 12.0, 12.0), "periodic"),
        [gp.Species(216, 0.5, temperature=1.0, arrangement="lattice")],
    )
    ends = []
    for search in ("pairs", "boxes", "lists"):
        settings = {"boxes_per_side": 6} if search == "boxes" else {}
        simulation = gp.Simulation(scene, gp.EventDriven(search=search, **settings), seed=3)
        queue = simulation._dynamics._queue
        simulation.advance(max_events=1)
        if search == "boxes":
            assert queue.cursor[RUNS] or queue.runs.any()
        simulation.advance(max_events=400)
        ends.append((simulation.time, simulation.state.positions, simulation.state.velocities))
    for end in ends[1:]:
        assert all(np.array_equal(one, other) for one, other in zip(ends[0], end, strict=True))
