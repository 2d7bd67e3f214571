"""The figures, by family: found in the folders of this package.

The folder of a family states its `TITLE`, its `CHAPTER` of the report and its `FIGURES` in `__init__.py`,
which imports nothing heavy, and holds a function of the name of each figure in `measure.py`, `claims.py` and
`figure.py`. `FIGURES` declares the settings of each figure: the kind of each key, with its meaning.

A family may also state `OF_CLAIMS`, that its figures are made of the claims of all others instead of points;
and what readers may vary on the page of the report (`report.explore`): `SERIES`, figures of an equation of
state with the dimension and the largest packing fraction to choose; `COSTS`, figures of the cost of an
accuracy. `KINDS` are kinds of figures, with their settings, to which a config gives names of its own: the
entry of such a figure has `kind`, the name of the functions.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

from gaspart.kinds import Kind


@cache
def _packages() -> dict[str, ModuleType]:
    """The package of each family, in alphabetical order."""
    names = sorted(path.parent.name for path in Path(__file__).parent.glob("*/figure.py"))
    return {name: import_module(f"gaspart.reproduction.families.{name}") for name in names}


def titles() -> dict[str, str]:
    """The title of each family, in alphabetical order of the families."""
    return {name: package.TITLE for name, package in _packages().items()}


def chapters() -> dict[str, str]:
    """The chapter of the report in which each family stands."""
    return {name: package.CHAPTER for name, package in _packages().items()}


@cache
def families() -> dict[str, str]:
    """The family of each figure."""
    return {figure: name for name, package in _packages().items() for figure in package.FIGURES}


@cache
def _kinds() -> dict[str, str]:
    """The family of each kind of figures."""
    return {kind: name for name, package in _packages().items() for kind in getattr(package, "KINDS", {})}


def functions(figure: str, entry: Mapping[str, Any]) -> tuple[str, str]:
    """The family of a figure of a config and the name of its functions there. entry: that of the config."""
    kind = entry.get("kind")
    return (families()[figure], figure) if kind is None else (_kinds()[kind], kind)


def of_claims() -> frozenset[str]:
    """The figures that are made of the claims of all others."""
    stated = (package for package in _packages().values() if getattr(package, "OF_CLAIMS", False))
    return frozenset(figure for package in stated for figure in package.FIGURES)


def series() -> dict[str, tuple[int, float]]:
    """The dimension and the largest packing fraction to choose of each figure of an equation of state."""
    parts = (getattr(package, "SERIES", {}) for package in _packages().values())
    return {figure: stated for part in parts for figure, stated in part.items()}


def costs() -> list[str]:
    """The figures of the cost of an accuracy."""
    return [figure for package in _packages().values() for figure in getattr(package, "COSTS", [])]


def settings() -> dict[str, dict[str, Kind]]:
    """The settings of each figure's measurement."""
    return {figure: keys for package in _packages().values() for figure, keys in package.FIGURES.items()}


def kinds() -> dict[str, dict[str, Kind]]:
    """The settings of each kind of figures to which a config gives a name."""
    parts = (getattr(package, "KINDS", {}) for package in _packages().values())
    return {kind: keys for part in parts for kind, keys in part.items()}
