"""Claims that a config states of an observable."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import fit_power_law
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import freedoms, rows

APPROXIMATE = "the uncertainty of this theory is not known: a tolerance would decide"


def observable(dataset: xr.Dataset, stated: list[dict]) -> list[Claim]:
    """The claims of the config, `stated`, about an observable: one for each point, or each series."""
    return [claim for one in stated for claim in _claims(dataset, one)]


def _claims(dataset: xr.Dataset, stated: dict) -> list[Claim]:
    if stated.get("between") is not None:
        low, high = stated["between"]
        at = dataset["against"].values
        dataset = dataset.isel(point=np.flatnonzero((at >= low) & (at <= high)))
    if stated["that"] == "exponent":
        return [_exponent(part, stated) for _, part in dataset.groupby("series")]
    claims = (_claim(row, dataset.attrs, stated) for row in rows(dataset, "point"))
    return [claim for claim in claims if claim is not None]


def _text(what: str, row: xr.Dataset, names: dict) -> str:
    """What a claim is about: the observable, the point and its series."""
    series = str(row["series"].values)
    place = f"{names['against']} {float(row['against']):g}" + (f", {series}" if series else "")
    return f"{what} at {place}"


def _claim(row: xr.Dataset, names: dict, stated: dict) -> Claim | None:
    """One claim about a point; None where there is no theory for it."""
    name, that = names["observable"], stated["that"]
    common: dict[str, Any] = {"measured": Estimate.of(row, "value"), "fails_if": stated["fails_if"]}
    if stated.get("required") is not None:
        common["required"] = stated["required"]
    if that == "theory":
        return _theory(row, names, stated, common)
    common["source"] = stated["source"]
    if that == "value":
        text = _text(name, row, names)
        half = stated["tolerance"]
        return Claim.within(claim=text, expected=stated["value"], half_width=half, **common)
    bound = Claim.at_least if that == "at_least" else Claim.at_most
    return bound(claim=_text(name, row, names), bound=stated["value"], **common)


def _theory(row: xr.Dataset, names: dict, stated: dict, common: dict[str, Any]) -> Claim | None:
    """Agreement with theory; within a part of it, where its uncertainty is not known."""
    expected = float(row["theory"])
    if math.isnan(expected):
        return None
    text = _text(f"{names['observable']} compared with theory", row, names)
    source = names["source"] or "the theory that `gaspart.analysis` has for this observable"
    common |= {"source": source, "required": stated["required"] * abs(expected)}
    if stated.get("tolerance") is not None:
        half = stated["tolerance"] * abs(expected)
        return Claim.within(claim=text, expected=expected, half_width=half, **common)
    error = float(row["theory_error"])
    if math.isnan(error):
        return Claim(claim=text, expected=expected, no_verdict=APPROXIMATE, **common)
    return Claim(claim=text, expected=Estimate(expected, error), allowance_source=source, **common)


def _exponent(part: xr.Dataset, stated: dict) -> Claim:
    """The exponent of a power law through the points of a series; not a number where there is no fit."""
    x, y, errors = (part[name].values for name in ("against", "value", "value_error"))
    measured = Estimate(math.nan, math.nan)
    if x.size > 2 and np.all(x > 0.0) and np.all(y > 0.0) and np.all(errors > 0.0):
        fit = fit_power_law(x, y, errors, freedoms(part, "value"))
        measured = Estimate(fit.exponent, fit.exponent_error, fit.exponent_freedom)
    series = str(part["series"].values[0])
    others = {"required": stated["required"]} if stated.get("required") is not None else {}
    return Claim.within(
        claim=f"exponent of {part.attrs['observable']} against {part.attrs['against']}"
        + (f", {series}" if series else ""),
        measured=measured,
        expected=stated["value"],
        half_width=stated["tolerance"],
        source=stated["source"],
        fails_if=stated["fails_if"],
        **others,
    )
