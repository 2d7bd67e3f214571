"""Claims about driven granular gases."""

from __future__ import annotations

import xarray as xr

from gaspart import theory
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.table import Row, Table

BALANCE = (
    "kicks against contacts at Enskog's rate; [van Noije 1998], first order in a2; no correlations, "
    "which amount to less than 0.2 % at this density"
)
HEATED = (
    "[van Noije 1998], first order in a2, derived again from the moments of the cooling gas; exact "
    "correction for the number of particles"
)


def driven_gas(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on the steady temperature and the deviation from Maxwell velocities.

    At this temperature contacts lose the energy that kicks give.
    """
    gases = Table(ds, "gas")
    claims = [claim for gas in gases for claim in _of_gas(gas)]
    return claims + [_claim_cumulants(own, dimension) for dimension, own in gases.by("dimension")]


def _of_gas(gas: Row) -> list[Claim]:
    e, dimension, power = gas.restitution, gas.dimension, gas.power
    which = f"{PARTICLES[dimension]}, restitution {e:g}"
    return [
        Claim(
            claim=f"steady temperature over that of the energy balance, {which}",
            measured=gas.temperature
            / float(theory.driven_temperature(e, dimension, power, gas.packing_fraction)),
            expected=1.0,
            required=0.015,
            source=BALANCE,
            fails_if="kicks that give another energy, or contacts that lose another",
        ),
        Claim(
            claim=f"fourth cumulant of the velocities, {which}",
            measured=gas.cumulant,
            expected=float(
                theory.finite_size_cumulant(theory.driven_cumulant(e, dimension), gas.count, dimension)
            ),
            required=0.01,
            source=HEATED,
            fails_if="a distribution that is not that of the heated gas",
        ),
        Claim(
            kind="identity",
            claim=f"energy given by kicks over the power of the thermostat, {which}",
            measured=gas.given / (power * (1.0 - 1.0 / gas.count)),
            expected=1.0,
            required=0.02,
            source="exact, less the share 1/N of the centre of mass",
            fails_if="kicks of the wrong width, or too few of them",
        ),
    ]


def _claim_cumulants(gases: Table, dimension: int) -> Claim:
    """Return the claim on the cumulants of all gases of a dimension, by least squares.

    A single gas does not decide.
    """
    heated, cooling = (
        theory.finite_size_cumulant(of(gases.restitution, dimension), gases.count, dimension)
        for of in (theory.driven_cumulant, theory.fourth_cumulant)
    )
    weight = (cooling - heated) / gases.cumulant.error**2
    norm = float(weight @ (cooling - heated))
    return Claim(
        claim=f"fourth cumulants of {PARTICLES[dimension]} from those of the heated gas (0) to those of the "
        "cooling gas (1)",
        measured=Estimate(weight @ (gases.cumulant.value - heated) / norm, norm**-0.5),
        expected=0.0,
        required=0.5,
        source=HEATED,
        alternative=1.0,
        follows=True,
        fails_if="the distribution of the cooling gas",
    )
