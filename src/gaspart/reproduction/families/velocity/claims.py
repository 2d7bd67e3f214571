"""Claims about the velocity autocorrelation."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.reproduction.claims import Claim
from gaspart.reproduction.families.shared import MODE_COUPLING, PARTICLES
from gaspart.reproduction.table import Row, Table


def velocity_autocorrelation(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on the exact initial decay, and on the long-time tail.

    The amplitude of the tail is claimed.
    """
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
