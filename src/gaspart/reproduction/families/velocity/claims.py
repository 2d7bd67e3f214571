"""Claims about the velocity autocorrelation."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import MODE_COUPLING, PARTICLES, rows


def velocity_autocorrelation(ds: xr.Dataset) -> list[Claim]:
    """The initial decay, which is exact, and the amplitude of the long-time tail."""
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
                    claim=f"long-time tail over the sum of the container's modes, extrapolated from {window}",
                    measured=Estimate.of(row, "tail_ratio"),
                    expected=1.0,
                    required=0.1,
                    source=MODE_COUPLING,
                    alternative=0.0,
                    fails_if="no vortex forms about a moving particle, or the wrong viscosity spreads it",
                )
            ]
    return claims
