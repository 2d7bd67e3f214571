"""What the figure about memory claims."""

from __future__ import annotations

import math

import xarray as xr

from gaspart.claims import Claim

EXPONENT = {
    (2, 0.01): (8.6, 0.8),
    (2, 0.1): (2.81, 0.12),
    (2, 0.4): (0.87, 0.03),
    (3, 0.001): (14.7, 2.2),
    (3, 0.01): (5.8, 0.6),
    (3, 0.1): (1.47, 0.05),
}
"""Largest Lyapunov exponent per collision of a body, with its error, of 100 discs and of 125 spheres between
walls: computed, by another program. Their growth with dilution is that of van Zon, van Beijeren & Dellago,
Phys. Rev. Lett. 80, 2035 (1998)."""
ROUNDINGS = math.log(0.1 * 2.0**53)
"""ln of the distance at which all is forgotten, in diameters, over the rounding of a coordinate of 1."""


def reversibility(ds: xr.Dataset) -> list[Claim]:
    """Growth against Lyapunov exponents, exact runs against each other, and how long the memory lasts."""
    claims = []
    for n in range(ds.sizes["row"]):
        row = ds.isel(row=n)
        name = "discs" if int(row.dimension) == 2 else "spheres"
        gas = f"{name}, packing fraction {float(row.packing_fraction):g}"
        if str(row.engine.values) == "event":
            claims += _growth(row, gas)
        else:
            claims += _steps(ds, row, gas)
    return claims


def _growth(row: xr.Dataset, gas: str) -> list[Claim]:
    growth, error = float(row.growth), float(row.growth_error)
    claims = [
        Claim(
            f"growth of the echo over that of two neighbouring runs, {gas}",
            "test",
            growth / float(row.divergence),
            growth
            / float(row.divergence)
            * math.hypot(error / growth, float(row.divergence_error / row.divergence)),
            0.1,
            1.0,
            "time reversal: a flow and its reverse have the same exponents",
            expected_uncertainty=0.03,
            fails_if="the way back is not the reverse of the way there",
        ),
        Claim.within(
            f"growth of the echo times the memory, {gas}",
            "test",
            growth * float(row.memory),
            math.hypot(error * float(row.memory), growth * float(row.memory_error)),
            ROUNDINGS - math.log(float(row.side)),
            5.0,
            "ln(0.1 2^53 sigma / L): only the rounding of coordinates up to L is lost",
            "an error larger than rounding is made, or the engine replays instead of integrating",
        ),
    ]
    known = EXPONENT.get((int(row.dimension), float(row.packing_fraction)))
    if known:
        claims.append(
            Claim(
                f"growth of the echo per collision of a body, {gas}",
                "test",
                growth,
                error,
                0.15 * growth,
                known[0],
                "Lyapunov exponents (computed; growing with dilution as in van Zon et al. 1998)",
                expected_uncertainty=known[1],
                fails_if="collisions are lost, or not as sensitive as hard bodies'",
            )
        )
    return claims


def _steps(ds: xr.Dataset, row: xr.Dataset, gas: str) -> list[Claim]:
    """Steps are reversible but for rounding, and for contacts in the wrong order where it is dense."""
    same = (ds.dimension == row.dimension) & (ds.packing_fraction == row.packing_fraction)
    exact = ds.isel(row=(same & (ds.engine == "event")).values)
    if not exact.sizes["row"] or str(row.precision.values) != "float64":
        return []
    memory, other = float(row.memory), float(exact.memory[0])
    ratio = memory / other
    spread = ratio * math.hypot(float(row.memory_error) / memory, float(exact.memory_error[0]) / other)
    return [
        Claim.at_most(
            f"memory of the time-stepped engine over that of the event-driven one, {gas}",
            "test",
            ratio,
            spread,
            0.1,
            1.1,
            "contacts missed or in the wrong order are forgotten at once",
            "the time-stepped engine is more exact than rounding",
        )
    ]
