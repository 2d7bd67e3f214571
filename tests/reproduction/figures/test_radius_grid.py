"""Predicted counts beside those of runs."""

from __future__ import annotations

import numpy as np
import pytest
from reproduction.made import simulated

from gaspart import theory
from gaspart.reproduction.figures.radius_grid import crossings_per_collision, expected_pair_tests, measure
from gaspart.reproduction.points.point import Point


def test_pair_tests_of_one_box_are_all_pairs():
    for per_side in (1, 2, 3):
        assert expected_pair_tests(100, per_side, 0.2, 3) == pytest.approx(49.5)


def test_pair_tests_of_an_ideal_gas():
    assert expected_pair_tests(8000, 20, 1e-9, 3) == pytest.approx(0.5 * 27 * (1 - 1 / 8000), rel=1e-3)


def test_crossings_fall_with_the_box_and_with_density():
    one = crossings_per_collision(0.1, 2.0, 1000, 3)
    assert crossings_per_collision(0.1, 4.0, 1000, 3) == pytest.approx(one / 2)
    # mean free path / (sqrt 2) ... : 2 d <|v_x|> / (w nu) with <|v_x|> = <v> / 2 in 3D
    assert one == pytest.approx(3.0 * float(theory.mean_free_path(0.1, 3)) / 2.0, rel=2e-3)


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    root = str(tmp_path_factory.mktemp("points"))
    common = {"dimension": 3, "side": 10, "boundary": "periodic", "temperature": 1.0, "boxes_per_particle": 1}
    event = {"engine": "event", "collisions_per_particle": 60, "equilibration": 10, "samples": 20}
    step = {"engine": "step", "time_step": 0.02, "passes": 1, "steps": 200, "equilibration": 100}
    step |= {"samples": 4}
    experiments = {
        "fraction": [event | {"packing_fraction": 0.1, "count": n} for n in (64, 125, 216)],
        "count": [event | {"count": 125, "radius": r} for r in (0.4, 0.5, 0.6)],
        "fraction_steps": [step | {"packing_fraction": 0.1, "count": n} for n in (125, 216)],
        "count_steps": [step | {"count": 125, "radius": r} for r in (0.4, 0.6)],
    }
    return measure(
        [
            simulated(Point(name, str(k), "simulate", common | varying, root, 3))
            for name, settings in experiments.items()
            for k, varying in enumerate(settings)
        ],
        {},
    )


@pytest.mark.thorough
def test_counts_are_as_predicted_and_z_is_that_of_the_packing_fraction(dataset):
    fixed = (dataset["series"] == "packing fraction").values
    assert fixed.tolist() == [True] * 3 + [False] * 3 + [True] * 2 + [False] * 2
    assert dataset["engine"].values.tolist() == ["event"] * 6 + ["step"] * 4
    event, step = dataset.isel(point=slice(0, 6)), dataset.isel(point=slice(6, 10))
    assert np.all(np.abs(event["crossings"] - 1.0) < 4.0 * event["crossings_error"])
    assert event["crossings_counted"].values == pytest.approx(event["crossings_expected"].values, rel=0.1)
    assert step["pair_tests"].values == pytest.approx(step["pair_tests_expected"].values, rel=0.03)
    assert np.all(np.abs(event["Z"] - event["reference"]) < 4.0 * event["Z_error"])
