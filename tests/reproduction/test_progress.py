"""The time left of a run of the workflow."""

import logging

import pytest

from gaspart.reproduction.progress import USUAL, TimeLeft, describe
from snakemake_logger_plugin_gaspart import LogHandler


def test_steps_of_known_length_on_two_cores():
    """30 steps of 4 s, of which ten pairs have ended, and two others."""
    left = TimeLeft()
    left.plan({"simulate": 30, "figure": 2})
    assert left.seconds(0.0)[0] == 0.0
    for step in range(0, 20, 2):
        left.start(step, "simulate", 2.0 * step)
        left.start(step + 1, "simulate", 2.0 * step)
        left.end(step, 2.0 * step + 4.0)
        left.end(step + 1, 2.0 * step + 4.0)
    mean = (USUAL["simulate"] + 80.0) / 21
    work = 10 * mean + 2 * USUAL["figure"]
    part, seconds = left.seconds(40.0)
    assert part == pytest.approx(80.0 / (80.0 + work))
    assert seconds == pytest.approx(work / 2.0)


def test_a_step_that_runs_counts_up_to_its_mean_time():
    left = TimeLeft()
    left.plan({"simulate": 1})
    left.start(0, "simulate", 100.0)
    assert left.seconds(101.0) == pytest.approx((1.0 / USUAL["simulate"], USUAL["simulate"] - 1.0))
    assert left.seconds(500.0)[1] == 0.0


def test_the_line_comes_by_snakemakes_logger(caplog):
    handler = LogHandler(None, None)
    events = [
        {"event": "run_info", "stats": {"simulate": 2, "total": 2}},
        {"event": "job_info", "jobid": 7, "rule_name": "simulate"},
        {"event": "job_finished", "job_id": 7},
        {"event": "progress", "done": 1, "total": 2},
        {"event": "progress", "done": 1, "total": 2},
        {"event": None},
    ]
    with caplog.at_level(logging.INFO, "snakemake.logging"):
        for fields in events:
            handler.emit(logging.makeLogRecord({"created": 5.0} | fields))
    (line,) = caplog.messages
    assert "of the work done" in line
    assert describe(0.25, 600.0) == "25 % of the work done, some 10 min left"
