"""The least time with which all claims stay decided."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from reproduction.claims.data import claim

from gaspart.reproduction import allocation
from gaspart.reproduction import cost as budget
from gaspart.reproduction.allocation import (
    IN_HAND,
    LONGEST,
    SHORTEST,
    Demand,
    Run,
    allocate,
    shortest_multiples,
)
from gaspart.reproduction.points.points import scale_length
from gaspart.reproduction.table import Table, table

COST = {"gas/a": 1.0, "gas/b": 4.0, "gas/c": 10.0}


def test_two_points_of_one_claim_share_the_time_as_neyman_allocates_it():
    """x ~ sqrt(c / t): with parts 0.2 and 0.8, times 1 and 4, both are the same."""
    one = Demand("z", "a difference", {"gas/a": 0.2, "gas/b": 0.8}, 0.0, 2.0)
    lengths, (price,) = allocate([one], COST, {"z": ["gas/a", "gas/b"]})
    assert price == pytest.approx(5.0 / 2.0, rel=1e-3)  # the whole time, which is inverse to the variance
    assert lengths["gas/a"] == pytest.approx(lengths["gas/b"], rel=1e-3) == pytest.approx(0.5, rel=1e-3)
    other = Demand("z", "a difference", {"gas/a": 0.5, "gas/b": 0.5}, 0.0, 2.0)
    lengths, _ = allocate([other], COST, {"z": ["gas/a", "gas/b"]})
    assert lengths["gas/a"] / lengths["gas/b"] == pytest.approx(2.0, rel=1e-3)
    assert sum(0.5 / lengths[name] for name in ("gas/a", "gas/b")) == pytest.approx(2.0, rel=1e-3)


def test_all_claims_are_met_and_no_cheaper_choice_is():
    rng = np.random.default_rng(1)
    names = [f"gas/{n}" for n in range(12)]
    cost = dict(zip(names, rng.uniform(1.0, 30.0, 12), strict=True))
    demanded = []
    for k in range(20):
        parts = zip(rng.choice(names, 4, replace=False), rng.dirichlet(np.ones(4)), strict=True)
        demanded.append(Demand("z", str(k), dict(parts), 0.0, rng.uniform(1.0, 3.0)))
    lengths, _ = allocate(demanded, cost, {"z": names})

    def met(chosen):
        return all(
            sum(part / chosen[name] for name, part in one.parts.items()) <= 1.001 * one.most
            for one in demanded
        )

    total = sum(cost[name] * lengths[name] for name in names)
    assert met(lengths) and all(SHORTEST <= length <= LONGEST * 1.01 for length in lengths.values())
    for _ in range(2000):
        other = {name: length * np.exp(0.2 * rng.standard_normal()) for name, length in lengths.items()}
        other = {name: max(length, SHORTEST) for name, length in other.items()}
        assert not met(other) or sum(cost[name] * other[name] for name in names) > 0.99 * total


def test_points_that_no_row_states_have_the_length_of_their_neediest_claim():
    known = Demand("z", "known", {"gas/a": 1.0}, 0.0, 2.5)
    lengths, _ = allocate([known], COST, {"z": ["gas/a", "gas/b"], "film": ["gas/c"]})
    assert lengths == pytest.approx({"gas/a": 0.4, "gas/b": 0.4, "gas/c": 1.0}, rel=1e-3)
    unknown = Demand("z", "in part", {"gas/a": 0.5}, 0.5, 2.0)
    assert allocate([unknown], COST, {"z": ["gas/a"]})[0]["gas/a"] == pytest.approx(0.5, rel=1e-3)


def test_no_run_is_shorter_than_the_blocks_and_lags_that_its_figures_need():
    points = {"samples": 100}, {"samples": 250, "lags": 60}, {"samples": 10, "lags": 60}, {}
    planned = {"gas": {str(n): SimpleNamespace(settings=settings) for n, settings in enumerate(points)}}
    config = {"figures": {"heat": {"experiments": ["gas"], "blocks": 40}, "film": {"experiments": ["gas"]}}}
    least = shortest_multiples(config, planned)
    assert least == {"gas/0": 0.4, "gas/1": 0.24, "gas/2": 0.0, "gas/3": 0.0}
    known = Demand("z", "known", {"gas/0": 1.0}, 0.0, 5.0)
    assert allocate([known], {"gas/0": 1.0}, {"z": ["gas/0"]}, least)[0] == pytest.approx({"gas/0": 0.4})


def whole(monkeypatch, **measurements):
    """Return a run without lengths whose measurements are given."""
    monkeypatch.setattr(Run, "measurement", lambda run, figure: measurements[str(run.results)])
    return [Run(Path(name), {}) for name in measurements]


class Named:
    experiment = "gas"

    def __init__(self, name):
        self.name = name


def test_parts_of_a_variance_are_found_by_the_rows_of_a_table(monkeypatch):
    points = [Named("a"), (Named("b"), 1.0), {"both": [Named("c"), Named("d")]}]
    data = table("point", points, lambda point: {"z": (1.0, 0.1)})
    assert list(data["point_made_of"].values) == ["gas/a", "gas/b", "gas/c\ngas/d"]
    assert "x_made_of" not in table("x", [1, 2], lambda number: {"y": number})
    known = table("x", [{"y": 1.0}], dict, of=[points])
    assert list(known["x_made_of"].values) == ["gas/a\ngas/b\ngas/c\ngas/d"]

    def stated(figure, block, dataset):
        z = Table(dataset, "point").z
        return [claim(float(z.value[0]), float(np.sqrt(z.error[0] ** 2 + 3.0 * z.error[2] ** 2)))]

    monkeypatch.setattr(budget, "claims_of", stated)
    required = claim(1.0, 0.2).required
    half = data.assign(z_error=data.z_error * required / 0.4)
    (demand,) = allocation.demands("z", {}, whole(monkeypatch, first=half))
    assert demand.parts == pytest.approx({"gas/a": 0.25, "gas/c": 0.375, "gas/d": 0.375})
    assert demand.rest == 0.0 and demand.most == pytest.approx(4.0 / IN_HAND)

    # A second run, with half of the length at point a, has three times the variances: claims need the mean.
    first, second = whole(monkeypatch, first=half, second=half.assign(z_error=half.z_error * np.sqrt(3.0)))
    (demand,) = allocation.demands("z", {}, [first, Run(second.results, {"gas/a": 0.5})])
    needed = {"gas/a": (1.0 + 1.5) / 32.0, "gas/c": 3.0 / 16.0, "gas/d": 3.0 / 16.0}
    assert demand.most == pytest.approx(1.0 / IN_HAND / sum(needed.values()))
    assert demand.parts == pytest.approx({name: part / sum(needed.values()) for name, part in needed.items()})


@pytest.mark.parametrize(("first", "second", "number"), [(2.0, 3.0, 0), (0.5, 3.0, 1), (0.5, 0.5, 1)])
def test_a_claim_that_no_run_decided_is_not_demanded(monkeypatch, first, second, number):
    data = table("point", [Named("a")], lambda point: {"z": (1.0, 0.1)})

    def stated(figure, block, dataset):
        return [claim(1.0, claim(1.0, 0.2).required * float(dataset.z_error[0]))]

    monkeypatch.setattr(budget, "claims_of", stated)
    errors = {"first": first, "second": second}
    runs = whole(
        monkeypatch, **{name: data.assign(z_error=data.z_error * 0 + e) for name, e in errors.items()}
    )
    demands = allocation.demands("z", {}, runs)
    assert len(demands) == number
    for demand in demands:
        needed = IN_HAND * (first**2 + second**2) / 2.0
        assert demand.most == pytest.approx(1.0 / min(needed, LONGEST))


def test_rows_of_replicas_have_parts_too(monkeypatch):
    scatter = np.array([[1.0, 2.0, 4.0], [1.0, 1.5, 2.5]])
    data = table(
        "gas", [Named("a"), Named("b")], lambda one: {"z": scatter["ab".index(one.name)]}, inner=("replica",)
    )

    def stated(figure, block, dataset):
        a, b = dataset.z.values.var(axis=1, ddof=1) / 3.0
        return [claim(1.0, 1e-6 * float(np.sqrt(a + b)))]

    monkeypatch.setattr(budget, "claims_of", stated)
    (demand,) = allocation.demands("z", {}, whole(monkeypatch, first=data))
    a, b = scatter.var(axis=1)
    assert demand.parts == pytest.approx({"gas/a": a / (a + b), "gas/b": b / (a + b)}) and demand.rest == 0.0


def test_a_multiple_is_one_of_replicas_then_of_the_length_at_the_same_interval():
    gas = {"collisions_per_particle": 4000, "equilibration": 200, "samples": 100, "replicas": 2}
    assert scale_length("simulate", gas, 0.5) == {**gas, "collisions_per_particle": 2000.0, "samples": 50}
    assert scale_length("simulate", gas, 0.1)["samples"] == 32
    many = {"duration": 60.0, "samples": 12, "replicas": 24}  # proceeds: no equilibration
    assert scale_length("simulate", many, 0.5) == {**many, "replicas": 12}
    assert scale_length("simulate", many, 0.1) == {**many, "replicas": 6}
    lags = {"duration": 100.0, "equilibration": 1.0, "samples": 800, "lags": 8, "frames": 100}
    made = scale_length("simulate", lags, 0.333)
    assert made["samples"] / made["duration"] == 8.0 and made["samples"] == 8 * made["frames"] == 272
    timed = {"steps": 450, "samples": 9}
    assert scale_length("measure_cost", timed, 0.1) == {"steps": 150, "samples": 3}
    assert scale_length("fill", {"attempts": 500, "replicas": 32}, 0.5) == {"attempts": 500, "replicas": 16}
    assert scale_length("simulate", gas, 1.0) == gas
