"""Departures of public docstrings from the numpydoc standard.

Public are the names in the stubs of `gaspart`, `gaspart.analysis` and `gaspart.theory`, and the methods and
properties of their classes.
"""

from __future__ import annotations

import inspect
import sys
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from pathlib import Path

from numpydoc.docscrape import ClassDoc
from numpydoc.validate import validate
from style.wording import Departure

import gaspart as gp
from gaspart import analysis, theory

CHECKS = {
    *("GL03", "GL06", "GL07", "GL08", "SS01", "SS02", "SS03", "SS04", "SS05", "SS06"),
    *("PR01", "PR02", "PR03", "PR04", "PR06", "PR07", "PR08", "PR09", "PR10"),
    *("RT01", "RT02", "RT03", "RT04", "RT05", "YD01", "SA02", "SA03", "EX01"),
}
"""Checks of `numpydoc.validate` that hold here."""
PACKAGES = (gp, analysis, theory)


@cache
def public_names() -> tuple[str, ...]:
    """Return the dotted names of public functions and classes, and of the members of the latter."""
    return tuple(dict.fromkeys(_names()))


def _names() -> Iterator[str]:
    for package in PACKAGES:
        for name in package.__all__:
            item = getattr(package, name)
            if inspect.isfunction(item) or inspect.isclass(item):
                yield f"{item.__module__}.{item.__name__}"  # an alias has the name of its function
            if inspect.isclass(item):
                members = [key for key, member in vars(item).items() if _is_member(key, member)]
                yield from (f"{item.__module__}.{name}.{key}" for key in members)


def _is_member(key: str, member: object) -> bool:
    """Return True for a public method or property."""
    kinds = (property, classmethod, staticmethod)
    return not key.startswith("_") and (callable(member) or isinstance(member, kinds))


def departures(name: str) -> list[Departure]:
    """Return the violations of the docstring of a public name."""
    report = validate(name)
    path, line = Path(report["file"] or ""), report["file_line"] or 0
    errors = [(code, text) for code, text in report["errors"] if code in CHECKS]
    if not _lists_fields(name):
        errors.append(("dataclass", "Parameters must list the fields in their order"))
    return [Departure(code, path, line, f"{name}: {text}") for code, text in errors]


def _lists_fields(name: str) -> bool:
    """Return True unless a dataclass has other parameters than its fields, or another order."""
    home, _, last = name.rpartition(".")
    item = getattr(sys.modules.get(home), last, None)
    if not is_dataclass(item):
        return True
    parameters = [entry.name for entry in ClassDoc(item)["Parameters"]]
    return parameters == [field.name for field in fields(item) if field.init]
