"""What the figure of random insertion claims."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.claims import Claim
from gaspart.theory.insertion import insertion_saturation_uncertainty

SOURCE_FRACTION = 0.52
"""What source A's program reached (section 3.2), stated to the percent: 180 spheres are 0.5226."""
SOURCE_ROUNDING = 0.01 / np.sqrt(12.0)
DILUTE_THEORY = 0.005
"""Relative error of the low-density failures summed to 0.04: the neglected third order, 1 % at 0.05 in 3D."""
NAMES = {
    "periodic": "periodic",
    "wall": "wholly inside walls",
    "centres_to_walls": "with centres up to the walls",
}


def fill_failures(dataset: xr.Dataset) -> list[Claim]:
    """Saturations, source A's 52 %, the way to saturation, and the failures at low density."""
    claims = []
    for k in range(dataset.sizes["container"]):
        one = dataset.isel(container=k)
        if np.isfinite(one["saturation"][0]):
            claims.append(_saturation(one))
            if str(one["rule"].values) == "centres_to_walls":
                claims.append(_source(one))
        if np.isfinite(one["approach"]):
            claims.append(_approach(one))
        # Where a fill goes on to saturation, the few bodies of its beginning say little.
        if np.isfinite(one["dilute_failures"]) and not np.isfinite(one["saturation"][0]):
            claims.append(_dilute(one, float(dataset.attrs["dilute_up_to"])))
    return claims


def _bodies(one: xr.Dataset) -> str:
    bodies = "discs" if int(one["dimension"]) == 2 else "spheres"
    return f"{bodies} {NAMES[str(one['rule'].values)]} (L/σ = {float(one['side_over_diameter']):.3g})"


def _saturation(one: xr.Dataset) -> Claim:
    dimension, side, rule = int(one["dimension"]), float(one["side_over_diameter"]), str(one["rule"].values)
    if rule == "periodic":
        required, source = 1e-3, "Zhang and Torquato 2013"
    else:
        required, source = (
            4e-3,
            "Zhang and Torquato 2013, times the wall excess (1 + 0.64 σ/L')^3 of saturated fills",
        )
    return Claim(
        f"saturation of random insertion, {_bodies(one)}, extrapolated in attempts^(-1/{dimension})",
        "test",
        float(one["saturation"][0]),
        float(one["saturation_error"][0]),
        required,
        theory.insertion_saturation(dimension, side, rule),
        source,
        expected_uncertainty=insertion_saturation_uncertainty(dimension, side, rule),
        fails_if="free places are missed, overlaps are accepted, or the late window is not asymptotic",
    )


def _approach(one: xr.Dataset) -> Claim:
    dimension = int(one["dimension"])
    return Claim.within(
        f"exponent p of (saturation - packing fraction) ~ attempts^-p, {_bodies(one)}",
        "test",
        float(one["approach"]),
        float(one["approach_error"]),
        1.0 / dimension,
        0.15 / dimension,
        "Feder 1980, Swendsen 1981: 1/d, once only single holes are left",
        "the window is too early, or attempts are counted wrongly",
    )


def _source(one: xr.Dataset) -> Claim:
    """Source A's one fill beside many of ours: a draw from their distribution, as far as it was patient."""
    return Claim(
        f"packing fraction at which insertion ends, {_bodies(one)}, whole spheres counted: source A's 52 %",
        "reproduction",
        float(one["saturation"][0]),
        float(one["saturation_error"][0]),
        4e-3,
        SOURCE_FRACTION,
        "source A, section 3.2: a single fill, whose own spread is taken from ours",
        expected_uncertainty=float(np.hypot(one["final_spread"], SOURCE_ROUNDING)),
        fails_if="source A counted or placed its spheres by another rule",
    )


def _dilute(one: xr.Dataset, up_to: float) -> Claim:
    return Claim(
        f"failed attempts up to packing fraction {up_to:g} over those expected, {_bodies(one)}",
        "test",
        float(one["dilute_failures"]),
        float(one["dilute_failures_error"]),
        0.02,
        1.0,
        "available fraction 1 - 2^d η + c η^2, exact to that order",
        expected_uncertainty=DILUTE_THEORY,
        fails_if="failures are counted wrongly, or overlaps with near neighbours are missed or made up",
    )
