"""The examples of public docstrings run and give what they state."""

import doctest
import inspect
from importlib import import_module

import pytest
from style.public import public_names

import gaspart as gp

FLAGS = doctest.NORMALIZE_WHITESPACE | doctest.IGNORE_EXCEPTION_DETAIL


def item_of(name):
    """Return the function, class or member with a dotted name."""
    parts = name.split(".")
    for length in range(len(parts) - 1, 0, -1):
        try:
            item = import_module(".".join(parts[:length]))
        except ModuleNotFoundError:
            continue
        for part in parts[length:]:
            item = inspect.getattr_static(item, part) if inspect.isclass(item) else getattr(item, part)
        return item
    raise ValueError(name)


def examples_of(name):
    """Return the examples in the docstring of a public name."""
    text = inspect.getdoc(item_of(name)) or ""
    return doctest.DocTestParser().get_doctest(text, {}, name, name, 0)


def failures(test):
    """Return the report of a test's failed examples."""
    lines = []
    doctest.DocTestRunner(optionflags=FLAGS).run(test, out=lines.append)
    return "".join(lines)


WITH_EXAMPLES = [name for name in public_names() if examples_of(name).examples]


@pytest.mark.parametrize("name", WITH_EXAMPLES)
def test_an_example_gives_what_it_states(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    report = failures(examples_of(name))
    assert not report, report


def test_a_wrong_example_is_noticed():
    test = doctest.DocTestParser().get_doctest(">>> 1 + 1\n3\n", {}, "wrong", "wrong", 0)
    assert "Expected:\n    3\nGot:\n    2" in failures(test)


def test_every_function_and_class_of_the_public_names_has_an_example():
    items = [getattr(package, name) for package in (gp, gp.analysis, gp.theory) for name in package.__all__]
    called = [item for item in items if callable(item)]
    assert len(called) > 200
    assert not [item for item in called if ">>>" not in (inspect.getdoc(item) or "")]
