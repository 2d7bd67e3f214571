"""Registry of figures: the modules of `reproduction.figures`, and a user's own by their paths.

A module states a `TITLE`, a `CHAPTER` of the report, and in `FIGURES` the `Parts` of each figure. `OF_CLAIMS`
means that its figures are made from the claims of all other figures, instead of points. `SERIES` and `COSTS`
define choices of the reader on the page of the report (`report.explore`): figures of an equation of state,
with dimension and largest packing fraction, and figures of the cost of an accuracy.

A figure of the user's has the `kind` of a figure of `figures.own`, or a `module` beside the config.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from gaspart.errors import SceneError
from gaspart.keys import Kind
from gaspart.reproduction.figure import find_parts, load_module
from gaspart.reproduction.figures import own

if TYPE_CHECKING:
    from gaspart.reproduction.points.point import Point


@cache
def _modules() -> dict[str, ModuleType]:
    """Return the module of each family, in alphabetical order."""
    names = sorted(path.stem for path in Path(__file__).parent.glob("figures/[a-z]*.py"))
    return {name: import_module(f"gaspart.reproduction.figures.{name}") for name in names}


def _module(family: str) -> ModuleType:
    return _modules()[family] if family in _modules() else load_module(family)


def titles() -> dict[str, str]:
    """Return the title of each family, in alphabetical order of the families."""
    return {name: module.TITLE for name, module in _modules().items()}


def title(family: str) -> str:
    """Return the title of a family."""
    return str(getattr(_module(family), "TITLE", own.TITLE))


def chapter(family: str) -> str:
    """Return the chapter of the report that contains a family."""
    return str(_modules().get(family, own).CHAPTER)


@cache
def families() -> dict[str, str]:
    """Return the family of each figure."""
    return {figure: name for name, module in _modules().items() for figure in module.FIGURES}


def find(figure: str, entry: Mapping[str, Any]) -> tuple[str, str]:
    """Return the family of a figure of a config, and the name of its parts. `entry` is the config entry of
    the figure. The family of a user's module is its path.
    """
    if "module" in entry:
        return entry["module"], figure
    return ("own", entry["kind"]) if "kind" in entry else (families()[figure], figure)


def home(family: str) -> str:
    """Return the import name, or the path, of the module of a family."""
    return _modules()[family].__name__ if family in _modules() else family


def modules() -> list[str]:
    """Return the import names of the modules of all families."""
    return [module.__name__ for module in _modules().values()]


def caption(entry: Mapping[str, Any]) -> str:
    """Return the caption of a user's figure, from its config entry."""
    return own.caption(entry)


def validate(figure: str, entry: Mapping[str, Any], points: Sequence[Point]) -> None:
    """Apply the rules of a figure with a `kind` that go beyond the kinds of its settings. `points` are the
    points of the figure.
    """
    if "kind" in entry:
        own.validate(figure, entry, points)


def of_claims() -> frozenset[str]:
    """Return the figures that are made from the claims of all other figures."""
    stated = (module for module in _modules().values() if getattr(module, "OF_CLAIMS", False))
    return frozenset(figure for module in stated for figure in module.FIGURES)


def series() -> dict[str, tuple[int, float]]:
    """Return dimension and largest packing fraction for each figure of an equation of state."""
    stated = (getattr(module, "SERIES", {}) for module in _modules().values())
    return {figure: limits for part in stated for figure, limits in part.items()}


def costs() -> list[str]:
    """Return the figures of the cost of an accuracy."""
    return [figure for module in _modules().values() for figure in getattr(module, "COSTS", [])]


def settings() -> dict[str, dict[str, Kind]]:
    """Return the settings of each figure's measurement."""
    stated = (module.FIGURES.items() for module in _modules().values())
    return {figure: parts.settings for own in stated for figure, parts in own}


def kinds() -> dict[str, dict[str, Kind]]:
    """Return the settings of each kind of figures whose name a config chooses."""
    return {kind: parts.settings for kind, parts in own.KINDS.items()}


def settings_in(module: str, figure: str) -> dict[str, Kind]:
    """Return the settings of a figure in a user's module. Raises SceneError if the module cannot be used."""
    try:
        return {**find_parts(module, figure).settings, "caption": own.CAPTION}
    except (Exception, SystemExit) as error:  # the code of a user may raise any exception
        rule = f"must have the figure in its FIGURES: {type(error).__name__}: {error}"
        raise SceneError(f"figures.{figure}.module", module, rule) from error


def stated_claims(entry: Mapping[str, Any]) -> list[Any]:
    """Return [claims of the config] for a figure with a `kind`, whose claims function takes them; else []."""
    return [entry.get("claims", [])] if "kind" in entry else []
