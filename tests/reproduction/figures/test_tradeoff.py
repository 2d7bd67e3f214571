"""Orders of convergence of made-up comparisons; costs and errors of choices of engines, and of small runs."""

import math

import numpy as np
import pytest
import xarray as xr
from reproduction.made import simulated

import gaspart as gp
from gaspart import theory
from gaspart.accuracy.estimates import Component
from gaspart.accuracy.of_engine import Candidate
from gaspart.accuracy.option import Option
from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.figures import _flows as flows
from gaspart.reproduction.figures import _tradeoff as tradeoff
from gaspart.reproduction.figures import speed_accuracy, time_to_accuracy
from gaspart.reproduction.figures._tradeoff import ENGINES, PARTS, Choice
from gaspart.reproduction.points.point import Point
from gaspart.scene.facts import Gas

STEPS = np.array([0.32, 0.16, 0.08, 0.04])
SETTINGS = {"order_up_to": 0.2, "cells": []}
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


def written(folder, made):
    """Points of (job, settings, dataset), with their results in a folder."""
    points = []
    for n, (job, settings, dataset) in enumerate(made):
        points.append(Point("gas", f"n={n}", job, settings, str(folder), 1))
        (folder / "gas").mkdir(exist_ok=True)
        dataset.to_netcdf(points[-1].path)
    return points


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    """Two settings of a dilute gas."""
    made = [
        ("compare", {"passes": 4}, comparison(2.0, 3.0, 0)),
        ("compare", {"passes": 1, "rewind": False}, comparison(1.0, 1.0, 1, rewind=0, passes=1)),
        ("measure_cost", {"passes": 4}, timing("step", 2.0 * SECONDS * CONTACTS * (1.0 + 0.01 / STEPS))),
        ("measure_cost", {"engine": "event"}, timing("event", [SECONDS * CONTACTS])),
    ]
    return speed_accuracy.measure(written(tmp_path_factory.mktemp("points"), made), SETTINGS)


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
        "bias_error": [error / 100.0, step**2 / 30.0],
        "bias_freedom": np.full((2, 5), 23.0),
    }
    (order, order_error, _), (second, second_error, freedom) = speed_accuracy.error_orders(row, 0.2)
    assert np.isnan(order) and np.isnan(order_error)
    assert second == pytest.approx(2.0) and second_error < 0.05 and freedom == 23.0
    few = row | {"bias_freedom": np.full((2, 5), 2.0)}  # 30 standard errors of three snapshots
    assert np.isnan(speed_accuracy.error_orders(few, 0.2)).all()


def test_a_pressure_error_is_weighed_by_its_part_in_z(dataset):
    row = dataset.isel(row=0).sel(observable="Z")
    assert row.bias.values[:3] == pytest.approx(-(STEPS[:3] ** 3) / 3.0, rel=1e-2)


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
    found = speed_accuracy.measure(points, SETTINGS).squeeze("dsmc")
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
    dataset = time_to_accuracy.measure(points, settings).squeeze()
    event = dataset.sel(engine="event", observable="Z")
    assert event.measured.values == pytest.approx(event.model.values, rel=1e-6)  # timed by itself
    assert float(event.measured[1] / event.measured[0]) == pytest.approx(1e4, rel=0.35)  # but for settling
    steps = dataset.sel(engine="step", observable="Z", accuracy=0.01)
    assert float(steps.measured) > 2.0 * float(event.measured[0])
    assert (dataset.regret.sel(observable="Z") == 1.0).all()
    mapped = dataset.cost.sel(quantity="Z", solver="event").values
    assert mapped == pytest.approx(event.measured.values, rel=1e-6)
    assert np.isnan(dataset.cost.sel(quantity="heat_flux")).all()


# Choices of engines.


def choice(model=0.0, discretisation=0.0, least=0.5, **changes):
    """One CPU second a unit of time, and a relative variance of 1e-4 of a run of this length."""
    candidate = Candidate(gp.EventDriven(), model, discretisation)
    noise = Component(1.0, 1.0, 1.0, 1.96**2 * 1e-4, freedom=math.inf)
    limits = least + 1.0, math.inf, 1.0, 0.0
    option = Option(candidate, candidate.bias, noise, 1.0, 1.0, *limits)
    return Choice(option, **{"decay": 0.1, "uncertainty": 0.01, "finite_size": 1e-4} | changes)


def test_parts_fill_the_accuracy():
    parts = choice(model=0.0003, discretisation=0.0002).parts(0.001)
    assert tuple(parts) == PARTS
    assert parts["model"] + parts["discretisation"] + parts["noise"] == pytest.approx(0.001)
    assert parts["equilibration"] == pytest.approx(math.exp(-10.0) * 0.1 / (1e-4 * (1.96 / 0.0005) ** 2))
    out_of_reach = choice(model=0.002).parts(0.001)
    assert out_of_reach["noise"] == out_of_reach["equilibration"] == 0.0
    assert choice(decay=0.0).parts(0.001)["equilibration"] == 0.0


def test_the_cheapest_choice_is_the_least_biased_one_where_none_reaches():
    coarse, fine = choice(discretisation=0.01), choice(discretisation=0.001, least=5.0)
    costs, parts = np.zeros((3, len(ENGINES), 2)), np.zeros((3, len(ENGINES), len(PARTS)))
    time_to_accuracy.enter(costs, parts, [coarse, fine], [0.05, 0.005, 0.0005])
    assert parts[:, 0, 1].tolist() == [0.01, 0.001, 0.001] and costs[2, 0, 0] == math.inf


def test_what_the_size_leaves_falls_with_it():
    small, large = (Gas(3, 0.3, count, 1.0, 1.0) for count in (1000, 8000))
    for name in tradeoff.OBSERVABLES:
        assert 0.0 < tradeoff.finite_size(large, name) < tradeoff.finite_size(small, name) < 0.01
    (wave, lost), (speeds, whole) = tradeoff.decay_of(small, "D"), tradeoff.decay_of(small, "Z")
    assert wave > speeds and whole == 1.0 and 0.05 < lost < 0.2


def test_steps_of_a_fifth_of_a_free_time():
    """16 / (75 pi) is for the viscosity, 4 / (27 pi) for D, of (c step / l)^2."""
    step = 0.2 / float(theory.collision_rate(0.001, 3))
    moved = 0.2 * math.sqrt(math.pi) / 2.0
    expected = 4.0 / (27.0 * math.pi) * moved**2
    error = tradeoff.error_of_steps(gp.DSMC(step), Gas(3, 0.001, 4000, 1.0, 1.0))
    assert error == pytest.approx(expected, rel=0.01)


SOLVERS = {
    "event": gp.EventDriven(), "step": gp.TimeStepped(0.1), "boltzmann": gp.DSMC(0.1),
    "enskog": gp.DSMC(0.1, model="enskog"),
}  # fmt: skip


def flow(engine, value, error=0.001, bounds=(0.0, 0.0), **changes):
    numbers = {
        "observable": "heat_flux", "packing_fraction": 0.1, "count": 500, "variance": 2.0,
        "contacts": 1000.0, "decay": 3.0, "shortest": 3.0,
    }  # fmt: skip
    candidate = Candidate(SOLVERS[engine], *bounds)
    return flows.Flow(candidate=candidate, value=Estimate(value, error, 20.0), **numbers | changes)


def test_an_error_is_bounded_by_theory_or_by_what_is_seen():
    event = flow("event", 1.0)
    seen = 0.02 + 2.0 * math.hypot(0.001 / 1.02, 0.001) * 1.02
    assert flows.errors_of(flow("boltzmann", 1.02, bounds=(0.3, 0.005)), event) == pytest.approx(
        (seen - 0.005, 0.005), rel=1e-3
    )
    assert flows.errors_of(flow("boltzmann", 1.02, bounds=(0.004, 0.001)), event) == (0.004, 0.001)
    assert flows.errors_of(flow("step", 1.02, bounds=(0.0, math.inf)), event)[1] == pytest.approx(
        seen, rel=1e-3
    )
    assert flows.errors_of(event, event) == (0.0, 0.0)


def test_a_flow_costs_its_variance_and_settles_first():
    speeds = {"event": Estimate(1e-3, 1e-5), "enskog": Estimate(2e-3, 1e-5)}
    made = list(
        flows.flow_choices([flow("event", 1.0), flow("enskog", 1.0), flow("step", 1.0)], 1000, speeds)
    )
    assert [tradeoff.solver_of(one.option.engine) for one in made] == ["event", "enskog"]
    for one, seconds in zip(made, (1e-3, 2e-3), strict=True):
        settling = flows.SETTLED * 3.0 * 2.0 * seconds  # of twice as many particles
        assert one.option.cost(10.0) == pytest.approx(3.0 * 2.0 * seconds + settling)  # the shortest run
        assert one.option.cost(1e-3) == pytest.approx(2.0 * seconds * 1.96**2 / 1e-3**2 + settling)
        assert one.uncertainty == pytest.approx(1e-5 / seconds)


def test_rarer_collisions_make_speeds_relax_later():
    assert flows.relaxation_time(1.0) == pytest.approx(1.618, abs=0.002)
    assert flows.relaxation_time(2.0) > 1.2 * flows.relaxation_time(1.0)


def point(folder, **settings):
    """A point whose runs have been made."""
    basic = {"dimension": 3, "radius": 0.5, "boundary": "periodic", "packing_fraction": 0.1}
    return simulated(Point("gas", "point", "simulate", basic | settings, str(folder), 1))


def test_relaxation_of_a_small_gas(tmp_path):
    run = {"count": 400, "speed": math.sqrt(3.0), "collisions_per_particle": 3, "samples": 12, "replicas": 4}
    made = point(tmp_path, engine="event", **run)
    found = flows.relaxation_of(made)
    assert abs((found.value - flows.relaxation_time(1.0)).deviation) < 4.0
    rate = float(theory.collision_rate(0.1, 3))
    assert found.contacts == pytest.approx(0.5 * 400 * rate, rel=0.1)
    assert found.candidate.bias == 0.0 and found.decay == 0.0


def test_cells_of_a_small_gas(tmp_path):
    """With one cell nothing is lost; with 27 of 15 the Enskog model loses collisions."""
    gas = {
        "count": 400, "temperature": 1.0, "exact_temperature": True, "arrangement": "lattice",
        "engine": "dsmc", "model": "enskog",
        "collisions_per_particle": 1000, "equilibration": 10, "samples": 50,
    }  # fmt: skip
    one = tradeoff.Cells(point(tmp_path / "one", cells_per_side=1, **gas))
    many = tradeoff.Cells(point(tmp_path / "many", cells_per_side=3, **gas))
    assert abs((one.rate - 1.0).deviation) < 4.0 and one.bound == 0.0
    assert 1.0 - many.bound < many.rate.value < 1.0 - 4.0 * many.rate.error
    assert many.error > many.bound / 4.0
    assert np.isfinite(list(one.noise.values())).all()
