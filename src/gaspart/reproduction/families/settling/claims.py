"""Claims about piles and flow through an orifice."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import combine, mean_of
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.table import Table
from gaspart.theory.granular import DISCHARGE_EXPONENT

BEVERLOO = "[Beverloo 1961], in two dimensions: free fall from an arch as wide as the orifice"


def settling(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on rest, contacts of a pile, and the law of discharge.

    Rest is rest, and a pile has as many contacts as its equilibrium needs.
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
    """Average over all orifices, whose errors have one scatter in common.

    So they have its degrees of freedom in common.
    """
    ratio = flows.head_ratio
    mean = combine(np.log(ratio.value), ratio.error / ratio.value)
    return Estimate(mean.value, mean.error, ratio.freedom[0])
