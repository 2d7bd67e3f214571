"""Claims about memory: how long a reversed run returns to its start."""

from __future__ import annotations

import math

import xarray as xr

from gaspart.reproduction.claims import Claim
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.table import Row, Table

ROUNDINGS = math.log(0.1 * 2.0**53)
"""ln of the distance at which the memory is lost, in diameters, over the rounding of a coordinate of 1."""


def reversibility(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on the growth of echoes, and on the memory of exact runs.

    The growth is compared with the distance of neighbouring runs.
    """
    runs = Table(ds, "row")
    exact = runs[runs.engine == "event"]  # of time steps nothing is known but what the figure shows
    return [claim for run in exact for claim in _growth(run)]


def _growth(run: Row) -> list[Claim]:
    gas = f"{PARTICLES[run.dimension]}, packing fraction {run.packing_fraction:g}"
    return [
        Claim(
            claim=f"growth of the echo over that of two neighbouring runs, {gas}",
            measured=run.growth / run.divergence,
            expected=1.0,
            required=0.1,
            source="time reversal: a flow and its reverse have the same exponents",
            fails_if="the backward run is not the reverse of the forward run",
        ),
        Claim(
            claim=f"growth of the echo over the largest Lyapunov exponent, {gas}",
            measured=run.growth / run.exponent,
            expected=1.0,
            required=0.1,
            source="the linearised dynamics of the same gas, by gaspart.analysis.lyapunov; the growth of the "
            "exponent with dilution is that of [van Zon 1998]",
            fails_if="the engine amplifies errors more or less than collisions of hard particles do",
        ),
        Claim.within(
            claim=f"growth of the echo times the memory, {gas}",
            measured=run.growth * run.memory,
            expected=ROUNDINGS - math.log(run.side),
            half_width=5.0,
            source="ln(0.1 2^53 sigma / L): only the rounding of coordinates up to L is lost",
            fails_if="an error larger than rounding is made, or the engine replays instead of integrating",
        ),
    ]
