"""Fits of costs, on costs that are known."""

import math

import numpy as np
import pytest
import xarray as xr

from gaspart.reproduction.figures import _timings as timings

PARTICLE, TEST, BOX = 30e-9, 12e-9, 0.3e-9


def costs(boxes, noise=0.0, seed=0):
    """`per_particle` costs of a gas whose pair tests and boxes cost what is given."""
    rng = np.random.default_rng(seed)
    boxes = np.asarray(boxes, dtype=float)
    seconds = (PARTICLE + TEST * 13.5 / boxes + BOX * boxes) * (1.0 + noise * rng.standard_normal(boxes.size))
    columns = {"boxes_per_particle": boxes, "seconds": seconds, "pair_tests": 13.5 / boxes}
    columns["seconds_error"] = noise * seconds
    return xr.Dataset({name: ("partition", values) for name, values in columns.items()})


def test_median_ignores_a_disturbed_repeat():
    value, error = timings.median(np.array([[1.0, 1.01, 0.99, 1.0, 50.0]]))
    assert value[0] == 1.0
    assert error[0] < 0.02


def test_boxes_of_a_penalty_cost_nothing_rather_than_less():
    """The time falls faster at the finest partitions than one over their number, as by a disturbance."""
    made = costs(np.geomspace(0.5, 8.0, 8))
    made["seconds"][-2:] *= 0.9
    assert timings.penalty(made, 4.0)[0] < float(made.seconds[-3] / made.seconds[-1]) * 0.97


def test_the_uncertainty_of_a_penalty_is_its_scatter():
    """Of 300 scans with noise of which the errors know."""
    boxes = np.geomspace(1.0, 256.0, 12)
    found = np.array([timings.penalty(costs(boxes, 0.03, seed), 4.0) for seed in range(300)])
    exact = float(costs([4.0]).seconds[0]) / (PARTICLE + 2.0 * math.sqrt(TEST * 13.5 * BOX))
    assert found[:, 0].mean() == pytest.approx(exact, rel=0.01)
    assert 0.7 < found[:, 0].std() / found[:, 1].mean() < 1.4


def test_times_in_turn_are_compared_repeat_by_repeat():
    """A machine that slows down between repeats, of which one is disturbed, changes no ratio."""
    speed = np.array([1.0, 2.0, 3.0, 4.0])
    seconds = np.array([[2.0], [6.0], [1.0], [1.0]]) * speed
    seconds[0, 3] *= 10.0
    run = xr.Dataset({"seconds": (("partition", "repeat"), seconds)})
    logs = timings.log_ratios(run, np.array([1.0, 2.0, 1.0, 1.0]))
    assert np.exp(logs) == pytest.approx([2.0, 3.0])
