"""Registry of the families of figures, found in the folders of this package.

Each family is a folder. Its `__init__.py` states the `TITLE`, the `CHAPTER` of the report, and the `FIGURES`.
It imports nothing that takes long. The modules `measure.py`, `claims.py` and `figure.py` each have a function
with the name of each figure. `FIGURES` declares the settings of each figure: the kind of each key, with its
meaning.

A family may also state `OF_CLAIMS`: its figures are then made from the claims of all other figures, instead
of points. Two more constants define choices of the reader on the page of the report (`report.explore`).
`SERIES` are figures of an equation of state, with dimension and largest packing fraction. `COSTS` are figures
of the cost of an accuracy. `KINDS` are kinds of figures, with their settings; a config chooses the names of
such figures. The config entry of such a figure has `kind`, the name of the functions. Such a family also has
the function `caption(settings)`. If its settings have rules of their own, it has `validate(figure, settings,
points)`. Other installed packages may define families of this form (`families.installed`).
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
from gaspart.reproduction.figure import Parts

if TYPE_CHECKING:
    from gaspart.reproduction.points.point import Point

_OWN = "own"
"""Family, and chapter, of figures whose names a config chooses."""


@cache
def _packages() -> dict[str, ModuleType]:
    """Return the package of each family, in alphabetical order."""
    here = Path(__file__).parent
    names = {path.parent.name: "families" for path in here.glob("*/figure.py")}
    names |= {path.stem: "figures" for path in here.parent.glob("figures/[a-z]*.py")}
    return {name: import_module(f"gaspart.reproduction.{names[name]}.{name}") for name in sorted(names)}


def titles() -> dict[str, str]:
    """Return the title of each family, in alphabetical order of the families."""
    return {name: package.TITLE for name, package in _packages().items()}


def title(figure: str, entry: Mapping[str, Any]) -> str:
    """Return the title of the family of a figure from the figure's config entry.

    Raises SceneError.
    """
    family, _ = functions(figure, entry)
    return titles()[family] if family in _packages() else str(installed.package(entry["kind"]).TITLE)


def chapter(family: str) -> str:
    """Return the chapter of the report that contains a family."""
    return str(_packages().get(family, _packages()[_OWN]).CHAPTER)


@cache
def families() -> dict[str, str]:
    """Return the family of each figure."""
    return {figure: name for name, package in _packages().items() for figure in package.FIGURES}


@cache
def _kinds() -> dict[str, str]:
    """Return the family of each kind of figures."""
    return dict.fromkeys(_packages()[_OWN].KINDS, _OWN)


def functions(figure: str, entry: Mapping[str, Any]) -> tuple[str, str]:
    """Return the family of a figure of a config, and the name of its functions.

    `entry` is the config entry of the figure. A family of another installed package is named by its import
    name. Raises SceneError.
    """
    kind = entry.get("kind")
    if kind is None:
        return families()[figure], figure
    return (_kinds()[kind] if kind in _kinds() else installed.family(kind)), kind


def module(family: str) -> str:
    """Return the name of the module, or of the package, of a family."""
    return _packages()[family].__name__ if family in _packages() else family


def parts(family: str) -> list[str]:
    """Return the modules of a family's functions: one, or `measure`, `claims` and `figure` of its folder."""
    if family in _packages() and not hasattr(_packages()[family], "__path__"):
        return [module(family)]
    return [f"{module(family)}.{part}" for part in ("measure", "claims", "figure")]


def modules() -> list[str]:
    """Return the modules of the functions of all families of this package."""
    return [name for family in _packages() for name in parts(family)]


def home(family: str) -> str:
    """Return the name of the module, or package, that states what a family is."""
    return _packages()[family].__name__


def files(family: str) -> tuple[Path, ...]:
    """Return the files of the other installed package that defines a family.

    The list is empty for a family of this package.
    """
    return () if family in _packages() else tuple(installed.files(family))


def package_of(entry: Mapping[str, Any]) -> str:
    """Return name and version of the other package that defines a kind; "" for this package."""
    kind = entry.get("kind")
    return "" if kind is None or kind in _kinds() else installed.source(kind)


def caption(settings: Mapping[str, Any]) -> str:
    """Return the caption of a figure whose name a config chooses, from its settings.

    Raises SceneError.
    """
    if settings["kind"] in _kinds():
        return str(_packages()[_kinds()[settings["kind"]]].caption(settings))
    return installed.caption(settings)


def validate(figure: str, settings: Mapping[str, Any], points: Sequence[Point]) -> None:
    """Apply the rules of a figure that go beyond the kinds of its settings.

    `points` are the points of the figure. Raises SceneError.
    """
    if settings["kind"] in _kinds():
        _packages()[_kinds()[settings["kind"]]].validate(figure, settings, points)
    else:
        installed.validate(figure, settings, points)


def of_claims() -> frozenset[str]:
    """Return the figures that are made from the claims of all other figures."""
    stated = (package for package in _packages().values() if getattr(package, "OF_CLAIMS", False))
    return frozenset(figure for package in stated for figure in package.FIGURES)


def series() -> dict[str, tuple[int, float]]:
    """Return dimension and largest packing fraction for each figure of an equation of state."""
    parts = (getattr(package, "SERIES", {}) for package in _packages().values())
    return {figure: stated for part in parts for figure, stated in part.items()}


def costs() -> list[str]:
    """Return the figures of the cost of an accuracy."""
    return [figure for package in _packages().values() for figure in getattr(package, "COSTS", [])]


def settings() -> dict[str, dict[str, Kind]]:
    """Return the settings of each figure's measurement."""
    return {
        figure: keys.settings if isinstance(keys, Parts) else keys
        for package in _packages().values()
        for figure, keys in package.FIGURES.items()
    }


def kinds() -> dict[str, dict[str, Kind]]:
    """Return the settings of each kind of figures whose name a config chooses.

    Only kinds of this package are returned.
    """
    return dict(_packages()[_OWN].KINDS)


def known_kinds() -> list[str]:
    """Return the kinds of this package, then of other installed packages, without import."""
    return [*_kinds(), *(kind for kind in installed.kinds() if kind not in _kinds())]


def settings_of_kind(kind: str) -> dict[str, Kind]:
    """Return the settings of a kind of figures, of this or another package.

    Raises SceneError.
    """
    settings: dict[str, Kind] = kinds()[kind] if kind in _kinds() else installed.package(kind).KINDS[kind]
    return settings


def stated_claims(entry: Mapping[str, Any]) -> list[Any]:
    """Return [claims of the config] if a figure's kind has such a setting, else [].

    The claims function of the figure takes them as a further argument.
    """
    takes = "kind" in entry and "claims" in settings_of_kind(entry["kind"])
    return [entry.get("claims", [])] if takes else []
