"""Every public name is documented, and the examples of public docstrings run and give what they state."""

import doctest
import inspect
from dataclasses import fields, is_dataclass

import pytest

import gaspart as gp

FLAGS = doctest.NORMALIZE_WHITESPACE | doctest.IGNORE_EXCEPTION_DETAIL


def public_items():
    """Return the functions and classes in the stubs, and the public members of the latter, by name."""
    items = {"gaspart.analysis": gp.analysis}
    for package in (gp, gp.analysis, gp.theory):
        named = [(name, getattr(package, name)) for name in package.__all__]
        for name, item in named:
            if not inspect.isfunction(item) and not inspect.isclass(item):
                continue
            items[f"{package.__name__}.{name}"] = item
            for key, member in vars(item).items() if inspect.isclass(item) else ():
                if not key.startswith("_") and callable(getattr(member, "__func__", member)):
                    items[f"{package.__name__}.{name}.{key}"] = member
    return items


ITEMS = public_items()


def failures(text, name):
    """Return the report of the examples in a docstring that fail."""
    lines = []
    test = doctest.DocTestParser().get_doctest(text, {}, name, name, 0)
    doctest.DocTestRunner(optionflags=FLAGS).run(test, out=lines.append)
    return "".join(lines)


LONG = {f"gaspart.{name}" for name in ("play", "ImpulseTally", "PairImpulseTally", "StressTally", "compress")}
LONG |= {"gaspart.analysis.heat_flux"}
"""Examples that compile kernels of their own."""
EXAMPLES = [name for name, item in ITEMS.items() if ">>>" in (inspect.getdoc(item) or "")]


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.thorough if name in LONG else ()) for name in EXAMPLES]
)
def test_an_example_gives_what_it_states(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    report = failures(inspect.getdoc(ITEMS[name]), name)
    assert not report, report


def test_a_wrong_example_is_noticed():
    assert "Expected:\n    3\nGot:\n    2" in failures(">>> 1 + 1\n3\n", "wrong")


def test_every_public_name_is_documented():
    assert len(ITEMS) > 200
    assert [name for name, item in ITEMS.items() if not inspect.getdoc(item)] == []


def test_fields_are_documented_by_their_declarations():
    classes = [one for one in ITEMS.values() if is_dataclass(one)]
    declared = [one for one in classes if any("kind" in item.metadata for item in fields(one))]
    assert len(declared) >= 17
    for one in declared:
        text = inspect.getdoc(one)
        assert text.count("\nParameters\n") == 1
        for item in fields(one):
            assert f"\n{item.name} : " in text and item.metadata["kind"]["description"] in text
