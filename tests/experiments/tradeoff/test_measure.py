"""Orders of convergence and the frontier, from made-up runs."""

import numpy as np
import pytest
from experiments.tradeoff.data import (
    CONTACTS,
    SECONDS,
    STEPS,
    comparison,
    speed_accuracy_measurement,
    timing,
    written,
)

from gaspart.experiments.tradeoff.measure import time_to_accuracy


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    return speed_accuracy_measurement(tmp_path_factory.mktemp("points"))


def test_orders_of_convergence(dataset):
    orders = dataset.set_index(row="setting").order.sel(row="4 passes")
    assert orders.sel(observable="collision_rate") == pytest.approx(2.0, abs=0.02)
    assert orders.sel(observable="Z") == pytest.approx(3.0, abs=0.02)
    late = dataset.set_index(row="setting").order.sel(row="1 pass, no rewinding")
    assert late.sel(observable="Z") == pytest.approx(1.0, abs=0.02)


def test_a_pressure_error_is_weighed_by_its_part_in_z(dataset):
    row = dataset.isel(row=0).sel(observable="Z")
    assert row.bias.values[:3] == pytest.approx(-(STEPS[:3] ** 3) / 3.0, rel=1e-2)


def test_a_refused_step_is_left_out(dataset):
    late = dataset.set_index(row="setting").sel(row="1 pass, no rewinding")
    assert late.time_step.values[:3] == pytest.approx(STEPS[1:])
    assert np.isnan(late.time_step.values[3])


def test_the_frontier_takes_the_longest_step_that_will_do(dataset):
    rate = dataset.isel(gas=0).sel(observable="collision_rate")
    assert rate.best_step.sel(accuracy=0.01) == 0.08  # 2/3 0.08^2 = 0.4 %
    assert rate.best_ratio.sel(accuracy=0.01) == pytest.approx(2.0 * 1.125)
    assert np.isnan(rate.best_ratio.sel(accuracy=0.0001))
    assert str(rate.best_setting.sel(accuracy=0.01).values) == "4 passes"


def test_time_to_accuracy_of_the_reference_gas(tmp_path):
    gas = {"packing_fraction": 0.1}
    points = written(
        tmp_path,
        [
            ("compare", {"passes": 4}, comparison(2.0, 3.0, 0, **gas)),
            ("measure_cost", {"passes": 4}, timing("step", 2.0 * SECONDS * CONTACTS * np.ones(4), **gas)),
            ("measure_cost", {"engine": "event"}, timing("event", [SECONDS * CONTACTS], **gas)),
        ],
    )
    dataset = time_to_accuracy(points, {"counts": [100], "accuracies": [0.01, 0.0001]}).squeeze()
    event = dataset.sel(engine="event", observable="Z")
    assert event.measured.values == pytest.approx(event.model.values, rel=1e-6)  # timed by itself
    assert float(event.measured[1] / event.measured[0]) == pytest.approx(1e4, rel=0.35)  # but for settling
    steps = dataset.sel(engine="step", observable="Z", accuracy=0.01)
    assert float(steps.measured) > 2.0 * float(event.measured[0])
    assert (dataset.regret.sel(observable="Z") == 1.0).all()
