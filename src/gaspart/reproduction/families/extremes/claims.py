"""Claims about the table of extremes: each row passes or is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.table import Table, each

ROUNDING: dict[str, Any] = {
    "required": 0.5,
    "source": "exact: conserved, hard, and the contacts of the exact answer or of the search "
    "through all pairs",
    "fails_if": "rounding errors grow, or a root is wrong",
}


def stability_extremes(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims that each row passes, or is refused in one line, in every engine.

    A row is refused where that is expected; where it passes, nothing drifts, overlaps or is missed beyond
    rounding in the event-driven engine.
    """
    scenes = Table(dataset, "row")
    one_line = np.vectorize(lambda message: bool(message) and "\n" not in message)(scenes.message)
    refused = (scenes.verdict == "refused") & one_line
    good = np.where(scenes.refusal, refused, scenes.verdict == "passes")
    return [
        *each(
            scenes,
            "{row} ({group}): engines that pass, or refuse with one line what they should",
            measured=Estimate(good.sum(axis=1)),
            expected=len(scenes.engine),
            required=0.5,
            source="exact: none hangs, none is silently wrong; which refuse is stated beforehand",
            fails_if="a run is refused that should pass, or the reverse; hangs, drifts, overlaps, or has "
            "other contacts than the exact answer or all pairs",
        ),
        *_exact(Table(dataset.sel(engine="event"), "row")),
    ]


def _exact(event: Table) -> list[Claim]:
    """Return the claims on errors of the event-driven engine, over all rows that pass."""
    passed = event[event.verdict == "passes"]
    return [
        Claim.at_most(
            claim="largest relative drift of the energy, event-driven",
            measured=Estimate(max(np.abs(passed.energy), default=np.nan)),
            bound=1e-9,
            **ROUNDING,
        ),
        Claim.at_most(
            claim="deepest overlap observed, in contact distances, event-driven",
            measured=Estimate(max(np.abs(passed.overlap), default=np.nan)),
            bound=1e-9,
            **ROUNDING,
        ),
        Claim.at_most(
            claim="missed or spurious contacts in all rows, event-driven",
            measured=Estimate(np.abs(passed.missed).sum()),
            bound=0.0,
            **ROUNDING,
        ),
    ]
