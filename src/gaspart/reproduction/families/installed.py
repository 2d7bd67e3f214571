"""Kinds of figures in other installed packages, discovered by entry points.

A package declares each kind as an entry point of the group `gaspart.families`. The entry point refers to a
package that has the form of a family of gaspart (see `families.registry`), with the kind in its `KINDS`.
Entry points are read without import. A package is imported only if the config has a figure of its kind.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from gaspart.errors import SceneError, entry_points_of

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from gaspart.reproduction.points.point import Point

GROUP = "gaspart.families"
_PARTS = ("measure", "claims", "figure")


@cache
def _entry_points() -> dict[str, list[EntryPoint]]:
    """Return the entry points of each kind; a valid kind has exactly one."""
    by_kind: dict[str, list[EntryPoint]] = {}
    for entry_point in entry_points_of(GROUP):
        others = by_kind.setdefault(entry_point.name, [])
        if entry_point not in others:  # a package may be on the path twice
            others.append(entry_point)
    return by_kind


def kinds() -> list[str]:
    """Return the kinds of installed packages in alphabetical order, without import."""
    return sorted(_entry_points())


def family(kind: str) -> str:
    """Return the family of a kind, the import name of its package.

    Raises SceneError if several packages define the kind.
    """
    return _entry_point(kind).value


def package(kind: str) -> ModuleType:
    """Return the package of a kind.

    Raises SceneError if the package cannot be imported, or does not have the form of a family. The message
    has the installed package, its entry point and the reason.
    """
    with blame_package(kind):
        module = import_module(family(kind))
        _check(module, kind)
    return module


def source(kind: str) -> str:
    """Return name and version of the installed package that defines a kind."""
    distribution = _entry_point(kind).dist
    return f"{distribution.name} {distribution.version}" if distribution else "a package without metadata"


def files(family: str) -> list[Path]:
    """Return the Python files of the package of a family, in alphabetical order."""
    spec = find_spec(family.partition(".")[0])
    folders = (spec.submodule_search_locations if spec else None) or ()
    return sorted(path for folder in folders for path in Path(folder).rglob("*.py"))


def validate(figure: str, settings: Mapping[str, Any], points: Sequence[Point]) -> None:
    """Apply the function `validate` of a kind's package, if any, to a configured figure.

    Raises the SceneError of the function, or a SceneError that names the package.
    """
    rules = getattr(package(settings["kind"]), "validate", None)
    if rules is not None:
        with blame_package(settings["kind"], f"figures.{figure}"):
            rules(figure, settings, points)


def caption(settings: Mapping[str, Any]) -> str:
    """Return the caption of a figure, made by the package of its kind.

    The package makes the caption from the settings.

    Raises SceneError.
    """
    module = package(settings["kind"])
    with blame_package(settings["kind"]):
        text = module.caption(settings)
        if not isinstance(text, str):
            raise TypeError(f"caption() must return text, not {type(text).__name__}")
    return text


@contextmanager
def blame_package(kind: str, where: str = "") -> Iterator[None]:
    """Convert any error of a package within this context to a SceneError that names it.

    The message has one line. `where` is the position of the figure in the config. If the caller adds the
    position, `where` is "".
    """
    try:
        yield
    except SceneError:
        raise
    except (Exception, SystemExit) as error:  # the code of another package may raise any exception
        entry_point = f"{GROUP}: {kind} = {family(kind)}"
        reason = f"{type(error).__name__}: {error}"
        rule = f"the entry point ({entry_point}) of {source(kind)} cannot be used: {reason}"
        raise SceneError(f"{where}.kind".lstrip("."), kind, rule) from error


def _entry_point(kind: str) -> EntryPoint:
    entry_points = _entry_points()[kind]
    if len(entry_points) > 1:
        owners = ", ".join(
            sorted(
                entry_point.dist.name if entry_point.dist else entry_point.value
                for entry_point in entry_points
            )
        )
        raise SceneError("kind", kind, f"several installed packages bring this kind ({GROUP}): {owners}")
    return entry_points[0]


def _check(module: ModuleType, kind: str) -> None:
    """Raise an error unless a package has the form of a family of this kind.

    The error states the reason.
    """
    from jsonschema import Draft202012Validator, SchemaError

    from gaspart.keys import record

    if Path(__file__).with_name(module.__name__).is_dir():
        raise ValueError("it has the name of a family of gaspart")
    if not isinstance(getattr(module, "TITLE", None), str):
        raise TypeError("its TITLE must be text")
    settings = getattr(module, "KINDS", None)
    if not isinstance(settings, dict) or not isinstance(settings.get(kind), dict):
        raise TypeError(f"its KINDS must have the settings of {kind}, a mapping from keys to their kinds")
    try:
        Draft202012Validator.check_schema(record(settings[kind]))
    except SchemaError as error:
        where = ".".join(str(part) for part in list(error.absolute_path)[1:])
        raise TypeError(f"its KINDS of {kind}: {where}: {error.message}") from None
    if not callable(getattr(module, "caption", None)):
        raise TypeError("it must have a function caption(settings)")
    for part in _PARTS:
        if find_spec(f"{module.__name__}.{part}") is None:
            raise ModuleNotFoundError(f"it has no module {part}")
