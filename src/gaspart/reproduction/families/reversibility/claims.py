"""Claims about memory: how long a reversed run returns to its start."""

from __future__ import annotations

import math

import xarray as xr

from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import PARTICLES, rows

EXPONENT = {
    (2, 0.01): (8.6, 0.8),
    (2, 0.1): (2.81, 0.12),
    (2, 0.4): (0.87, 0.03),
    (3, 0.001): (14.7, 2.2),
    (3, 0.01): (5.8, 0.6),
    (3, 0.1): (1.47, 0.05),
}
"""Largest Lyapunov exponent per collision of a particle, with its error, of 100 discs and of 125 spheres
between walls: computed, by another program. Their growth with dilution is that of van Zon, van Beijeren &
Dellago, Phys. Rev. Lett. 80, 2035 (1998)."""
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
    claims = [
        Claim(
            claim=f"growth of the echo over that of two neighbouring runs, {gas}",
            measured=growth / Estimate.of(row, "divergence"),
            expected=1.0,
            required=0.1,
            source="time reversal: a flow and its reverse have the same exponents",
            fails_if="the backward run is not the reverse of the forward run",
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
    known = EXPONENT.get((int(row.dimension), float(row.packing_fraction)))
    if known:
        claims.append(
            Claim(
                claim=f"growth of the echo per collision of a particle, {gas}",
                measured=growth,
                expected=Estimate(*known),
                required=0.15 * growth.value,
                source="Lyapunov exponents (computed; growing with dilution as in van Zon et al. 1998)",
                allowance_source="their scatter",
                no_verdict="the exponents were computed by a program that is not in this repository",
                fails_if="collisions are lost, or not as sensitive as those of hard particles",
            )
        )
    return claims
