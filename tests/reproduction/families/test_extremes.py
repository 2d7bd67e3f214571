"""A table of extremes, small and made up."""

from __future__ import annotations

import math
import os
import signal
import time
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from reproduction.families.drawn import draw

import gaspart as gp
from gaspart.reproduction.claims import judge
from gaspart.reproduction.families.stability import rows
from gaspart.reproduction.families.stability.claims import stability_extremes as claims_of_stability_extremes
from gaspart.reproduction.families.stability.figure import BLOCKS, GAP, MAP, REASONS
from gaspart.reproduction.families.stability.figure import _reason as reason_of
from gaspart.reproduction.families.stability.figure import stability_extremes as draw_stability_extremes
from gaspart.reproduction.families.stability.measure import (
    FAILS,
    PASSES,
    REFUSED,
    TRIAL_ENGINES,
    attempt,
    run_guarded,
    run_row,
)
from gaspart.reproduction.families.stability.rows import ROWS, Row


def extremes_data(verdict="passes", missed=0, message=""):
    """Two rows in two engines: one passes, the other is refused; the first cell of all as given."""
    shape = ("row", "engine")
    energy = np.array([[1e-15, 0.0], [np.nan, np.nan]])
    return xr.Dataset(
        {
            "verdict": (shape, np.array([[verdict, "passes"], ["refused", "refused"]])),
            "message": (shape, np.array([[message, ""], ["speed = 1: too fast", "speed = 1: too fast"]])),
            "refusal": (shape, np.array([[False, False], [True, True]])),
            "energy": (shape, energy),
            "momentum": (shape, 0.0 * energy),
            "overlap": (shape, 0.0 * energy),
            "contacts": (shape, np.array([[100, 100], [-1, -1]])),
            "missed": (shape, np.array([[missed, 0], [0, 0]])),
            "group": ("row", ["masses", "speeds"]),
        },
        coords={"row": ["mass ratio 1e2", "speeds 1e300"], "engine": ["event", "step"]},
    )


# Every row of the table of extremes passes, or is refused with one line, in every engine.


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
    for engine, outcome in zip(TRIAL_ENGINES, run_row(row), strict=True):
        if engine.startswith(row.refused):
            assert outcome.verdict == REFUSED, engine
            assert REFUSALS.get(row.name, "") in outcome.message
            assert outcome.message
            assert "\n" not in outcome.message
        else:
            assert outcome.verdict == PASSES, (engine, outcome.message)


def test_no_two_rows_are_called_the_same():
    assert len({row.name for row in ROWS}) == len(ROWS)


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
    counts = [rows.galperin_contacts(100.0**k, 2.0, 1.0, 1e6) for k in range(7)]
    assert counts == [3, 31, 314, 3141, 31415, 314159, 3141592]


def test_contacts_on_a_line():
    """Two particles from the walls towards each other, at one speed: they meet, hit a wall each..."""
    assert rows.contacts_on_line((1.0, 9.0), (1.0, -1.0), 10.0, 3.9) == 0
    assert rows.contacts_on_line((1.0, 9.0), (1.0, -1.0), 10.0, 4.1) == 1
    assert rows.contacts_on_line((1.0, 9.0), (1.0, -1.0), 10.0, 9.1) == 3
    assert rows.contacts_on_line((1.0, 9.0), (1.0, -1.0), 10.0, 14.1) == 4
    assert rows.hits_in_box((1.0,), (-2.0,), (3.0,), 0.6) == 1


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
    row = Row("ratio 1e12", "masses", lambda: rows.galperin(1e12), 3.5, 1e-4, None)
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


def test_an_unresolved_particle_is_refused():
    assert math.isclose(rows.pair_in(1e9).container.lengths[0], 1e9)
    with pytest.raises(gp.SceneError, match="too small"):
        rows.pair_in(1e15)


# What the table of extremes claims, and when it does not hold.


def test_rows_that_pass_or_are_refused_agree():
    claims = claims_of_stability_extremes(extremes_data())
    assert len(claims) == 2 + 3
    assert set(judge(claims)) == {"agrees"}


def test_a_refusal_is_expected_and_has_one_line():
    for verdict, message in (("passes", ""), ("refused", ""), ("refused", "two\nlines")):
        data = extremes_data()
        data["verdict"][1, 0], data["message"][1, 0] = verdict, message
        assert judge(claims_of_stability_extremes(data)[:2]) == ["agrees", "disagrees"]


@pytest.mark.parametrize(
    ("changed", "wrong"),
    [
        ({"verdict": "fails", "message": "energy"}, 0),
        ({"verdict": "hangs"}, 0),
        ({"verdict": "refused", "message": "speed = 1: too fast"}, 0),  # which should pass
        ({"missed": -1}, 4),
    ],
)
def test_what_hangs_fails_or_refuses_without_a_line_disagrees(changed, wrong):
    data = extremes_data(**changed)
    verdicts = judge(claims_of_stability_extremes(data) if wrong else claims_of_stability_extremes(data)[:2])
    assert [n for n, verdict in enumerate(verdicts) if verdict != "agrees"] == [wrong]


def table(axis):
    """Texts and backgrounds of the cells, by block, engine and row."""
    texts, colours = {}, {}
    width = len(axis.get_xticks()) // len(BLOCKS) + GAP
    for patch in axis.patches:
        left, top = patch.get_xy()
        place = (list(BLOCKS)[int(left // width)], round(left % width), int(top))
        colours[place] = patch.get_facecolor()
        inside = [text for text in axis.texts if patch.get_extents().contains(*text.get_window_extent().p0)]
        texts[place] = "".join(text.get_text() for text in inside)
    return texts, colours


def test_each_cell_shows_an_error_or_the_reason_of_a_refusal():
    ds = extremes_data()
    ds["energy"][:] = [[1e-15, 1e-9], [0.0, 1.0]]
    ds["momentum"][:] = [[np.nan, 1e-8], [0.0, 1.0]]
    ds["overlap"][:] = [[0.0, 1e-3], [0.0, 1.0]]
    ds["contacts"][:] = [[100, 90], [4, -1]]
    ds["missed"][:] = [[0, 10], [0, 0]]
    ds["verdict"][:] = [["passes", "passes"], ["passes", "refused"]]
    ds["message"] = ds["message"].astype("U60")
    ds["message"][1, 1] = "speed = 1e300: must be 0 or of a size from 1e-60 to 1e+60"
    axis = draw(draw_stability_extremes, ds).axes[0]
    texts, colours = table(axis)
    assert len(texts) == 4 * 2 * 2
    assert [texts[name, 0, 0] for name in BLOCKS] == ["$10^{-15}$", "·", "0", "0"]
    assert [texts[name, 1, 0] for name in BLOCKS] == ["$10^{-9}$", "$10^{-8}$", "$10^{-3}$", "10"]
    assert [texts[name, 0, 1] for name in BLOCKS] == ["0"] * 4
    assert [texts[name, 1, 1] for name in BLOCKS] == ["d"] * 4
    for name, power in (("energy", -9), ("momentum", -8), ("overlap", -3), ("missed", -1)):
        assert colours[name, 1, 0] == pytest.approx(MAP((17 + power) / 17), abs=0.02)
    assert [label.get_text() for label in axis.get_yticklabels()] == list(ds["row"].values)
    assert [label.get_text() for label in axis.get_xticklabels()] == ["event", "step f8"] * 4
    assert axis.get_ylim() == (2.0, 0.0)
    assert [line.get_ydata()[0] for line in axis.lines] == [1]  # between the two groups


def test_a_failure_is_named():
    texts, _ = table(draw(draw_stability_extremes, extremes_data(verdict="fails")).axes[0])
    assert texts["energy", 0, 0] == texts["missed", 0, 0] == "fails"


@pytest.mark.parametrize(
    ("message", "letter"),
    [
        ("at time 1 80 of 338 contacts were found a step too late", "a"),
        ("time_step = 0.01: moves particles by less than float32 resolves in a length of 8", "b"),
        ("particles[0].radius = 0.5: leaves no room between two walls", "f"),
        ("at time 0 particle 9 has had 12 contacts: an inelastic collapse, or a stack at rest", "g"),
        ("something else", "?"),
    ],
)
def test_refusals_are_grouped_by_their_messages(message, letter):
    assert reason_of(message)[0] == letter


def test_reasons_have_different_letters():
    assert len({letter for letter, *_ in REASONS}) == len(REASONS)
