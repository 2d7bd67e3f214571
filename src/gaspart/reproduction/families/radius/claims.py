"""Claims about one packing fraction at several radii."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import combine, fit_power_law
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.table import Table


def radius_grid(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims that Z depends on packing fraction alone, and on predicted costs."""
    table = Table(dataset, "point")
    event, step = (table[table.engine == name] for name in ("event", "step"))
    same, other = (event[event.series == name] for name in ("packing fraction", "count"))
    ratios = step.pair_tests / step.pair_tests_expected
    return [
        _same_state(same),
        Claim.joint(
            claim=f"Z of N = {other.count[0]:.0f} at all radii against the equation of state",
            deviations=(other.Z - other.reference).deviation,
            source="[Kolafa 2004], shifted to first order in 1/N",
            fails_if="Z is biased at some radius",
        ),
        Claim.joint(
            claim="crossings of box boundaries per particle and time over d <|v_x|> (n-1)/L, all radii",
            deviations=(event.crossings - 1.0).deviation,
            source="kinetic theory, exact in equilibrium",
            fails_if="crossings are missed or counted twice, or velocities are not Maxwellian",
        ),
        Claim.within(
            claim="exponent of the event-driven engine's pair tests per collision, "
            "against the radius at one packing fraction",
            measured=fit_power_law(same.radius, same.pair_tests).estimate,
            expected=0.0,
            half_width=0.05,
            source="scale invariance: the same gas, enlarged, except for periodic images (order 1/n)",
            fails_if="the cost of a collision depends on the number of particles",
        ),
        Claim.within(
            claim="pair tests per particle and step over those expected, time-stepped, mean over all radii",
            measured=Estimate(ratios.mean(), ratios.std(ddof=1) / np.sqrt(ratios.size)),
            expected=1.0,
            half_width=0.01,
            source="half of the particles in 3^d boxes, minus the hole that each makes: "
            "f N + (S - 1) - f S, 1/S = d(eta Z)/d eta",
            fails_if="pairs are tested twice or missed, or particles are kept in wrong boxes",
        ),
    ]


def _same_state(same: Table) -> Claim:
    """Return the claim that values of Z at one packing fraction agree with their own mean.

    It uses no theory but the 1/N correction.
    """
    mean, radii, counts = combine(same.Z), same.radius, same.count
    return Claim.chi_square(
        claim=f"one Z at packing fraction {same.packing_fraction[0]:.3g} for all radii, "
        f"{radii.min():.3g} to {radii.max():.3g} (N = {counts.min():.0f} to {counts.max():.0f}), "
        "corrected to first order in 1/N (chi-square per degree of freedom about their mean)",
        chi_square=mean.chi_square,
        degrees_of_freedom=mean.degrees_of_freedom,
        error_freedom=mean.error_freedom,
        source="hard spheres have no length but their diameter: Z is a function of the packing fraction",
        fails_if="something depends on the radius other than through the packing fraction, or the 1/N "
        "correction is wrong",
    )
