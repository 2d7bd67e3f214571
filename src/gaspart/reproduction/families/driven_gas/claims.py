"""Claims about driven granular gases."""

from __future__ import annotations

import xarray as xr

from gaspart import theory
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import PARTICLES, rows

BALANCE = (
    "kicks against contacts at Enskog's rate; van Noije & Ernst 1998, first order in a2, no correlations"
)
HEATED = "van Noije & Ernst 1998, first order in a2; derived again from the moments of the cooling gas"


def driven_gas(ds: xr.Dataset) -> list[Claim]:
    """The temperature at which contacts lose what kicks give, and the deviation from Maxwell velocities."""
    claims = []
    for row in rows(ds, "gas"):
        dimension, e, count = int(row["dimension"]), float(row["restitution"]), int(row["count"])
        which = f"{PARTICLES[dimension]}, restitution {e:g}"
        power = float(row["power"]) * (1.0 - 1.0 / count)
        expected = float(theory.driven_temperature(e, dimension, power, float(row["packing_fraction"])))
        claims += [
            Claim.within(
                claim=f"steady temperature over that of the energy balance, {which}",
                measured=Estimate.of(row, "temperature") / expected,
                expected=1.0,
                half_width=0.02,
                source=BALANCE,
                fails_if="kicks that give another energy, or contacts that lose another; correlations of "
                "velocities, which are neglected, amount to some per cent in dense gases",
            ),
            Claim.within(
                claim=f"fourth cumulant of the velocities, {which}",
                measured=Estimate.of(row, "cumulant"),
                expected=float(theory.driven_cumulant(e, dimension)),
                half_width=0.01,
                source=HEATED,
                fails_if="a distribution that is Maxwell's, or that of the cooling gas",
            ),
            Claim(
                claim=f"energy given by kicks over the power of the thermostat, {which}",
                measured=Estimate.of(row, "given") / power,
                expected=1.0,
                required=0.02,
                source="exact, less the share 1/N of the centre of mass",
                fails_if="kicks of the wrong width, or too few of them",
            ),
        ]
    return claims
