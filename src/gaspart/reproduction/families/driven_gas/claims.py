"""Claims about driven granular gases."""

from __future__ import annotations

import xarray as xr

from gaspart import theory
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import PARTICLES, rows

BALANCE = (
    "kicks against contacts at Enskog's rate; [van Noije 1998], first order in a2; no correlations, "
    "which amount to less than 0.2 % at this density"
)
HEATED = (
    "[van Noije 1998], first order in a2, derived again from the moments of the cooling gas; exact "
    "correction for the number of particles"
)


def driven_gas(ds: xr.Dataset) -> list[Claim]:
    """The temperature at which contacts lose what kicks give, and the deviation from Maxwell velocities."""
    claims = []
    for row in rows(ds, "gas"):
        dimension, e, count = int(row["dimension"]), float(row["restitution"]), int(row["count"])
        which, power = f"{PARTICLES[dimension]}, restitution {e:g}", float(row["power"])
        expected = float(theory.driven_temperature(e, dimension, power, float(row["packing_fraction"])))
        own = theory.driven_cumulant(e, dimension)
        claims += [
            Claim(
                claim=f"steady temperature over that of the energy balance, {which}",
                measured=Estimate.of(row, "temperature") / expected,
                expected=1.0,
                required=0.015,
                source=BALANCE,
                fails_if="kicks that give another energy, or contacts that lose another",
            ),
            Claim(
                claim=f"fourth cumulant of the velocities, {which}",
                measured=Estimate.of(row, "cumulant"),
                expected=float(theory.finite_size_cumulant(own, count, dimension)),
                required=0.01,
                source=HEATED,
                fails_if="a distribution that is not that of the heated gas",
            ),
            Claim(
                kind="identity",
                claim=f"energy given by kicks over the power of the thermostat, {which}",
                measured=Estimate.of(row, "given") / (power * (1.0 - 1.0 / count)),
                expected=1.0,
                required=0.02,
                source="exact, less the share 1/N of the centre of mass",
                fails_if="kicks of the wrong width, or too few of them",
            ),
        ]
    dimensions = sorted(set(ds["dimension"].values.tolist()))
    return claims + [_heated(ds.isel(gas=(ds["dimension"] == one).values), one) for one in dimensions]


def _heated(gases: xr.Dataset, dimension: int) -> Claim:
    """Where the cumulants of all gases of a dimension lie, by least squares: a single one does not decide."""
    e, count = gases["restitution"].values, gases["count"].values
    heated, cooling = (
        theory.finite_size_cumulant(of(e, dimension), count, dimension)
        for of in (theory.driven_cumulant, theory.fourth_cumulant)
    )
    weight = (cooling - heated) / gases["cumulant_error"].values ** 2
    norm = float(weight @ (cooling - heated))
    return Claim(
        claim=f"fourth cumulants of {PARTICLES[dimension]} from those of the heated gas (0) to those of the "
        "cooling gas (1)",
        measured=Estimate(weight @ (gases["cumulant"].values - heated) / norm, norm**-0.5),
        expected=0.0,
        required=0.5,
        source=HEATED,
        alternative=1.0,
        follows=True,
        fails_if="the distribution of the cooling gas",
    )
