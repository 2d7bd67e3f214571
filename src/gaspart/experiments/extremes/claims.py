"""What the table of extremes claims: each row passes or is refused."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.claims import Claim

GOOD = ("passes", "refused")


def stability_extremes(dataset: xr.Dataset) -> list[Claim]:
    """Each row passes, or is refused with one line, in every engine; where it passes, nothing drifts,
    overlaps or is missed beyond rounding in the event-driven engine."""
    return [_settled(dataset.sel(row=row)) for row in dataset["row"].values] + _exact(dataset)


def _settled(row: xr.Dataset) -> Claim:
    engines = row.sizes["engine"]
    good = [
        verdict in GOOD and (verdict == "passes" or (message and "\n" not in message))
        for verdict, message in zip(row["verdict"].values, row["message"].values, strict=True)
    ]
    return Claim(
        f"{row['row'].item()} ({row['group'].item()}): engines that pass, or refuse with one line",
        "test",
        sum(bool(one) for one in good),
        0.0,
        0.5,
        engines,
        "exact: none hangs, none is silently wrong",
        fails_if="a run hangs, drifts, overlaps, or has other contacts than the exact answer or all pairs",
    )


def _exact(dataset: xr.Dataset) -> list[Claim]:
    """Of the event-driven engine, over all rows that pass."""
    event = dataset.sel(engine="event")
    passed = event.isel(row=np.flatnonzero(event["verdict"].values == "passes"))
    source = "exact: conserved, hard, and the contacts of the exact answer or of the search through all pairs"
    claims = []
    for name, text, bound in (
        ("energy", "largest relative drift of the energy, event-driven", 1e-9),
        ("overlap", "deepest overlap seen, in contact distances, event-driven", 1e-9),
        ("missed", "contacts missed or made up in all rows, event-driven", 0.0),
    ):
        values = np.abs(passed[name].values.astype(float))
        measured = values.sum() if name == "missed" else max(values, default=np.nan)
        fails_if = "rounding is let grow, or a root is wrong"
        claims.append(Claim.at_most(text, "test", measured, 0.0, 0.5, bound, source, fails_if))
    return claims
