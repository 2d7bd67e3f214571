"""Lengths, speeds, masses and times of any size: a scene is refused in one line, or its run is correct."""

import warnings

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from malformed import within

import gaspart as gp

pytestmark = pytest.mark.thorough

LIMIT = 5.0
"""Processor time of a case in s."""
LONGEST = 1000
"""Characters of a message."""


def factors(least, most, usual=0.5):
    """Powers of ten with any exponent, most of them moderate."""
    usually = st.floats(-usual, usual)
    exponent = st.one_of(usually, usually, usually, st.floats(-3.0, 3.0), st.floats(least, most))
    return exponent.map(lambda power: 10.0**power)


@st.composite
def runs(draw):
    """A scene as keys, an engine as keys, and a duration: sizes from 1e-150 to 1e150."""
    length, speed, mass = (draw(factors(-150.0, 150.0, usual=40.0)) for _ in range(3))
    sides = [length, length * draw(factors(-13.0, 13.0))]
    species = [
        {
            "count": draw(st.integers(1, 6)),
            "radius": 0.05 * min(sides) * min(1.0, draw(factors(-13.0, 0.0))),
            "speed": speed * draw(factors(-20.0, 20.0)),
            "mass": mass * draw(factors(-20.0, 20.0)),
        }
        for _ in range(draw(st.integers(1, 2)))
    ]
    boundary = draw(st.sampled_from(["wall", "periodic"]))
    unit = min(kind["radius"] for kind in species) / max(kind["speed"] for kind in species)
    duration, settings = 100.0 * unit * draw(factors(-150.0, 150.0)), {}
    if draw(st.booleans()):
        settings["time_step"] = 0.03 * unit * draw(factors(-150.0, 150.0))
    return {"container": {"lengths": sides, "boundary": boundary}, "species": species}, settings, duration


MODERATE = {
    "container": {"lengths": [9.0, 9.0], "boundary": "wall"},
    "species": [{"count": 6, "radius": 0.5, "speed": 1.0}],
}


def carried_out(content, settings, duration):
    """The simulation, after at most 200 events or steps, and 100 000 crossings, or None if it is refused."""
    try:
        scene = gp.Scene.from_dict(content)
        simulation = gp.Simulation(scene, gp.TimeStepped(**settings) if settings else gp.EventDriven(), 1)
        if settings:
            simulation.advance(duration=min(duration, 200.0 * settings["time_step"]))
        else:
            simulation.advance(duration=duration, max_events=200, max_work=100_000)
        simulation.check_invariants()
    except (gp.SceneError, gp.SimulationError) as error:
        assert str(error).isprintable() and len(str(error)) < LONGEST, error
        return None
    return simulation


@example((MODERATE, {}, 5.0))
@example((MODERATE, {"time_step": 0.05}, 5.0))
@given(runs())
def test_a_scene_of_any_scale_is_refused_or_runs_correctly(case):
    content, settings, duration = case
    with within(LIMIT), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "gaspart: time_step", UserWarning)
        simulation = carried_out(content, settings, duration)
    if simulation is None:
        assert content is not MODERATE
        return
    state, start = simulation.state, simulation.initial_state
    assert np.isfinite(simulation.time) and 0.0 <= simulation.time <= duration * (1 + 1e-12)
    assert np.isfinite(state.positions).all() and np.isfinite(state.velocities).all()
    lengths, slack = np.array(content["container"]["lengths"]), 0.0
    if content["container"]["boundary"] == "wall":
        slack = state.radii[:, None] * (1.0 - 1e-6) if not settings else 0.0
    rounding = 1e-12 * lengths
    assert (state.positions >= slack - rounding).all() and (
        state.positions <= lengths - slack + rounding
    ).all()
    assert state.kinetic_energy == pytest.approx(start.kinetic_energy, rel=1e-9)
    moved = simulation.tally.collisions + simulation.tally.wall_hits.sum()
    assert moved or np.abs(state.velocities) == pytest.approx(np.abs(start.velocities), rel=1e-12)
