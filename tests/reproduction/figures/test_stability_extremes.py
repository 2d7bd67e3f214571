"""Extreme scenes: every row of the table passes, or is refused with one line, in every engine."""

import os
import signal
import time
from dataclasses import replace

import pytest

import gaspart as gp
from gaspart.reproduction.figures import _extreme_scenes as scenes
from gaspart.reproduction.figures._extreme_scenes import ROWS, Row
from gaspart.reproduction.figures.stability_extremes import (
    ENGINES,
    FAILS,
    PASSES,
    REFUSED,
    attempt,
    run_guarded,
    run_row,
)

# Kernels of a plain scene in two dimensions do for these; the others compile their own.
PLAIN = {"speeds", "contacts", "steps", "few"}
PLAIN_ROWS = {"discs in 1e9 diameters", "discs in 1e15 diameters", "corner of two walls", "no gap at all"}
PLAIN_ROWS |= {"a gap of 1e-6", "no room between walls", "clock to 1e9"}
REFUSALS = {
    "discs in 1e15 diameters": "particles[0].radius",
    "speeds 1e-300": "speed",
    "speeds 1e300": "speed",
    "no gap at all": "",
    "no room between walls": "no room",
    "restitution 1e-12, a gas": "",
}


def marked(row):
    cheap = row.group in PLAIN or row.name in PLAIN_ROWS
    return pytest.param(row, id=row.name, marks=() if cheap else pytest.mark.thorough)


@pytest.mark.parametrize("row", [marked(row) for row in ROWS])
def test_a_row_passes_or_is_refused(row):
    for engine, outcome in zip(ENGINES, run_row(row), strict=True):
        if engine.startswith(row.refused):
            assert outcome.verdict == REFUSED, engine
            assert REFUSALS.get(row.name, "") in outcome.message
            assert outcome.message
            assert "\n" not in outcome.message
        else:
            assert outcome.verdict == PASSES, (engine, outcome.message)


def test_a_wrong_count_fails():
    row = next(row for row in ROWS if row.name == "Newton's cradle")
    assert attempt(replace(row, contacts=5), "event").verdict == FAILS


def test_another_last_state_than_the_referees_fails():
    row = next(row for row in ROWS if row.name == "two particles")
    referee = attempt(row, "event, all pairs")
    assert attempt(row, "event", referee).verdict == PASSES
    outcome = attempt(row, "event", replace(referee, bits=b"another"))
    assert (outcome.verdict, outcome.missed) == (FAILS, 1)


def test_digits_of_pi():
    counts = [scenes.galperin_contacts(100.0**k, 2.0, 1.0, 1e6) for k in range(7)]
    assert counts == [3, 31, 314, 3141, 31415, 314159, 3141592]


def test_contacts_on_a_line():
    """Two particles from the walls towards each other, at one speed: they meet, hit a wall each..."""
    assert scenes.contacts_on_line((1.0, 9.0), (1.0, -1.0), 10.0, 3.9) == 0
    assert scenes.contacts_on_line((1.0, 9.0), (1.0, -1.0), 10.0, 4.1) == 1
    assert scenes.contacts_on_line((1.0, 9.0), (1.0, -1.0), 10.0, 9.1) == 3
    assert scenes.contacts_on_line((1.0, 9.0), (1.0, -1.0), 10.0, 14.1) == 4
    assert scenes.hits_in_box((1.0,), (-2.0,), (3.0,), 0.6) == 1


def waits(seconds):
    if seconds < 0:
        os.kill(os.getpid(), signal.SIGKILL)
    time.sleep(seconds)
    return seconds


def test_what_hangs_or_dies_is_ended_and_the_rest_goes_on():
    assert run_guarded(waits, [0.0, 60.0, -1.0, 0.01], limit=3.0) == [0.0, None, None, 0.01]


def test_steps_that_come_too_late_are_refused_even_if_energy_is_kept():
    """The light particle becomes 1e6 times as fast as it was judged by, and is thrown between wall and
    particle."""
    row = Row("ratio 1e12", "masses", lambda: scenes.galperin(1e12), 3.5, 1e-4, None)
    outcome = attempt(row, "step")
    assert outcome.verdict == REFUSED
    assert "a step too late" in outcome.message


def test_float32_refuses_what_it_cannot_hold():
    far = gp.Scene(gp.Container((1e6, 1e6)), [gp.Species(2, 0.5, speed=1.0)])
    with pytest.raises(gp.SceneError, match="float32"):
        gp.Simulation(far, gp.TimeStepped(0.01, precision="float32"))
    with pytest.raises(gp.SceneError, match="time_step"):
        gp.Simulation(far, gp.TimeStepped(1e-11))


@pytest.mark.parametrize("value", [1e-61, 1e61])
@pytest.mark.parametrize("key", ["radius", "mass", "speed", "temperature"])
def test_sizes_that_no_square_holds_are_refused(key, value):
    with pytest.raises(gp.SceneError) as refusal:
        gp.Species(**{"count": 1, "radius": 0.5, key: value})
    assert refusal.value.key == key


def test_a_post_may_fill_the_container_from_wall_to_wall():
    post = gp.Particle((0.5, 2.0), (0.0, 0.0), 0.5, fixed=True)
    assert gp.Scene(gp.Container((1.0, 4.0)), particles=[post]).count == 1
    with pytest.raises(gp.SceneError, match="no room"):
        gp.Scene(gp.Container((1.0, 4.0)), particles=[replace(post, fixed=False)])
