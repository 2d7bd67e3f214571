"""Claims about extreme scenes, and reversibility."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr

from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.table import Row, Table, each

ROUNDING: dict[str, Any] = {
    "required": 0.5,
    "source": "exact: conserved, hard, and the contacts of the exact answer or of the search "
    "through all pairs",
    "fails_if": "rounding errors grow, or a root is wrong",
}


def stability_extremes(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims that each scene runs correctly, or is rejected with one line.

    There is a claim for each engine. Some scenes are expected to be rejected. In the event-driven engine,
    accepted scenes have no drift, overlap or missed contact beyond rounding.
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
    """Return the claims on errors of the event-driven engine, for all accepted scenes."""
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


ROUNDINGS = math.log(0.1 * 2.0**53)
"""ln of the distance at which the memory is lost, in diameters, divided by the rounding error of a coordinate
of 1."""


def reversibility(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on the growth of echoes, and on the memory of exact runs.

    The growth of an echo is compared with the growth of the distance of neighbouring runs.
    """
    runs = Table(ds, "row")
    exact = runs[runs.engine == "event"]  # there is no theory for time steps
    return [claim for run in exact for claim in _growth(run)]


def _growth(run: Row) -> list[Claim]:
    gas = f"{PARTICLES[run.dimension]}, packing fraction {run.packing_fraction:g}"
    return [
        Claim(
            claim=f"growth of the echo over that of two neighbouring runs, {gas}",
            measured=run.growth / run.divergence,
            expected=1.0,
            required=0.1,
            source="time reversal: a flow and its reverse have the same exponents",
            fails_if="the backward run is not the reverse of the forward run",
        ),
        Claim(
            claim=f"growth of the echo over the largest Lyapunov exponent, {gas}",
            measured=run.growth / run.exponent,
            expected=1.0,
            required=0.1,
            source="the linearised dynamics of the same gas, by gaspart.analysis.lyapunov; the growth of the "
            "exponent with dilution is that of [van Zon 1998]",
            fails_if="the engine amplifies errors more or less than collisions of hard particles do",
        ),
        Claim.within(
            claim=f"growth of the echo times the memory, {gas}",
            measured=run.growth * run.memory,
            expected=ROUNDINGS - math.log(run.side),
            half_width=5.0,
            source="ln(0.1 2^53 sigma / L): only the rounding of coordinates up to L is lost",
            fails_if="an error larger than rounding is made, or the engine replays instead of integrating",
        ),
    ]
