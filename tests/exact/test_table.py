"""Each observable in each kind of scene: its exact value, or refused, or stated why none is known."""

from pathlib import Path

import pytest
from exact import rules, table, values
from exact.kinds import kinds
from exact.known import RULES

from gaspart.analysis.observables import OBSERVABLES
from gaspart.scene.faces import FACE_KINDS
from gaspart.scene.features import FEATURES
from gaspart.scene.scene import Scene

WRONG = Path(__file__).with_name("known_wrong.txt")
"""Cells that are known to be wrong, a line `scene engine observable` each: to be repaired."""
ELSEWHERE = {
    "viscoelasticity": "dissipates: in no equilibrium",
    "contact_duration": "dissipates: in no equilibrium",
    "thermostat": "drives the gas: in no equilibrium",
    "thermal_walls": "a plate at a temperature: statics are those of a hard plate (kind plate)",
    "sticky": "bodies on a face: tests/kernels/obstacles/test_well.py",
    "vibrating": "drives the gas: in no equilibrium",
    "vibrations": "energy of its own: tests/engines/test_vibration.py",
    "ramp": "heat flows: in no equilibrium",
}
"""Features without a kind of scene, and why none has an exact value."""


def known_wrong():
    """Return the cells of the file."""
    lines = WRONG.read_text(encoding="utf-8").splitlines()
    return {tuple(line.split()) for line in lines if line and not line.startswith("#")}


@pytest.mark.parametrize(("name", "engine"), table.names(), ids=[" ".join(one) for one in table.names()])
def test_observables_have_their_exact_values(name, engine):
    found = table.cells(name, engine)
    wrong = {(cell.scene, cell.engine, cell.observable): cell for cell in found if cell.state == "wrong"}
    listed = {cell for cell in known_wrong() if cell[:2] == (name, engine)}
    repaired = listed - set(wrong)
    assert not repaired, f"not wrong any more, to be taken off {WRONG.name}: {sorted(repaired)}"
    new = [
        f"{key[2]}: {cell.text} ({cell.deviation:.1f})" for key, cell in wrong.items() if key not in listed
    ]
    assert not new, "\n".join(new)


@pytest.mark.thorough
@pytest.mark.parametrize("seed", (11, 12))
@pytest.mark.parametrize(("name", "engine"), table.names(), ids=[" ".join(one) for one in table.names()])
def test_longer_runs_have_the_exact_values(name, engine, seed):
    if kinds()[name].many_sizes:
        pytest.skip("the right values are of the radii of one seed")
    wrong = [cell for cell in table.cells(name, engine, seed, 4.0) if cell.state == "wrong"]
    wrong = [cell for cell in wrong if (name, engine, cell.observable) not in known_wrong()]
    assert not wrong, "\n".join(f"{cell.observable}: {cell.text}" for cell in wrong)


def test_no_cell_is_empty():
    assert set(rules.UNDEFINED) >= set(OBSERVABLES)
    assert set(RULES) <= set(rules.UNDEFINED)
    for kind in kinds().values():
        for observable in OBSERVABLES:
            stated = rules.undefined(observable, kind) or rules.unknown(observable, kind)
            assert stated or table.right_parts(observable, kind), (kind.name, observable)


def test_the_sampled_values_are_of_the_scenes():
    assert {name: entry["recipe"]["scene"] for name, entry in values.stored().items()} == {
        name: kind.scene for name, kind in kinds().items()
    }


def test_every_feature_has_a_kind_of_scene():
    present = {f for kind in kinds().values() for f in Scene.from_dict(kind.scene).features}
    assert present | set(ELSEWHERE) == set(FEATURES)
    assert not present & set(ELSEWHERE)
    assert set(FACE_KINDS) <= set(FEATURES)


def test_tests_elsewhere_exist():
    named = [text.rpartition(": ")[2] for text in ELSEWHERE.values() if "tests/" in text]
    assert len(named) == 2
    for path in named:
        assert "def test_" in (Path(__file__).parents[2] / path).read_text(encoding="utf-8")


def test_every_observable_has_a_value_somewhere():
    valued = {
        observable
        for kind in kinds().values()
        for observable in OBSERVABLES
        if not rules.undefined(observable, kind) and not rules.unknown(observable, kind)
    }
    assert set(OBSERVABLES) - valued <= set(rules.LONG)


def test_listed_cells_exist():
    runs = set(table.names())
    assert all((name, engine) in runs and one in OBSERVABLES for name, engine, one in known_wrong())
