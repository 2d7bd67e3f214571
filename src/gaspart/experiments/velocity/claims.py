"""Claims about the velocity autocorrelation."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.claims import Claim, Estimate
from gaspart.experiments.shared.claims import MODE_COUPLING, PARTICLES, rows


def velocity_autocorrelation(ds: xr.Dataset) -> list[Claim]:
    """The initial decay, which is exact, and the amplitude and exponent of the long-time tail."""
    claims = []
    for row in rows(ds, "point"):
        dimension, eta = int(row["dimension"]), float(row["packing_fraction"])
        which = f"{PARTICLES[dimension]}, packing fraction {eta:.2g}"
        if np.isfinite(row["start_rate"]):
            claims.append(
                Claim(
                    claim=f"initial decay of C(t) over 2 nu / d, {which}",
                    measured=Estimate.of(row, "start_rate") / (2.0 / dimension),
                    expected=1.0,
                    required=0.005,
                    source="Enskog, exact at the start: contacts of equilibrium, velocities not yet "
                    "correlated",
                    fails_if="a wrong collision rate or impulse",
                )
            )
        if np.isfinite(row["tail_ratio"]):
            window = f"collisions {float(row['tail_from']):.3g} to {float(row['tail_to']):.3g}, {which}"
            claims += [
                Claim(
                    claim=f"long-time tail over ((d-1)/(d rho)) [4 pi (D+nu) t]^(-d/2), {window}",
                    measured=Estimate.of(row, "tail_ratio"),
                    expected=Estimate(1.0, spreading_uncertainty(dimension, eta)),
                    required=0.05,
                    source=MODE_COUPLING,
                    fails_if="no vortex forms about a moving particle, or the wrong viscosity spreads it",
                ),
                Claim(
                    claim=f"exponent of the long-time tail, {window}",
                    measured=Estimate.of(row, "tail_exponent"),
                    expected=Estimate(-0.5 * dimension, 0.05 * dimension),
                    required=0.1 * dimension,
                    source=MODE_COUPLING,
                    fails_if="an exponential decay, or momentum that spreads other than by diffusion",
                ),
            ]
    return claims


def spreading_uncertainty(dimension: int, eta: float) -> float:
    """Relative uncertainty of the tail's amplitude, (d/2) dD / (D + nu): the D of a fluid is above Enskog's.

    Spheres: by as much as Erpenbeck and Wood's; discs: by what the tail itself has added to D(t) since the
    first of twenty collisions.
    """
    enskog = float(theory.enskog_diffusion(eta, dimension))
    viscosity = float(theory.enskog_viscosity(eta, dimension)) / theory.number_density(eta, dimension)
    if dimension == 3:
        more = abs(float(theory.erpenbeck_wood_ratio(eta)) - 1.0) * enskog
    else:
        more = float(theory.logarithmic_slope(eta)) * math.log(20.0)
    return 0.5 * dimension * more / (enskog + viscosity)
