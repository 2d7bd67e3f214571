"""Claims about displacement and velocity autocorrelation."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.statistics import combine_estimates
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared import ENSKOG_LIMIT, MODE_COUPLING, PARTICLES
from gaspart.reproduction.table import Row, Table, each

DILUTE_BAND = 0.007
"""Largest relative difference of D from Enskog theory in dilute gases. By Erpenbeck and Wood's fit it is 0.6
% at 0.02."""
ERPENBECK_WOOD = "[Erpenbeck 1991]"
REQUIRED = 0.015
"""Largest relative uncertainty of D for a conclusive claim."""
REQUIRED_SHORT = 0.001
"""Required uncertainty of the mean-squared displacement (msd) at short times.

An exponential with the rate of Enskog's D would deviate by 0.001 to 0.002.
"""


def msd_spheres(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on D, compared with Enskog theory and with published simulations.

    Dilute gases are compared with Enskog theory, dense gases with simulations from the literature.
    """
    points = Table(ds, "point")
    largest = points[points.largest]
    dilute = largest.packing_fraction <= ENSKOG_LIMIT * (1.0 + 1e-6)
    dense = largest[~dilute]
    return [
        _dilute_limit(largest[dilute]),
        *each(
            dense,
            "D over Erpenbeck and Wood's at packing fraction {packing_fraction:g}",
            measured=infinite(dense) / theory.erpenbeck_wood_diffusion(dense.packing_fraction),
            expected=Estimate(1.0, theory.ERPENBECK_WOOD_UNCERTAINTY),
            required=REQUIRED,
            source=ERPENBECK_WOOD,
            allowance_source="its largest difference from [Pieprzyk 2019]",
            fails_if="correlated collisions missing, a msd not yet straight, a wrong finite-size correction",
        ),
        *([_size_slope(points)] if points.in_series.any() else []),
        *_short_times(points),
    ]


def infinite(points: Table) -> Estimate:
    """Compute D in an infinite container."""
    return points.diffusion + Estimate(points.correction, points.correction_uncertainty)


def _dilute_limit(dilute: Table) -> Claim:
    """Return the claim on D divided by Enskog's D at the lowest packing fractions.

    The claim is about the mean of these ratios, weighted by their errors.
    """
    return Claim.within(
        claim=f"D over Enskog's in the dilute limit (packing fraction {ENSKOG_LIMIT:g} and below)",
        measured=combine_estimates(infinite(dilute) / theory.enskog_diffusion(dilute.packing_fraction, 3)),
        expected=1.0,
        half_width=DILUTE_BAND,
        source="Enskog theory, 1.01895 times the first Sonine approximation",
        alternative=1.0 / 1.01895,
        fails_if="a wrong mean free path, or a msd not yet straight; the first approximation is 1.9 % low",
    )


def _size_slope(points: Table) -> Claim:
    first = points[points.in_series][0]
    expected = -first.correction * first.side
    return Claim(
        claim=f"slope of D against 1/L at packing fraction {first.packing_fraction:g}",
        measured=points.size_slope,
        expected=expected,
        required=0.15 * abs(expected),
        source="[Yeh 2004], with the measured viscosity and modes that decay with nu + D",
        alternative=0.0,
        fails_if="D that does not depend on the container as hydrodynamics states",
    )


def msd_discs(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on the slope of D(t) against ln t; discs have no finite D."""
    points = Table(ds, "point")
    long = points[np.isfinite(points.logarithmic_slope.value)]
    return [
        *each(
            long,
            "slope of D(t) against ln t at packing fraction {packing_fraction:g}",
            measured=long.logarithmic_slope,
            expected=long.slope_expected,
            required=0.15 * long.slope_expected,
            source=MODE_COUPLING,
            alternative=0.0,
            fails_if="a velocity autocorrelation that has no 1/t tail, so that D exists",
        ),
        *_short_times(points),
    ]


def _short_times(points: Table) -> list[Claim]:
    """Return the claims from finely sampled runs.

    The claims concern the ballistic start, and D(t) from Einstein's relation compared with D(t) from the
    Green-Kubo relation.
    """
    claims = []
    for run in points[np.isfinite(points.integral_difference.value)]:
        eta = run.packing_fraction
        enskog = theory.enskog_mean_squared_displacement(run.time[1], eta, run.dimension)
        claims += [
            Claim.within(
                claim=f"Green-Kubo integral over Einstein slope at packing fraction {eta:g}",
                kind="identity",
                measured=run.integral_difference + 1.0,
                expected=1.0,
                half_width=0.01,
                source="stationarity (exact)",
                fails_if="displacements that are not the integral of the velocities, or sampling too coarse",
            ),
            Claim(
                claim=f"msd over Enskog's after {run.interval:.2g} collisions, packing fraction {eta:g}",
                measured=run.msd[1] / enskog,
                expected=1.0,
                required=REQUIRED_SHORT,
                source="the linear Boltzmann equation at Enskog's collision rate, exact before correlated "
                "collisions",
                fails_if="a wrong temperature, time or initial decay of the velocity",
            ),
        ]
    return claims


def velocity_autocorrelation(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on the exact initial decay, and on the amplitude of the long-time tail."""
    return [claim for gas in Table(ds, "point") for claim in _of_gas(gas)]


def _of_gas(gas: Row) -> list[Claim]:
    claims, which = [], f"{PARTICLES[gas.dimension]}, packing fraction {gas.packing_fraction:.2g}"
    if np.isfinite(gas.start_rate.value):
        claims.append(
            Claim(
                claim=f"initial decay of C(t) over 2 nu / d, {which}",
                measured=gas.start_rate / (2.0 / gas.dimension),
                expected=1.0,
                required=0.005,
                source="Enskog, exact at the start: contacts of equilibrium, velocities not yet correlated",
                fails_if="a wrong collision rate or impulse",
            )
        )
    if np.isfinite(gas.tail_ratio.value):
        window = f"collisions {gas.tail_from:.3g} to {gas.tail_to:.3g}, {which}"
        claims.append(
            Claim(
                claim=f"long-time tail over the sum of the container's modes, extrapolated from {window}",
                measured=gas.tail_ratio,
                expected=1.0,
                required=0.1,
                source=MODE_COUPLING,
                alternative=0.0,
                fails_if="no vortex forms about a moving particle, or the wrong viscosity spreads it",
            )
        )
    return claims
