"""The figures, by family: found in the folders of this package.

The folder of a family states its `TITLE`, its `CHAPTER` of the report and its `FIGURES` in `__init__.py`,
which imports nothing heavy, and holds a function of the name of each figure in `measure.py`, `claims.py` and
`figure.py`. `FIGURES` declares the settings of each figure: the kind of each key, with its meaning.

A family may also state `OF_CLAIMS`, that its figures are made of the claims of all others instead of points;
and what readers may vary on the page of the report (`report.explore`): `SERIES`, figures of an equation of
state with the dimension and the largest packing fraction to choose; `COSTS`, figures of the cost of an
accuracy. `KINDS` are kinds of figures, with their settings, to which a config gives names of its own: the
entry of such a figure has `kind`, the name of the functions. Such a family also has the functions
`caption(settings)` and, if its settings have rules of their own, `validate(figure, settings, points)`. Other
installed packages may bring families of this form (`families.installed`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from gaspart.keys import Kind
from gaspart.reproduction.families import installed

if TYPE_CHECKING:
    from gaspart.reproduction.points.point import Point

_OWN = "own"
"""The family, and its chapter, of figures to which a config gives names."""


@cache
def _packages() -> dict[str, ModuleType]:
    """Return the package of each family, in alphabetical order."""
    names = sorted(path.parent.name for path in Path(__file__).parent.glob("*/figure.py"))
    return {name: import_module(f"gaspart.reproduction.families.{name}") for name in names}


def titles() -> dict[str, str]:
    """Return the title of each family, in alphabetical order of the families."""
    return {name: package.TITLE for name, package in _packages().items()}


def title(figure: str, entry: Mapping[str, Any]) -> str:
    """Return the title of the family of a figure of a config, given its entry.

    Raises SceneError.
    """
    family, _ = functions(figure, entry)
    return titles()[family] if family in _packages() else str(installed.package(entry["kind"]).TITLE)


def chapter(family: str) -> str:
    """Return the chapter of the report in which a family stands."""
    return str(_packages().get(family, _packages()[_OWN]).CHAPTER)


@cache
def families() -> dict[str, str]:
    """Return the family of each figure."""
    return {figure: name for name, package in _packages().items() for figure in package.FIGURES}


@cache
def _kinds() -> dict[str, str]:
    """Return the family of each kind of figures."""
    return {kind: name for name, package in _packages().items() for kind in getattr(package, "KINDS", {})}


def functions(figure: str, entry: Mapping[str, Any]) -> tuple[str, str]:
    """Return the family of a figure of a config and the name of its functions there.

    `entry` is the entry of the config. The family of another installed package has the name by which it is
    imported. Raises SceneError.
    """
    kind = entry.get("kind")
    if kind is None:
        return families()[figure], figure
    return (_kinds()[kind] if kind in _kinds() else installed.family(kind)), kind


def module(family: str, part: str) -> str:
    """Return the name of a module of a family; part is `measure`, `claims` or `figure`."""
    return f"{_packages()[family].__name__ if family in _packages() else family}.{part}"


def files(family: str) -> tuple[Path, ...]:
    """Return the files of the other installed package that brings a family.

    A family of this package has none.
    """
    return () if family in _packages() else tuple(installed.files(family))


def package_of(entry: Mapping[str, Any]) -> str:
    """Return name and version of the other package that brings a kind; "" for this one."""
    kind = entry.get("kind")
    return "" if kind is None or kind in _kinds() else installed.source(kind)


def caption(settings: Mapping[str, Any]) -> str:
    """Return the caption of a figure to which a config gives a name, from its settings.

    Raises SceneError.
    """
    if settings["kind"] in _kinds():
        return str(_packages()[_kinds()[settings["kind"]]].caption(settings))
    return installed.caption(settings)


def validate(figure: str, settings: Mapping[str, Any], points: Sequence[Point]) -> None:
    """Apply a figure's own rules, beyond the kinds of its settings.

    `points` are the points that it shows. Raises SceneError.
    """
    if settings["kind"] in _kinds():
        _packages()[_kinds()[settings["kind"]]].validate(figure, settings, points)
    else:
        installed.validate(figure, settings, points)


def of_claims() -> frozenset[str]:
    """Return the figures that are made of the claims of all others."""
    stated = (package for package in _packages().values() if getattr(package, "OF_CLAIMS", False))
    return frozenset(figure for package in stated for figure in package.FIGURES)


def series() -> dict[str, tuple[int, float]]:
    """Return the dimension and the largest packing fraction for each figure of an equation of state."""
    parts = (getattr(package, "SERIES", {}) for package in _packages().values())
    return {figure: stated for part in parts for figure, stated in part.items()}


def costs() -> list[str]:
    """Return the figures of the cost of an accuracy."""
    return [figure for package in _packages().values() for figure in getattr(package, "COSTS", [])]


def settings() -> dict[str, dict[str, Kind]]:
    """Return the settings of each figure's measurement."""
    return {figure: keys for package in _packages().values() for figure, keys in package.FIGURES.items()}


def kinds() -> dict[str, dict[str, Kind]]:
    """Return the settings of each kind of figures to which a config gives a name.

    The kinds are of this package.
    """
    parts = (getattr(package, "KINDS", {}) for package in _packages().values())
    return {kind: keys for part in parts for kind, keys in part.items()}


def known_kinds() -> list[str]:
    """Return the kinds of this package, then those in other installed ones, without import."""
    return [*_kinds(), *(kind for kind in installed.kinds() if kind not in _kinds())]


def settings_of_kind(kind: str) -> dict[str, Kind]:
    """Return the settings of a kind of figures, of this or another package; raise SceneError."""
    settings: dict[str, Kind] = kinds()[kind] if kind in _kinds() else installed.package(kind).KINDS[kind]
    return settings


def stated_claims(entry: Mapping[str, Any]) -> list[Any]:
    """Return [the claims of the config] if a figure's kind has such a setting, else [].

    The function of the claims of the figure takes them in addition to its numbers.
    """
    takes = "kind" in entry and "claims" in settings_of_kind(entry["kind"])
    return [entry.get("claims", [])] if takes else []
