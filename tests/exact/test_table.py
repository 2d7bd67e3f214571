"""Each observable in each kind of scene: its exact value, or refused, or stated why none is known."""

from pathlib import Path

import pytest
from exact import rules, table, values
from exact.choice import is_canonical, sample
from exact.kinds import kinds
from exact.known import RULES
from exact.runs import SEED, engines

from gaspart.analysis.observables import OBSERVABLES
from gaspart.engines import ENGINES
from gaspart.scene.faces import FACE_KINDS
from gaspart.scene.features import FEATURES
from gaspart.scene.scene import Scene

WRONG = Path(__file__).with_name("known_wrong.txt")
"""Cells that are known to be wrong, a line `scene engine observable` each: to be repaired."""
SAMPLE, MORE = 10, 4
"""Number of runs in the usual tests, and of further ones of engines that a change touches."""
FINER = 5
"""Parts of the interval between frames of a kind."""
ELSEWHERE = {
    "viscoelasticity": "dissipates: in no equilibrium",
    "contact_duration": "dissipates: in no equilibrium",
}
"""Features without a kind of scene, and why none has an exact value."""


def known_wrong():
    """Return the cells of the file."""
    lines = WRONG.read_text(encoding="utf-8").splitlines()
    return {tuple(line.split()) for line in lines if line and not line.startswith("#")}


def check(name, engine, *run):
    """Raise AssertionError unless the wrong cells of a run are the listed ones."""
    found = table.cells(name, engine, *run)
    wrong = {
        cell.observable: f"{cell.text} ({cell.deviation:.1f})" for cell in found if cell.state == "wrong"
    }
    listed = [line[2] for line in known_wrong() if line[0] == name and line[1] in (engine, "*")]
    new = [f"{observable}: {text}" for observable, text in wrong.items() if observable not in listed]
    assert not new, "\n".join(new)


@pytest.mark.thorough
@pytest.mark.parametrize("line", [line for line in known_wrong() if line[1] != "*"], ids=" ".join)
def test_listed_cells_are_wrong(line):
    name, engine, observable = line
    assert table.cell_of(observable, kinds()[name], engine).state == "wrong", "take it off the list"


RUNS = pytest.mark.parametrize(
    ("name", "engine"), table.names(), ids=[" ".join(one) for one in table.names()]
)


@pytest.mark.parametrize(
    ("name", "engine"), sample([run for run in table.names() if is_canonical(*run)], SAMPLE, MORE)
)
def test_a_sample_of_runs_has_the_exact_values(name, engine):
    check(name, engine)


@pytest.mark.thorough
@RUNS
def test_observables_have_their_exact_values(name, engine):
    check(name, engine)


@pytest.mark.thorough
@RUNS
def test_finer_intervals_between_frames_have_the_exact_values(name, engine):
    check(name, engine, SEED + 1, 1.0, FINER)


@pytest.mark.thorough
@pytest.mark.parametrize("seed", (11, 12))
@pytest.mark.parametrize("name", kinds())
def test_longer_runs_have_the_exact_values(name, seed):
    check(name, "event", seed, 4.0)


def test_no_cell_is_empty():
    assert set(rules.UNDEFINED) >= set(OBSERVABLES)
    assert set(RULES) <= set(rules.UNDEFINED)
    for name, engine in table.names():
        kind = kinds()[name].under(engines(name)[engine].equation)
        for observable in OBSERVABLES:
            stated = (
                table.unmeasured(observable, kind, engine)
                or rules.undefined(observable, kind)
                or rules.unknown(observable, kind)
            )
            assert stated or table.right_parts(observable, kind), (name, engine, observable)


def test_the_sampled_values_are_of_the_scenes():
    assert {name: entry["recipe"]["scene"] for name, entry in values.stored().items()} == {
        name: kind.scene for name, kind in kinds().items()
    }


def test_every_feature_has_a_kind_of_scene():
    present = {f for kind in kinds().values() for f in Scene.from_dict(kind.scene).features}
    assert present | set(ELSEWHERE) == set(FEATURES)
    assert not present & set(ELSEWHERE)
    assert set(FACE_KINDS) <= set(FEATURES)


@pytest.mark.parametrize("engine", ENGINES)
def test_every_feature_of_an_engine_has_a_run(engine):
    runs = {"dsmc": ("dsmc", "enskog")}.get(engine, (engine,))
    present = {
        feature
        for kind in kinds().values()
        if set(runs) & set(engines(kind.name))
        for feature in Scene.from_dict(kind.scene).features
    }
    assert present >= ENGINES[engine].models - set(ELSEWHERE)


def test_every_observable_has_a_value_somewhere():
    valued = {
        observable
        for kind in kinds().values()
        for observable in OBSERVABLES
        if not rules.undefined(observable, kind) and not rules.unknown(observable, kind)
    }
    assert set(OBSERVABLES) - valued <= set(rules.LONG)


def test_listed_cells_exist():
    runs = {*table.names(), *((name, "*") for name in kinds())}
    assert all((name, engine) in runs and one in OBSERVABLES for name, engine, one in known_wrong())
