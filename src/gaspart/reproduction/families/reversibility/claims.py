"""Claims about memory: how long a reversed run returns to its start."""

from __future__ import annotations

import math

import xarray as xr

from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import PARTICLES, rows

ROUNDINGS = math.log(0.1 * 2.0**53)
"""ln of the distance at which the memory is lost, in diameters, over the rounding of a coordinate of 1."""


def reversibility(ds: xr.Dataset) -> list[Claim]:
    """Growth against that of neighbouring runs, and how long the memory of exact runs lasts."""
    claims = []
    for row in rows(ds, "row"):
        gas = f"{PARTICLES[int(row.dimension)]}, packing fraction {float(row.packing_fraction):g}"
        if str(row.engine.values) == "event":  # of time steps nothing is known but what the figure shows
            claims += _growth(row, gas)
    return claims


def _growth(row: xr.Dataset, gas: str) -> list[Claim]:
    growth = Estimate.of(row, "growth")
    return [
        Claim(
            claim=f"growth of the echo over that of two neighbouring runs, {gas}",
            measured=growth / Estimate.of(row, "divergence"),
            expected=1.0,
            required=0.1,
            source="time reversal: a flow and its reverse have the same exponents",
            fails_if="the backward run is not the reverse of the forward run",
        ),
        Claim(
            claim=f"growth of the echo over the largest Lyapunov exponent, {gas}",
            measured=growth / Estimate.of(row, "exponent"),
            expected=1.0,
            required=0.1,
            source="the linearised dynamics of the same gas, by gaspart.analysis.lyapunov; the growth of the "
            "exponent with dilution is that of [van Zon 1998]",
            fails_if="the engine amplifies errors more or less than collisions of hard particles do",
        ),
        Claim.within(
            claim=f"growth of the echo times the memory, {gas}",
            measured=growth * Estimate.of(row, "memory"),
            expected=ROUNDINGS - math.log(float(row.side)),
            half_width=5.0,
            source="ln(0.1 2^53 sigma / L): only the rounding of coordinates up to L is lost",
            fails_if="an error larger than rounding is made, or the engine replays instead of integrating",
        ),
    ]
