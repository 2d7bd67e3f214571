"""Claims about random insertion."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import PARTICLES, rows
from gaspart.theory.insertion import insertion_saturation_uncertainty

NO_PROGRAM = "the wall excess was fitted to insertions by a program that is not in this repository"
SOURCE_FRACTION = 0.52
"""What source A's program reached (section 3.2), stated to the percent: 180 spheres are 0.5226."""
SOURCE_ROUNDING = 0.01 / np.sqrt(12.0)
NAMES = {
    "periodic": "periodic",
    "wall": "entirely inside walls",
    "centres_to_walls": "with centres up to the walls",
}


def fill_failures(dataset: xr.Dataset) -> list[Claim]:
    """Saturations, source A's 52 %, the approach to saturation, and the failures at low density."""
    claims = []
    for one in rows(dataset, "container"):
        saturates = bool(np.isfinite(one["saturation"][0]))
        if saturates:
            claims.append(_saturation(one))
            if str(one["rule"].values) == "centres_to_walls":
                claims.append(_source(one))
        if np.isfinite(one["approach"]):
            claims.append(_approach(one))
        # Of a fill that continues to saturation, the first few particles carry little information.
        if np.isfinite(one["dilute_failures"]) and not saturates:
            claims.append(_dilute(one, float(dataset.attrs["dilute_up_to"])))
    return claims


def _particles(one: xr.Dataset) -> str:
    particles = PARTICLES[int(one["dimension"])]
    return f"{particles} {NAMES[str(one['rule'].values)]} (L/σ = {float(one['side_over_diameter']):.3g})"


def _saturation(one: xr.Dataset) -> Claim:
    dimension, side, rule = int(one["dimension"]), float(one["side_over_diameter"]), str(one["rule"].values)
    wall = "" if rule == "periodic" else ", times the wall excess (1 + 0.64 σ/L')^3 of saturated fills"
    return Claim(
        claim=f"saturation of random insertion, {_particles(one)}, extrapolated in attempts^(-1/{dimension})",
        measured=Estimate.of(one.isel(window=0), "saturation"),
        expected=Estimate(
            theory.insertion_saturation(dimension, side, rule),
            insertion_saturation_uncertainty(dimension, side, rule),
        ),
        required=1e-3 if rule == "periodic" else 4e-3,
        source=f"[Zhang 2013]{wall}",
        allowance_source="its last digits"
        if rule == "periodic"
        else "a fit to insertions, not in this repository",
        no_verdict="" if rule == "periodic" else NO_PROGRAM,
        fails_if="free places are missed, overlaps are accepted, or the late window is not asymptotic",
    )


def _approach(one: xr.Dataset) -> Claim:
    dimension = int(one["dimension"])
    return Claim.within(
        claim=f"exponent p of (saturation - packing fraction) ~ attempts^-p, {_particles(one)}",
        measured=Estimate.of(one, "approach"),
        expected=1.0 / dimension,
        half_width=0.15 / dimension,
        source="[Feder 1980], [Swendsen 1981]: 1/d, once only single holes remain",
        fails_if="the window is too early, or attempts are counted wrongly",
    )


def _source(one: xr.Dataset) -> Claim:
    """Source A's one fill beside many of ours: a draw from their distribution, if its attempts sufficed."""
    return Claim(
        claim=f"packing fraction at which insertion ends, {_particles(one)}, whole spheres counted: "
        "source A's 52 %",
        kind="reproduction",
        measured=Estimate.of(one.isel(window=0), "saturation"),
        expected=Estimate(SOURCE_FRACTION, np.hypot(one["final_spread"], SOURCE_ROUNDING)),
        required=4e-3,
        source="[source A], section 3.2: a single fill",
        allowance_source="the scatter of our fills, as that of its one fill, and its rounding to a percent",
        why="its centres go up to the walls, and its spheres are counted completely",
        fails_if="source A counted or placed its spheres by another rule",
    )


def _dilute(one: xr.Dataset, up_to: float) -> Claim:
    return Claim(
        claim=f"failed attempts up to packing fraction {up_to:g} over those expected, {_particles(one)}",
        measured=Estimate.of(one, "dilute_failures"),
        expected=1.0,
        required=0.02,
        source="available fraction 1 - 2^d η + c η^2, exact to that order",
        fails_if="failures are counted wrongly, or overlaps with near neighbours are missed or spurious",
    )
