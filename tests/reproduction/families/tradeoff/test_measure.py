"""Orders of convergence and the frontier, from made-up runs."""

import numpy as np
import pytest
from reproduction.families.tradeoff.data import (
    CONTACTS,
    SECONDS,
    SETTINGS,
    STEPS,
    comparison,
    speed_accuracy_measurement,
    timing,
    written,
)

from gaspart import theory
from gaspart.reproduction.families.tradeoff.measure import _orders, frontier, speed_accuracy, time_to_accuracy
from gaspart.reproduction.families.tradeoff.uniform import OBSERVABLES


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    return speed_accuracy_measurement(tmp_path_factory.mktemp("points"))


def test_orders_of_convergence(dataset):
    orders = dataset.set_index(row="setting").order.sel(row="4 passes")
    assert orders.sel(observable="collision_rate") == pytest.approx(2.0, abs=0.02)
    assert orders.sel(observable="Z") == pytest.approx(3.0, abs=0.02)
    late = dataset.set_index(row="setting").order.sel(row="1 pass, no rewinding")
    assert late.sel(observable="Z") == pytest.approx(1.0, abs=0.02)


def test_two_errors_have_no_order():
    """Spheres at 0.3, by four passes: the error changes its sign, and only the largest two are seen."""
    step = np.array([0.32, 0.24, 0.16, 0.12, 0.08])
    bias, error = np.array([-7.68, -0.71, 0.33, 0.47, 0.26]), np.array([0.11, 0.15, 0.18, 0.14, 0.08])
    row = {
        "time_step": step,
        "bias": [bias / 100.0, -(step**2)],
        "bias_error": [error / 100.0, step**2 / 50.0],
    }
    (order, order_error), (second, second_error) = _orders(row, 0.2)
    assert np.isnan(order) and np.isnan(order_error)
    assert second == pytest.approx(2.0) and second_error < 0.05


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


def test_models_of_dsmc_in_discs(tmp_path):
    """The cheapest step; the error of Z of the Boltzmann equation. That of the Enskog model is unknown: the
    loss in its cells was measured in spheres."""
    discs = {"dimension": 2}
    boltzmann, enskog = (
        {"engine": "dsmc", "model": model, "scan_step_parts": [4, 1]} for model in ("boltzmann", "enskog")
    )
    points = written(
        tmp_path,
        [
            ("compare", {"passes": 4}, comparison(2.0, 3.0, 0)),
            ("measure_cost", {"engine": "event"}, timing("event", [SECONDS * CONTACTS])),
            ("measure_cost", {"engine": "event"}, timing("event", [0.5 * SECONDS * CONTACTS], **discs)),
            ("measure_cost", boltzmann, timing("dsmc", [0.1, 0.2], **discs)),
            ("measure_cost", enskog, timing("dsmc", [0.8, 0.9], **discs)),
        ],
    )
    found = speed_accuracy(points, SETTINGS).squeeze("dsmc")
    assert str(found.dsmc_model.values) == "boltzmann" and int(found.dsmc_dimension) == 2
    assert float(found.dsmc_seconds) == pytest.approx(0.1 / CONTACTS)
    assert found.dsmc_step.values.tolist() == [4.0, 1.0]
    assert found.dsmc_step_seconds.values == pytest.approx(np.array([0.1, 0.2]) / CONTACTS)
    lacking = 1.0 - 1.0 / float(theory.compressibility_factor(0.01, 2))
    assert float(found.dsmc_bias) == pytest.approx(lacking)


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
    settings = {"counts": [100], "accuracies": [0.01, 0.0001], "elsewhere": ["gas"], "blocks": 8}
    settings |= {name: [] for name in ("cells", "plates", "plates_cost", "relaxation")}
    dataset = time_to_accuracy(points, settings).squeeze()
    event = dataset.sel(engine="event", observable="Z")
    assert event.measured.values == pytest.approx(event.model.values, rel=1e-6)  # timed by itself
    assert float(event.measured[1] / event.measured[0]) == pytest.approx(1e4, rel=0.35)  # but for settling
    steps = dataset.sel(engine="step", observable="Z", accuracy=0.01)
    assert float(steps.measured) > 2.0 * float(event.measured[0])
    assert (dataset.regret.sel(observable="Z") == 1.0).all()
    mapped = dataset.cost.sel(quantity="Z", solver="event").values
    assert mapped == pytest.approx(event.measured.values, rel=1e-6)
    assert np.isnan(dataset.cost.sel(quantity="heat_flux")).all()


def with_long_runs(dataset, build_up, setting="4 passes"):
    """The data with one long run, whose error of Z differs by `build_up` from that of paired runs."""
    return dataset.assign(
        steady_dimension=("steady", [3]),
        steady_packing_fraction=("steady", [0.01]),
        steady_setting=("steady", [setting]),
        build_up=("steady", [build_up]),
        build_up_error=("steady", [1e-4]),
    )


@pytest.mark.parametrize(
    ("build_up", "setting", "step"),
    [(0.0, "4 passes", 0.16), (3e-4, "4 passes", 0.16), (9e-3, "4 passes", 0.08), (9e-3, "1 pass", 0.16)],
)
def test_the_frontier_allows_for_what_builds_up_over_many_steps(dataset, build_up, setting, step):
    """A hundredth is reached by steps of 0.16 (an error of 0.0014), by those of 0.08 if 0.009 builds up."""
    best = frontier(with_long_runs(dataset, build_up, setting)).best_step.isel(gas=0, accuracy=0)
    assert best.values[OBSERVABLES.index("Z")] == step
    assert best.values[0] == float(dataset.best_step[0, 0, 0])  # of the collision rate
