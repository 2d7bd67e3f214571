"""Claims about one packing fraction at several radii."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import combine, fit_power_law
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import deviations, freedoms
from gaspart.reproduction.families.shared.rows import estimates


def radius_grid(dataset: xr.Dataset) -> list[Claim]:
    """Z depends on the packing fraction alone; the counted costs are as predicted."""
    event = dataset.isel(point=dataset["engine"].values == "event")
    step = dataset.isel(point=dataset["engine"].values == "step")
    same, other = (event.isel(point=event["series"].values == name) for name in ("packing fraction", "count"))
    return [
        _same_state(same),
        _reference(other),
        _crossings(event),
        _scale_invariance(same),
        _pair_tests(step),
    ]


def _same_state(same: xr.Dataset) -> Claim:
    """No theory but the 1/N correction: the values are compared with their own mean."""
    values, errors = estimates(same, "Z")
    mean = combine(values, errors, freedoms(same, "Z"))
    radii, eta = same["radius"].values, float(same["packing_fraction"][0])
    return Claim.chi_square(
        claim=f"one Z at packing fraction {eta:.3g} for all radii, {radii.min():.3g} "
        f"to {radii.max():.3g} (N = {int(same['count'].min())} to {int(same['count'].max())}), "
        "corrected to first order in 1/N (chi-square per degree of freedom about their mean)",
        chi_square=mean.chi_square,
        degrees_of_freedom=mean.degrees_of_freedom,
        error_freedom=mean.error_freedom,
        source="hard spheres have no length but their diameter: Z is a function of the packing fraction",
        fails_if="something depends on the radius other than through the packing fraction, or the 1/N "
        "correction is wrong",
    )


def _reference(other: xr.Dataset) -> Claim:
    return Claim.joint(
        claim=f"Z of N = {int(other['count'][0])} at all radii against the equation of state",
        deviations=deviations(other, "Z", "reference"),
        source="[Kolafa 2004], shifted to first order in 1/N",
        fails_if="Z is biased at some radius",
    )


def _crossings(event: xr.Dataset) -> Claim:
    return Claim.joint(
        claim="crossings of box boundaries per particle and time over d <|v_x|> (n-1)/L, all radii",
        deviations=deviations(event, "crossings", 1.0),
        source="kinetic theory, exact in equilibrium",
        fails_if="crossings are missed or counted twice, or velocities are not Maxwellian",
    )


def _scale_invariance(same: xr.Dataset) -> Claim:
    """The exponent of a collision's cost against the radius at one packing fraction is 0."""
    law = fit_power_law(same["radius"].values, same["pair_tests"].values)
    return Claim.within(
        claim="exponent of the event-driven engine's pair tests per collision, "
        "against the radius at one packing fraction",
        measured=law.estimate,
        expected=0.0,
        half_width=0.05,
        source="scale invariance: the same gas, enlarged, except for periodic images (order 1/n)",
        fails_if="the cost of a collision depends on the number of particles",
    )


def _pair_tests(step: xr.Dataset) -> Claim:
    ratios = (step["pair_tests"] / step["pair_tests_expected"]).values
    return Claim.within(
        claim="pair tests per particle and step over those expected, time-stepped, mean over all radii",
        measured=Estimate(ratios.mean(), ratios.std(ddof=1) / np.sqrt(ratios.size)),
        expected=1.0,
        half_width=0.01,
        source="half of the particles in 3^d boxes, minus the hole that each makes: "
        "f N + (S - 1) - f S, 1/S = d(eta Z)/d eta",
        fails_if="pairs are tested twice or missed, or particles are kept in wrong boxes",
    )
