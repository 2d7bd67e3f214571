"""An engine that nothing but its class knows: advice, costs and prices know it by what it states itself."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import pytest

import gaspart as gp
from gaspart.accuracy import pilot, plan, table
from gaspart.accuracy.advisers import ADVISERS
from gaspart.accuracy.of_engine import Adviser, Candidate
from gaspart.accuracy.option import candidates
from gaspart.accuracy.table import price_of
from gaspart.accuracy.target import Target
from gaspart.cli.advise import _lines
from gaspart.engines import ENGINES, EventDriven
from gaspart.reproduction import cost
from gaspart.theory.conditions import even_conditions

GAS = gp.Scene(gp.Container((12.0,) * 3, "periodic"), [gp.Species(200, 0.5, temperature=1.0)])


@dataclass(frozen=True)
class Fourth(EventDriven):
    """The event-driven engine under another name, with an error that it states."""

    name = "fourth"
    title = "fourth"
    reference = False

    def bias(self, scene, kind):
        return 1e-3


class FourthAdviser(Adviser):
    limitations = "honesty"

    def candidate(self, asked):
        return Candidate(self.engine, discretisation=1e-3)

    def describe(self):
        return "fourth engine"


@pytest.fixture(autouse=True)
def fourth(tmp_path, monkeypatch):
    """The engine, with rows of the table that are those of the event-driven one at a tenth of the cost."""
    monkeypatch.setattr(pilot, "cache_directory", lambda: tmp_path / "cache")
    monkeypatch.setitem(ENGINES, "fourth", Fourth)
    monkeypatch.setitem(ADVISERS, Fourth, FourthAdviser)
    timed = [row for row in table.read() if row["engine"] == "event" and row["quantity"] == "seconds"]
    rows = table.read() + tuple({**row, "engine": "fourth", "value": 0.1 * row["value"]} for row in timed)
    monkeypatch.setattr(table, "read", lambda: rows)
    table._curve.cache_clear()
    yield
    table._curve.cache_clear()


def test_it_is_advised_by_the_table():
    rough, fine = (plan.plan_from_table(GAS, "Z", accuracy) for accuracy in (0.01, 1e-4))
    assert isinstance(rough.best.engine, Fourth) and rough.best.bias == 1e-3
    assert isinstance(fine.best.engine, EventDriven) and fine.best.engine.reference
    assert fine.refused["fourth"] == "no setting is known to be as accurate at this density"
    assert _lines(rough, "gas.yaml")[0] == "engine            fourth engine"


def test_it_is_a_candidate_of_pilots():
    made, refused = candidates(Target(GAS, "vacf"), 0.01, even_conditions(GAS, 1.0))
    assert "fourth" not in refused
    (own,) = [one for one in made if isinstance(one.engine, Fourth)]
    assert own.bias == 1e-3
    planned = plan.plan_from_pilots(GAS, "temperature", 0.2, pilot_seconds=0.1)
    assert {"event", "fourth"} <= {one.engine.name for one in (*planned.options, *planned.pilots)}
    assert any("fourth engine" in line for line in _lines(planned, "gas.yaml"))


def test_its_costs_are_predicted(monkeypatch):
    monkeypatch.setattr(cost, "_speed", lambda gas, engine, precision: 1.0)
    times = SimpleNamespace(duration=10.0)
    points = [
        SimpleNamespace(job="simulate", scene=GAS, engine=engine, schedule=times, replicas=1)
        for engine in (EventDriven(), Fourth())
    ]
    event, own = map(cost.predicted_seconds, points)
    assert own == pytest.approx(0.1 * event)
    assert price_of(GAS, Fourth(), "Z").ratios == {}


def test_dsmc_is_predicted_by_its_own_rows(monkeypatch):
    """A third of the time of the event-driven engine in a dilute gas, which it was taken to cost."""
    monkeypatch.setattr(cost, "_speed", lambda gas, engine, precision: 1.0)
    dilute = replace(GAS, container=gp.Container((60.0,) * 3, "periodic"))
    times = SimpleNamespace(duration=10.0)
    found = [
        cost.predicted_seconds(
            SimpleNamespace(job="simulate", scene=dilute, engine=engine, schedule=times, replicas=1)
        )
        for engine in (gp.EventDriven(), gp.DSMC())
    ]
    each = [
        table.seconds(3, dilute.packing_fraction, name, step=step)
        for name, step in (("event", 0.0), ("dsmc", 1.0))
    ]
    assert found[1] / found[0] == pytest.approx(each[1] / each[0])
