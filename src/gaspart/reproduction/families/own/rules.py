"""Rules for figures that a config defines, checked before any job."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from gaspart.analysis.observables import OBSERVABLES, require_defined, require_kept
from gaspart.errors import SceneError
from gaspart.reproduction.points.measurable import distinct, require_observable
from gaspart.reproduction.points.point import TRAJECTORIES, Point

NEEDED = {
    "theory": ("required",),
    "at_least": ("value", "required", "source"),
    "at_most": ("value", "required", "source"),
    "value": ("value", "tolerance", "source"),
    "exponent": ("value", "tolerance", "source"),
}
"""Required keys of a claim of each kind."""
_LEAST = 3
"""Minimum number of points for the fit of a power law."""
_UNUSED = {
    "theory": ("value", "source"),
    "at_least": ("tolerance",),
    "at_most": ("tolerance",),
    "value": (),
    "exponent": (),
}


def validate(figure: str, settings: Mapping[str, Any], points: Sequence[Point]) -> None:
    """Raise SceneError for points or claims that do not fit a figure.

    The function rejects experiments without trajectories, points without a number for the horizontal axis,
    and claims whose keys do not belong together.
    """
    where = f"figures.{figure}"
    against = settings["against"]
    for point in points:
        if point.job != TRAJECTORIES:
            rule = f"must make trajectories (job: {TRAJECTORIES})"
            raise SceneError(f"{where}.experiments", point.experiment, rule)
        value = point.settings.get(against)
        if not isinstance(value, int | float) or isinstance(value, bool):
            rule = f"must be a key whose value is a number at every point, but at {point.path} it is {value}"
            raise SceneError(f"{where}.against", against, rule)
        _require_measurable(where, settings["observable"], point)
    curve = OBSERVABLES[settings["observable"]].form == "curve"
    position = settings.get("place")
    if position is not None and not curve:
        raise SceneError(f"{where}.place", position, "has a meaning for a curve only")
    for point in distinct(points):
        try:
            require_observable(settings["observable"], point)
        except SceneError as error:
            rule = f"cannot be measured at {point.path}: {error.key}: {error.rule}"
            raise SceneError(f"{where}.observable", settings["observable"], rule) from None
    at = sorted({float(point.settings[against]) for point in points})
    for number, claim in enumerate(settings.get("claims", ())):
        _claim(f"{where}.claims.{number}", claim, curve and position is None)
        _check_between(f"{where}.claims.{number}", claim, at)


def _check_between(where: str, claim: Mapping[str, Any], at: Sequence[float]) -> None:
    """Raise SceneError for a claim about no point, or an exponent of fewer than three points.

    `at` are the values of the points.
    """
    between = claim.get("between")
    low, high = (at[0], at[-1]) if between is None else between
    chosen = [value for value in at if low <= value <= high]
    stated = f"there is none of the points, which are from {at[0]:g} to {at[-1]:g}"
    if not chosen:
        raise SceneError(f"{where}.between", between, stated)
    if claim["that"] == "exponent" and len(chosen) < _LEAST:
        raise SceneError(where, "exponent", f"needs {_LEAST} points or more; there are {len(chosen)}")


def _require_measurable(where: str, name: str, point: Point) -> None:
    """Raise SceneError for an observable that cannot be measured at a point.

    The reason is that the scene does not have it, or that the trajectories do not store the necessary data.
    """
    stated = {"pairs": "pairs", "stress": "fluxes"}
    try:
        require_defined(name, point.scene)
        require_kept(name, [kept for key, kept in stated.items() if point.settings.get(key)])
    except SceneError as error:
        rule = f"at {point.path}: {error.key}: {error.rule}"
        raise SceneError(f"{where}.observable", name, rule) from None


def _claim(where: str, claim: Mapping[str, Any], curve: bool) -> None:
    that = claim["that"]
    if curve:
        raise SceneError(where, that, "of a curve needs the place whose value is meant: place")
    for key in NEEDED[that]:
        if claim.get(key) is None:
            raise SceneError(f"{where}.{key}", None, f"is required with that: {that}")
    for key in _UNUSED[that]:
        if claim.get(key) is not None:
            raise SceneError(f"{where}.{key}", claim[key], f"has no meaning with that: {that}")
