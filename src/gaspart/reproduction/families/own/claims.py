"""Claims about an observable that a config states."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import fit_power_law
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.table import Row, Table

APPROXIMATE = "the uncertainty of this theory is not known: a tolerance would decide"


def observable(dataset: xr.Dataset, stated: list[dict]) -> list[Claim]:
    """Return the claims about an observable from the config's list `stated`.

    There is a claim for each point or for each series.
    """
    points = Table(dataset, "point")
    return [claim for statement in stated for claim in _claims(points, statement)]


def _claims(points: Table, stated: dict) -> list[Claim]:
    if stated.get("between") is not None:
        low, high = stated["between"]
        points = points[(points.against >= low) & (points.against <= high)]
    if stated["that"] == "exponent":
        return [_exponent(part, stated) for _, part in points.by("series")]
    claims = (_claim(point, stated) for point in points)
    return [claim for claim in claims if claim is not None]


def _axis(points: Table | Row) -> str:
    """Return the key of the grid whose values are in the column `against`."""
    return str(points.dataset.attrs["against"])


def _text(subject: str, point: Row) -> str:
    """Return the subject of a claim: observable, point and series."""
    return f"{subject} at {_axis(point)} {point.against:g}" + (f", {point.series}" if point.series else "")


def _claim(point: Row, stated: dict) -> Claim | None:
    """Return the claim about a point; None if there is no theory for it."""
    that = stated["that"]
    common: dict[str, Any] = {"measured": point.value, "fails_if": stated["fails_if"]}
    if stated.get("required") is not None:
        common["required"] = stated["required"]
    if that == "theory":
        return _theory(point, stated, common)
    text, value = _text(point.observable, point), stated["value"]
    common["source"] = stated["source"]
    if that == "value":
        return Claim.within(claim=text, expected=value, half_width=stated["tolerance"], **common)
    bound = Claim.at_least if that == "at_least" else Claim.at_most
    return bound(claim=text, bound=value, **common)


def _theory(point: Row, stated: dict, common: dict[str, Any]) -> Claim | None:
    """Return the claim of agreement with theory.

    If theory has no uncertainty, a fraction of the theoretical value is used.
    """
    theory = point.theory
    if math.isnan(theory.value):
        return None
    text = _text(f"{point.observable} compared with theory", point)
    source = point.source or "the theory that `gaspart.analysis` has for this observable"
    common |= {"source": source, "required": stated["required"] * abs(theory.value)}
    if stated.get("tolerance") is not None:
        half = stated["tolerance"] * abs(theory.value)
        return Claim.within(claim=text, expected=theory.value, half_width=half, **common)
    if math.isnan(theory.error):
        return Claim(claim=text, expected=theory.value, no_verdict=APPROXIMATE, **common)
    return Claim(claim=text, expected=theory, allowance_source=source, **common)


def _exponent(points: Table, stated: dict) -> Claim:
    """Return the claim on the exponent of a power law through the points of a series.

    Without a fit the exponent is NaN.
    """
    x, y, series = points.against, points.value, points.series[0]
    measured = Estimate(math.nan, math.nan)
    if x.size > 2 and np.all(x > 0.0) and np.all(y.value > 0.0) and np.all(y.error > 0.0):
        measured = fit_power_law(x, y).estimate
    others = {"required": stated["required"]} if stated.get("required") is not None else {}
    return Claim.within(
        claim=f"exponent of {points.observable} against {_axis(points)}" + (f", {series}" if series else ""),
        measured=measured,
        expected=stated["value"],
        half_width=stated["tolerance"],
        source=stated["source"],
        fails_if=stated["fails_if"],
        **others,
    )
