"""Claims about vibrated granular beds."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.statistics import Fit, fit_polynomial
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.table import Row, Table

WAVEFORMS = {0: "sawtooth", 1: "sine"}
"""Names of the motions of the floor."""
BALANCE = (
    "energy balance of an isothermal, nearly elastic bed, to first order in the density "
    "(gaspart.theory.vibrated), losses at the floor included; the form is that of [Kumaran 1998] and of "
    "[McNamara 1998]"
)


def small_parameter(beds: Table) -> np.ndarray:
    """Compute the power that each bed would lose over its weight and the speed sqrt(T)."""
    return np.asarray(theory.bed_loss(beds.layers, beds.restitution, beds.packing_fraction))


def expected_temperature(beds: Table) -> np.ndarray:
    """Compute the temperature of each bed where that parameter is small."""
    of = beds.layers, beds.restitution, beds.packing_fraction
    sawtooth, sine = theory.sawtooth_temperature(*of), theory.sine_temperature(*of)
    return np.where(beds.sine == 1, sine, sawtooth) * beds.speed**2


def extrapolation(beds: Table) -> Fit:
    """Fit the temperature over theory's by a polynomial of second order in the small parameter."""
    ratio = beds.temperature / expected_temperature(beds)
    return fit_polynomial(small_parameter(beds), ratio, powers=(0, 1, 2))


def vibrated_bed(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on given and lost energy, and on temperature and height of balance.

    The floor gives energy, contacts take it.
    """
    table, claims = Table(dataset, "bed"), []
    for kind, name in WAVEFORMS.items():
        beds = table[table.sine == kind]
        if len(beds) > 2:
            claims.append(
                Claim(
                    claim=f"temperature over that of theory in the limit of elastic discs, {name}",
                    measured=extrapolation(beds).estimate(0),
                    expected=1.0,
                    required=0.03,
                    source=BALANCE,
                    fails_if="a floor that gives another energy, contacts that lose another, or a law of "
                    "another power of the speed or of the number of layers",
                )
            )
        claims += [claim for bed in beds for claim in _of_bed(bed, name)]
    return claims


def _of_bed(bed: Row, name: str) -> list[Claim]:
    which = f"{name}, restitution {bed.restitution:g}"
    claims = [
        Claim(
            claim=f"energy lost in contacts over that which the floor gives, {which}",
            kind="identity",
            measured=bed.lost / bed.given.value,
            expected=1.0,
            required=0.01,
            source="conservation of energy in a steady state (the difference is what the bed stores)",
            fails_if="a bed that still cools or warms, or work that is not counted",
        ),
        Claim(
            claim=f"mean height times weight over the vertical temperature, {which}",
            measured=bed.height,
            expected=float(theory.bed_height(bed.packing_fraction)),
            required=0.01,
            source="the virial of a gas under gravity, to first order in its density",
            fails_if="falls or bounces that are not those of mechanics, discs of another size",
        ),
    ]
    if name == "sawtooth":
        claims.append(
            Claim(
                claim=f"energy given over weight and speed of the floor, {which}",
                kind="identity",
                measured=bed.given / bed.speed,
                expected=1.0,
                required=0.01,
                source="exact: a floor that always moves at one speed gives it times the force, the weight",
                fails_if="bounces in which the floor has another speed, or is missed",
            )
        )
    return claims
