"""Claims about the table of extremes: each row passes or is refused."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.reproduction.claims import Claim, Estimate


def stability_extremes(dataset: xr.Dataset) -> list[Claim]:
    """Each row passes, or is refused with one line where that is expected, in every engine; where it passes,
    nothing drifts, overlaps or is missed beyond rounding in the event-driven engine."""
    return [_outcome(dataset.sel(row=row)) for row in dataset["row"].values] + _exact(dataset)


def _outcome(row: xr.Dataset) -> Claim:
    good = [
        verdict == "refused" and bool(message) and "\n" not in message if refusal else verdict == "passes"
        for verdict, message, refusal in zip(
            row["verdict"].values, row["message"].values, row["refusal"].values, strict=True
        )
    ]
    return Claim(
        claim=f"{row['row'].item()} ({row['group'].item()}): engines that pass, or refuse with one line what "
        "they should",
        measured=Estimate(sum(good)),
        expected=row.sizes["engine"],
        required=0.5,
        source="exact: none hangs, none is silently wrong; which refuse is stated beforehand",
        fails_if="a run is refused that should pass, or the reverse; hangs, drifts, overlaps, or has other "
        "contacts than the exact answer or all pairs",
    )


def _exact(dataset: xr.Dataset) -> list[Claim]:
    """Errors of the event-driven engine, over all rows that pass."""
    event = dataset.sel(engine="event")
    passed = event.isel(row=np.flatnonzero(event["verdict"].values == "passes"))
    claims = []
    for name, text, bound in (
        ("energy", "largest relative drift of the energy, event-driven", 1e-9),
        ("overlap", "deepest overlap observed, in contact distances, event-driven", 1e-9),
        ("missed", "missed or spurious contacts in all rows, event-driven", 0.0),
    ):
        values = np.abs(passed[name].values.astype(float))
        measured = values.sum() if name == "missed" else max(values, default=np.nan)
        claims.append(
            Claim.at_most(
                claim=text,
                measured=Estimate(measured),
                bound=bound,
                required=0.5,
                source="exact: conserved, hard, and the contacts of the exact answer or of the search "
                "through all pairs",
                fails_if="rounding errors grow, or a root is wrong",
            )
        )
    return claims
