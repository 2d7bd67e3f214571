"""The style of docstrings and names: each rule notices its violation, and no number rises."""

import pytest
from style import baseline, public, wording

VIOLATIONS = {
    "opening": '"""Whether a gas is dilute."""\n',
    "summary of several lines": '"""Compute the pressure\nof a gas."""\n',
    "long summary": f'"""Compute {"very " * wording.LONGEST_SUMMARY}much."""\n',
    "odd word": '"""Return the error, and likewise the value."""\n',
    "argument in prose": 'def f(count):\n    """Compute it. count: of particles."""\n',
    "participle as a name": 'def shown():\n    """Return it."""\n',
    "vague variable": "found = 1\n",
}
IN_ORDER = '''"""Gases."""

LIMIT = 3
"""Largest number of gases."""


def pressure(count):
    """Compute the pressure.

    Parameters
    ----------
    count : int
        Number of particles.
    """
    number = _seed(count)
    return number


def _seed(count):
    """Return a seed."""
    return count
'''


@pytest.mark.parametrize(("rule", "text"), VIOLATIONS.items())
def test_each_rule_of_the_wording_is_noticed(tmp_path, rule, text):
    path = tmp_path / "module.py"
    path.write_text(text)
    rules = [row.rule for row in wording.departures(path)]
    assert set(rules) == {rule}


def test_a_module_in_order_has_no_departure(tmp_path):
    path = tmp_path / "module.py"
    path.write_text(IN_ORDER)
    assert wording.departures(path) == []


def test_public_names_are_those_of_the_stubs_and_their_members():
    names = public.public_names()
    assert {"gaspart.runs.entry.run", "gaspart.scene.scene.Scene.to_dict"} < set(names)
    assert "gaspart.theory.state.contact_value" in names and len(names) == len(set(names)) > 350
    assert not [name for name in names if name.rpartition(".")[2].startswith("_")]


def test_a_docstring_without_sections_is_noticed(monkeypatch):
    function = public.theory.contact_value
    monkeypatch.setattr(function, "__doc__", "Compute the value at contact.")
    rules = {row.rule for row in public.departures("gaspart.theory.state.contact_value")}
    assert {"PR01", "RT01", "EX01"} <= rules


def test_the_fields_of_a_dataclass_are_listed_in_order(monkeypatch):
    monkeypatch.setattr(public.gp.Container, "__doc__", "Box.\n\nParameters\n----------\nboundary : str\n")
    assert "dataclass" in {row.rule for row in public.departures("gaspart.scene.container.Container")}


def test_no_number_of_departures_is_above_the_baseline():
    excess = baseline.report(baseline.all_departures(), baseline.read())
    assert not excess, excess


def test_the_baseline_only_decreases():
    allowed = {"opening": {"scene": 3, "theory": 2}, "odd word": {"cli": 1}}
    counts = {"opening": {"scene": 2, "theory": 4}, "D401": {"scene": 1}}
    assert baseline.lower(counts, allowed) == {"opening": {"scene": 2, "theory": 2}}
    assert baseline.above(counts, allowed) == [("opening", "theory", 4, 2), ("D401", "scene", 1, 0)]
