"""What the figure about the memory of velocities claims."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.claims import Claim

NAMES = {2: "discs", 3: "spheres"}
MODE_COUPLING = "mode coupling with Enskog's D and viscosity (Ernst, Hauge & van Leeuwen 1970; recalled)"


def velocity_autocorrelation(ds: xr.Dataset) -> list[Claim]:
    """The initial decay, which is exact, and the amplitude and exponent of the long-time tail."""
    claims = []
    for row in (ds.isel(point=k) for k in range(ds.sizes["point"])):
        dimension, eta = int(row["dimension"]), float(row["packing_fraction"])
        which = f"{NAMES[dimension]}, packing fraction {eta:.2g}"
        if np.isfinite(row["start_rate"]):
            exact = 2.0 / dimension
            claims.append(
                Claim(
                    f"initial decay of C(t) over 2 nu / d, {which}",
                    "test",
                    float(row["start_rate"]) / exact,
                    float(row["start_rate_error"]) / exact,
                    0.005,
                    1.0,
                    "Enskog, exact at the start: contacts of equilibrium, velocities not yet correlated",
                    fails_if="a wrong collision rate or impulse",
                )
            )
        if np.isfinite(row["tail_ratio"]):
            window = f"collisions {float(row['tail_from']):.3g} to {float(row['tail_to']):.3g}, {which}"
            claims += [
                Claim(
                    f"long-time tail over ((d-1)/(d rho)) [4 pi (D+nu) t]^(-d/2), {window}",
                    "test",
                    float(row["tail_ratio"]),
                    float(row["tail_ratio_error"]),
                    0.05,
                    1.0,
                    MODE_COUPLING,
                    spreading_uncertainty(dimension, eta),
                    "no vortex forms about a moving body, or the wrong viscosity spreads it",
                ),
                Claim(
                    f"exponent of the long-time tail, {window}",
                    "test",
                    float(row["tail_exponent"]),
                    float(row["tail_exponent_error"]),
                    0.1 * dimension,
                    -0.5 * dimension,
                    MODE_COUPLING,
                    0.05 * dimension,
                    "an exponential decay, or momentum that spreads otherwise than by diffusion",
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
