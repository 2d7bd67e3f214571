"""What the figure of one packing fraction at several radii claims."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import combine, fit_power_law
from gaspart.claims import Claim


def radius_grid(dataset: xr.Dataset) -> list[Claim]:
    """Z depends on the packing fraction alone; the counted costs are as predicted."""
    event = dataset.isel(point=dataset["engine"].values == "event")
    step = dataset.isel(point=dataset["engine"].values == "step")
    same, other = (event.isel(point=event["series"].values == name) for name in ("packing fraction", "count"))
    return [
        _same_state(same),
        _reference(other),
        _crossings(event),
        _lens(same),
        _pair_tests(step),
    ]


def _same_state(same: xr.Dataset) -> Claim:
    """No theory but the 1/N correction: the values are compared with their own mean."""
    mean = combine(same["Z"].values, same["Z_error"].values)
    radii, eta = same["radius"].values, float(same["packing_fraction"][0])
    return Claim.chi_square(
        f"one Z at packing fraction {eta:.3g} for all radii, {radii.min():.3g} "
        f"to {radii.max():.3g} (N = {int(same['count'].min())} to {int(same['count'].max())}), "
        "corrected to first order in 1/N (chi-square per degree of freedom about their mean)",
        "test",
        mean.chi_square,
        mean.degrees_of_freedom,
        "hard spheres have no length but their diameter: Z is a function of the packing fraction",
        "anything depends on the radius but through the packing fraction, or the 1/N correction is wrong",
    )


def _reference(other: xr.Dataset) -> Claim:
    spread = np.hypot(other["Z_error"], other["reference_error"])
    sigmas = ((other["Z"] - other["reference"]) / spread).values
    return Claim.chi_square(
        f"Z of N = {int(other['count'][0])} at all radii against the equation of state "
        "(chi-square per degree of freedom)",
        "test",
        float(np.sum(sigmas**2)),
        sigmas.size,
        "Kolafa, Labík and Malijevský 2004, shifted to first order in 1/N",
        "Z is biased at some radius",
    )


def _crossings(event: xr.Dataset) -> Claim:
    sigmas = ((event["crossings"] - 1.0) / event["crossings_error"]).values
    return Claim.chi_square(
        "crossings of box boundaries per body and time over d <|v_x|> (n-1)/L, all radii "
        "(chi-square per degree of freedom)",
        "test",
        float(np.sum(sigmas**2)),
        sigmas.size,
        "kinetic theory, exact in equilibrium",
        "crossings are missed or counted twice, or velocities are not Maxwellian",
    )


def _lens(same: xr.Dataset) -> Claim:
    """The exponent of a collision's cost against the radius at one packing fraction: none."""
    law = fit_power_law(same["radius"].values, same["pair_tests"].values)
    return Claim.within(
        "exponent of the event-driven engine's pair tests per collision, "
        "against the radius at one packing fraction",
        "test",
        law.exponent,
        law.exponent_error,
        0.0,
        0.05,
        "scale invariance: the same gas, enlarged, but for bodies that come round the container (order 1/n)",
        "the cost of a collision depends on the number of bodies",
    )


def _pair_tests(step: xr.Dataset) -> Claim:
    ratios = (step["pair_tests"] / step["pair_tests_expected"]).values
    return Claim.within(
        "pair tests per body and step over those expected, time-stepped, mean over all radii",
        "test",
        float(ratios.mean()),
        float(ratios.std(ddof=1) / np.sqrt(ratios.size)),
        1.0,
        0.01,
        "half of the bodies in 3^d boxes, less the hole that each makes: "
        "f N + (S - 1) - f S, 1/S = d(eta Z)/d eta",
        "pairs are tested twice or missed, or bodies are kept in wrong boxes",
    )
