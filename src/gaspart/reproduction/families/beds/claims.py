"""Claims about piles at rest, discharge and vibrated beds."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.statistics import Fit, combine, fit_polynomial, mean_of
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.table import Row, Table
from gaspart.theory.granular import DISCHARGE_EXPONENT

BEVERLOO = "[Beverloo 1961], in two dimensions: free fall from an arch as wide as the orifice"


def settling(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on rest, contacts of a pile, and the law of discharge.

    All discs come to rest. A pile has as many contacts as mechanical equilibrium requires.
    """
    return [*_piles(Table(dataset, "pile")), *_flows(Table(dataset, "orifice"))]


def _piles(piles: Table) -> list[Claim]:
    return [
        Claim.at_most(
            claim="kinetic energy of a pile in the end over m (g h t_c)^2 / 2, that of contacts that last",
            measured=Estimate(piles.residual.max()),
            bound=1.0,
            required=0.0,
            source="contacts dissipate until each follows the last one within t_c (estimate, row of discs)",
            fails_if="contacts that last give energy, or keep more of it than they must",
        ),
        Claim.at_most(
            claim="largest displacement of a disc after rest, in diameters",
            measured=Estimate(piles.displacement.max()),
            bound=0.0,
            required=0.0,
            source="rest is rest (by construction)",
            kind="identity",
            fails_if="a pile at rest moves again",
        ),
        Claim.at_most(
            claim="largest rise of the energy of a pile between two frames, over its initial energy",
            measured=Estimate(piles.rise.max()),
            bound=1e-6,
            required=0.0,
            source="contacts never give energy; the frames have seven digits",
            fails_if="contacts that last, or rest, give energy",
        ),
        *(
            Claim.within(
                claim=f"contacts of a disc of a pile at rest, those with walls too, t_c = {duration:g}",
                measured=mean_of(alike.final_contacts),
                expected=2.0,
                half_width=0.1,
                source="Maxwell's count: two forces on each smooth disc vanish, and discs of unequal sizes "
                "have no more contacts than these equations need",
                fails_if="discs that are held by less than equilibrium needs, or rest that depends on t_c; a "
                "triangular lattice would have 3",
            )
            for duration, alike in piles.by("duration")
        ),
    ]


def _flows(flows: Table) -> list[Claim]:
    claims = [
        Claim(
            claim="exponent of the rate of flow against the width of the orifice less k diameters, k fitted",
            measured=flows.exponent,
            expected=DISCHARGE_EXPONENT,
            required=0.25,
            source=BEVERLOO,
            alternative=1.0,
            fails_if="a flow whose speed does not depend on the width, as that of a liquid",
        ),
        Claim.at_most(
            claim="ln of the rate of flow in the first half over that in the second, over a liquid's",
            measured=_log_head_ratio(flows) / float(np.log(flows.liquid_ratio).mean()),
            bound=0.5,
            required=0.15,
            source="walls carry most of what lies above, as in an hourglass (Beverloo et al.), less so in "
            "a filling that is not high; 1 of a liquid, which has the square root of its height",
            fails_if="a flow that is driven by the weight of what lies above, as that of a liquid",
        ),
    ]
    if (freedom := len(flows) - 2) > 0:
        claims.append(
            Claim.chi_square(
                claim="deviations from Beverloo's law, exponent 3/2 (chi-square per degree of freedom)",
                chi_square=flows.chi_square,
                degrees_of_freedom=freedom,
                error_freedom=flows.exponent.freedom,
                source=BEVERLOO,
                fails_if="another law",
            )
        )
    return claims


def _log_head_ratio(flows: Table) -> Estimate:
    """Average ln(head_ratio) over all orifices.

    The errors of all orifices are computed from one common scatter. The mean has the degrees of freedom of
    this scatter.
    """
    ratio = flows.head_ratio
    mean = combine(np.log(ratio.value), ratio.error / ratio.value)
    return Estimate(mean.value, mean.error, ratio.freedom[0])


WAVEFORMS = {0: "sawtooth", 1: "sine"}
"""Names of the waveforms of the floor's motion."""
BALANCE = (
    "energy balance of an isothermal, nearly elastic bed, to first order in the density "
    "(gaspart.theory.vibrated), losses at the floor included; the form is that of [Kumaran 1998] and of "
    "[McNamara 1998]"
)


def small_parameter(beds: Table) -> np.ndarray:
    """Compute the power that each bed would lose, divided by its weight and by sqrt(T)."""
    return np.asarray(theory.bed_loss(beds.layers, beds.restitution, beds.packing_fraction))


def expected_temperature(beds: Table) -> np.ndarray:
    """Compute the temperature of each bed in the limit of small `small_parameter`."""
    of = beds.layers, beds.restitution, beds.packing_fraction
    sawtooth, sine = theory.sawtooth_temperature(*of), theory.sine_temperature(*of)
    return np.where(beds.sine == 1, sine, sawtooth) * beds.speed**2


def extrapolation(beds: Table) -> Fit:
    """Fit measured over theoretical temperature by a second-order polynomial in `small_parameter`."""
    ratio = beds.temperature / expected_temperature(beds)
    return fit_polynomial(small_parameter(beds), ratio, powers=(0, 1, 2))


def vibrated_bed(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on the energy balance, the temperature and the height of vibrated beds.

    The floor supplies the energy that is lost in collisions.
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
