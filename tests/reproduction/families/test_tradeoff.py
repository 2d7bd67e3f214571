"""Made-up comparisons and timings of the engines, with known orders of convergence and costs."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from reproduction.claims.data import judged
from reproduction.families.drawn import Points, draw, shows, varied

from gaspart import theory
from gaspart.reproduction.claims import judge
from gaspart.reproduction.families.tradeoff import ENGINES, PARTS, figure, maps, measure
from gaspart.reproduction.families.tradeoff import claims as claims_of_tradeoff
from gaspart.reproduction.families.tradeoff import figure as draw_tradeoff
from gaspart.reproduction.families.tradeoff.maps import QUANTITIES
from gaspart.reproduction.families.tradeoff.measure import _orders, speed_accuracy, time_to_accuracy
from gaspart.reproduction.points.point import Point

STEPS = np.array([0.32, 0.16, 0.08, 0.04])
SETTINGS = {"order_up_to": 0.2, "cells": []}
FRACTIONS = (0.0001, 0.001, 0.01, 0.1, 0.3)
SNAPSHOTS, CONTACTS, Z, SECONDS = 6, 1e5, 1.5, 1e-6


def comparison(rate_order, z_order, refuse_longest, **attributes):
    """What `compare` gives if errors of the rate are 2/3 dt^2 or alike, and those of Z of another order."""
    rng = np.random.default_rng(3)
    shape = (STEPS.size, SNAPSHOTS)
    noise = 2e-6 * rng.standard_normal((2, *shape))
    step = STEPS[:, None]
    exact = np.full(shape, CONTACTS)
    values = {
        "exact_collisions": exact,
        "collisions": exact * (1.0 - 2.0 / 3.0 * step**rate_order + noise[0]),
        "exact_virial": exact,
        "virial": exact * (1.0 - step**z_order + noise[1]),
        "exact_z": np.full(shape, Z),
        "exact_memory": np.full(shape, 0.5),
        "memory": 0.5 ** (1.0 / (1.0 + 0.1 * step**2 + noise[0])),
        "energy_drift": np.zeros(shape),
        "deepest_overlap": np.minimum(1.0, 3.0 * step) + np.zeros(shape),
        "pair_tests": 10.0 * exact,
        "missed": 0.01 * exact,
        "made_up": np.zeros(shape),
        "listed": exact,
    }
    refused = np.zeros(STEPS.size, dtype=int)
    refused[0] = refuse_longest
    return xr.Dataset(
        {name: (("setting", "snapshot"), value) for name, value in values.items()},
        attrs={"dimension": 3, "packing_fraction": 0.01, "precision": "float64", "rewind": 1, "passes": 4}
        | attributes,
    ).assign(time_step=("setting", STEPS), steps=("setting", [8] * 4), refused=("setting", refused))


def timing(engine, seconds, **attributes):
    """What `measure_cost` gives of `CONTACTS` contacts, if each setting needs so many seconds for them."""
    n = len(seconds)
    steps = np.round(16.0 / STEPS[:n]).astype(int) if engine == "step" else np.zeros(n, dtype=int)
    ones = np.ones(n)
    return xr.Dataset(
        {
            "seconds": (("partition", "repeat"), np.outer(seconds, [0.98, 1.0, 1.02])),
            "collisions": ("partition", CONTACTS * ones),
            "duration": ("partition", 16.0 * ones),
            "steps": ("partition", steps),
            "pair_tests": ("partition", 5.0 * CONTACTS * ones),
        },
        attrs={"dimension": 3, "packing_fraction": 0.01, "engine": engine} | attributes,
    )


def speed_accuracy_measurement(folder):
    """What `measure.speed_accuracy` makes of two settings of a dilute gas, and of both models of DSMC; of
    discs that of Boltzmann."""
    made = [
        ("compare", {"passes": 4}, comparison(2.0, 3.0, 0)),
        ("compare", {"passes": 1, "rewind": False}, comparison(1.0, 1.0, 1, rewind=0, passes=1)),
        ("measure_cost", {"passes": 4}, timing("step", 2.0 * SECONDS * CONTACTS * (1.0 + 0.01 / STEPS))),
        ("measure_cost", {"engine": "event"}, timing("event", [SECONDS * CONTACTS])),
    ]
    return measure.speed_accuracy(written(folder, made), SETTINGS).assign(
        dsmc_model=("dsmc", ["boltzmann", "enskog", "boltzmann"]),
        dsmc_dimension=("dsmc", [3, 3, 2]),
        dsmc_packing_fraction=("dsmc", [0.01, 0.01, 0.01]),
        dsmc_seconds=("dsmc", [1e-7, 9e-7, 2e-7]),
        dsmc_seconds_error=("dsmc", [1e-9, 1e-8, 1e-9]),
        dsmc_bias=("dsmc", [0.04, 0.002, 0.02]),
    )


def written(folder, made):
    """Points of (job, settings, dataset), with their results in a folder."""
    points = []
    for n, (job, settings, dataset) in enumerate(made):
        points.append(Point("gas", f"n={n}", job, settings, str(folder), 1))
        (folder / "gas").mkdir(exist_ok=True)
        dataset.to_netcdf(points[-1].path)
    return points


def time_to_accuracy_measurement(more_expensive=1.0):
    """What `measure.time_to_accuracy` gives if the model is right but for a factor of the steps' cost."""
    accuracy = np.array([0.1, 0.01, 0.001, 0.0001])
    axes = ("gas", "observable", "count", "accuracy")
    shape = (2, 3, 2, 4)
    event = 1.0 / accuracy**2 + np.zeros(shape)
    step = 0.5 / accuracy**2 * (1.0 + 0.005 / accuracy) + np.zeros(shape)
    measured = np.stack([event, step], axis=-1)
    model = np.stack([event, more_expensive * step], axis=-1)
    picked = np.where(model[..., 0] < model[..., 1], event, step)
    return xr.Dataset(
        {
            "measured": ((*axes, "engine"), measured),
            "model": ((*axes, "engine"), model),
            "regret": (axes, picked / measured.min(axis=-1)),
            "regret_error": (axes, np.full(shape, 0.02)),
            "gas_dimension": ("gas", [3, 3]),
            "gas_packing_fraction": ("gas", [0.05, 0.2]),
        },
        coords={
            "observable": list(measure.OBSERVABLES),
            "count": [1000, 10000],
            "accuracy": accuracy,
            "engine": ["event", "step"],
        },
    ).merge(map_measurement(accuracy))


def map_measurement(accuracy):
    """What `maps.maps` gives of engines whose errors are those of theory, or half of their bounds."""
    each = {
        "event": [2e-5, 5e-6, 1.3e-6, 5e-7, 3e-7],
        "step": [4e-5, 1e-5, 2e-6, 7e-7, 4e-7],
        "boltzmann": [2e-7, 1.5e-7, 1e-7, 1e-7, 1e-7],
        "enskog": [1e-6] * 5,
    }
    bias = np.array([[0.0] * 5, [1e-4] * 5, [3e-4, 3e-3, 3e-2, 0.3, 1.0], [2e-3, 2e-3, 2e-3, 0.05, 0.25]])
    seconds = np.array([each[name] for name in ENGINES])
    room = accuracy[:, None] - bias.T[:, None, :]  # fraction, accuracy, solver
    with np.errstate(divide="ignore"):
        cost = np.where(room > 0.0, seconds.T[:, None, :] * (1.0 / room**2 + 1e4), np.inf)
    error = np.stack(
        [np.broadcast_to(bias.T[:, None, :], cost.shape), *[np.full(cost.shape, 1e-4)] * 4], axis=-1
    )
    every = np.ones((5, 1, 1, 1))
    bound = np.full((2, 5, 4), np.nan)
    bound[:, :, 1:] = np.array([0.03, 0.04, 0.05])
    slow = [claims_of_tradeoff.relaxation_time(float(theory.contact_value(eta, 3))) for eta in FRACTIONS]
    relaxing = np.full((5, 4), claims_of_tradeoff.relaxation_time(1.0))
    relaxing[:, 2] = slow
    bound[1, :, 2] = 0.5
    flow = np.stack([np.full((5, 4), 2.0) * np.array([1.0, 0.99, 1.02, 1.03]), relaxing])
    axes = ("quantity", "fraction", "accuracy", "solver")
    flow_axes = ("flow_quantity", "fraction", "solver")
    return xr.Dataset(
        {
            "cost": (axes, every * cost),
            "cost_error": (axes, 0.01 * every * cost),
            "error": ((*axes, "part"), every[..., None] * error),
            "flow": (flow_axes, flow),
            "flow_error": (flow_axes, 0.003 * flow),
            "flow_freedom": (flow_axes, np.full((2, 5, 4), 20.0)),
            "flow_bound": (flow_axes, bound),
            "each": (("fraction", "solver"), seconds.T),
            "each_error": (("fraction", "solver"), 0.01 * seconds.T),
            "cells": ("fraction", [1.0, 1.0, 1.0, 0.999, 0.997]),
            "cells_error": ("fraction", np.full(5, 4e-4)),
            "cells_freedom": ("fraction", np.full(5, 99.0)),
            "cells_bound": ("fraction", np.full(5, 0.004)),
        },
        coords={
            "quantity": list(QUANTITIES),
            "fraction": list(FRACTIONS),
            "solver": list(ENGINES),
            "part": list(PARTS),
            "flow_quantity": list(maps.FLOWS),
        },
    )


# Orders of convergence, from made-up runs.


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


@pytest.mark.parametrize(
    ("build_up", "setting", "verdict"),
    [(1e-4, "4 passes", "agrees"), (9e-3, "4 passes", "disagrees"), (9e-3, "1 pass", "no verdict")],
)
def test_errors_that_build_up_over_many_steps_are_noticed(dataset, build_up, setting, verdict):
    """In one long run, whose error of Z differs by `build_up` from that of paired runs."""
    long = dataset.assign(
        steady_dimension=("steady", [3]),
        steady_packing_fraction=("steady", [0.01]),
        steady_setting=("steady", [setting]),
        steady_step=("steady", [0.16]),
        build_up=("steady", [build_up]),
        build_up_error=("steady", [1e-4]),
    )
    (found,) = (value for claim, value in verdicts(long).items() if "steady state" in claim)
    assert found == verdict


def verdicts(dataset):
    return judged(claims_of_tradeoff.speed_accuracy(dataset))


def test_orders_and_losses_agree_where_theory_holds(tmp_path):
    found = verdicts(speed_accuracy_measurement(tmp_path))
    assert set(found.values()) == {"agrees"}
    assert any("order of the error of Z" in claim and "no rewinding" in claim for claim in found)
    assert any("collisions lost to steps of 0.16" in claim for claim in found)


def test_contacts_late_by_half_a_step_are_noticed(tmp_path):
    dataset = speed_accuracy_measurement(tmp_path)
    dataset["order"] = dataset.order * 0.5
    found = verdicts(dataset)
    assert sum(verdict == "disagrees" for verdict in found.values()) == 3


def choice(dataset):
    claims = claims_of_tradeoff.time_to_accuracy(dataset)[-3:]
    return dict(zip(("event", "step", "choice"), judge(claims), strict=True))


def test_a_model_that_predicts_the_costs_agrees_and_one_that_does_not_is_noticed():
    assert choice(time_to_accuracy_measurement()) == dict.fromkeys(("event", "step", "choice"), "agrees")
    wrong = choice(time_to_accuracy_measurement(more_expensive=4.0))
    assert wrong == {"event": "agrees", "step": "disagrees", "choice": "disagrees"}


def of_map(dataset):
    return judged(claims_of_tradeoff.of_map(dataset))


def test_a_map_as_theory_has_it_agrees():
    found = of_map(time_to_accuracy_measurement())
    assert set(found.values()) == {"agrees"}
    for part in ("time of DSMC", "Enskog model in D", "heat flux", "relaxation time", "default cells"):
        assert any(part in claim for claim in found), part


def changed(name, factor, **at):
    """The measurement with one variable changed by a factor in one place."""
    dataset = time_to_accuracy_measurement()
    dataset[name].loc[at] *= factor
    return dataset


def test_costs_and_errors_that_theory_does_not_have_are_noticed():
    cases = {
        "time of DSMC over": changed("cost", 5.0, solver="boltzmann", fraction=0.001),
        "at packing fraction 0.0001 over 0.01": changed("each", 5.0, solver="boltzmann", fraction=0.0001),
        "time of a collision by the Enskog": changed("each", 0.2, solver="enskog", fraction=0.3),
        "error of the Enskog model in D": changed("error", 0.0, solver="enskog", fraction=0.3, part="model"),
        "heat flux between plates by time steps": changed("flow", 1.06, solver="step", fraction=0.1),
        "model over that by the Enskog": changed("flow", 1.04, solver="boltzmann", fraction=0.3),
        "default cells": changed("cells", 0.99, fraction=0.1),
    }
    for part, dataset in cases.items():
        wrong = [claim for claim, verdict in of_map(dataset).items() if verdict == "disagrees"]
        assert any(part in claim for claim in wrong), part


def errors(row, observable):
    """Errors of one setting that exceed two standard errors, and the bounds of the others."""
    at = row.sel(observable=observable)
    size, error = 100.0 * np.abs(at["bias"].values), 100.0 * at["bias_error"].values
    seen = size > 2.0 * error
    unseen = ~seen & np.isfinite(size)
    time_step = row["time_step"].values
    return [Points(time_step[seen], size[seen], error[seen]), Points(time_step[unseen], 2.0 * error[unseen])]


def test_errors_are_drawn_against_the_step_and_costs_against_errors(tmp_path):
    ds = varied(
        speed_accuracy_measurement(tmp_path), "packing_fraction", "event_seconds", "dsmc_packing_fraction"
    )
    *steps, cost = draw(draw_tradeoff.speed_accuracy, ds).axes
    rows = {row["setting"].item(): row for row in (ds.isel(row=n) for n in range(ds.sizes["row"]))}
    assert set(rows) == set(draw_tradeoff.SHOWN)
    for axis, observable in zip(steps, ("collision_rate", "Z", "D"), strict=True):
        shows(axis, *(one for name in draw_tradeoff.SHOWN for one in errors(rows[name], observable)))
    row = rows["4 passes"]
    at = row.sel(observable="Z")
    error = 100.0 * np.maximum(np.abs(at["bias"]), 2.0 * at["bias_error"]).values
    timed = np.isfinite(row["seconds"].values) & np.isfinite(error)
    seconds, bars = (1e6 * row[name].values[timed] for name in ("seconds", "seconds_error"))
    models = [Points(error[timed], seconds, bars)]
    for one in (ds.isel(dsmc=[n]) for n in np.flatnonzero(ds["dsmc_dimension"] == 3)):
        models.append(Points(100.0 * one.dsmc_bias, 1e6 * one.dsmc_seconds, 1e6 * one.dsmc_seconds_error))
    shows(cost, *models)


def test_the_map_has_the_cheapest_engine_of_each_field():
    ds = time_to_accuracy_measurement().sortby("accuracy", ascending=False)
    *fields, _ = draw(draw_tradeoff.time_to_accuracy, ds).axes
    for axis, quantity in zip(fields, figure.TITLES, strict=True):
        at = ds.sel(quantity=quantity)
        colours = axis.collections[0].get_array()
        texts = iter(axis.texts)
        for f, _ in enumerate(ds.fraction):
            for a, _ in enumerate(ds.accuracy):
                costs = at.cost.isel(fraction=f, accuracy=a)
                best = costs.solver.values[int(np.argmin(costs.values))]
                assert tuple(colours[a, f]) == pytest.approx(figure.tint(best))
                assert next(texts).get_text() == figure.duration(float(costs.min()))


def test_bars_are_the_parts_of_the_error():
    ds = time_to_accuracy_measurement()
    errors = draw(draw_tradeoff.time_to_accuracy, ds).axes[-1]
    at = ds.error.sel(quantity="D", fraction=0.01, accuracy=0.01, solver="enskog").values / 0.01
    rows = [bar for bar in errors.patches if bar.get_y() == pytest.approx(-4.4)]
    assert [bar.get_width() for bar in rows] == pytest.approx(list(at))


def test_of_a_small_run_the_nearest_places_are_shown():
    ds = time_to_accuracy_measurement().isel(fraction=[1, 4])
    ds["cost"] = ds.cost.where((ds.fraction != 0.3) | (ds.quantity != "D"))
    (at,) = figure.places(ds)
    assert (at.quantity, at.fraction, at.accuracy) == ("D", 0.001, 0.01)
    assert len(draw(draw_tradeoff.time_to_accuracy, ds).axes[-1].patches) > 0


def test_a_gas_in_which_no_engine_is_accurate_enough_is_left_white():
    ds = time_to_accuracy_measurement()
    ds["cost"] = ds.cost.where(ds.fraction != 0.1, np.inf)
    assert {engine for f, _, engine, _ in figure.cheapest_engine(ds.sel(quantity="Z")) if f == 3} == {""}
    assert "–" in [text.get_text() for text in draw(draw_tradeoff.time_to_accuracy, ds).axes[1].texts]


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(4e-4, "0.4 ms"), (0.0123, "12 ms"), (0.553, "550 ms"), (3.2, "3 s"), (59.0, "59 s"), (150.0, "2 min"),
     (4000.0, "1 h"), (2e5, "2 d"), (4e8, "13 y")],
)  # fmt: skip
def test_durations(seconds, text):
    assert figure.duration(seconds) == text
