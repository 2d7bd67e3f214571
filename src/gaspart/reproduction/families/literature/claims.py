"""Claims about our values compared with values by others."""

from __future__ import annotations

import xarray as xr

from gaspart.reproduction.claims import Claim
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.table import Table, each

EQUILIBRIUM = ("Z", "Z_crystal", "pressure")
NAMES = {
    "Z": "Z of the fluid of",
    "Z_crystal": "Z of the face-centred cubic crystal of",
    "pressure": "pressure of",
    "diffusion": "diffusion coefficient of",
    "viscosity": "viscosity of",
    "conductivity": "conductivity of",
}
REQUIRED = {"Z": 1e-3, "Z_crystal": 1e-3, "diffusion": 0.015, "viscosity": 0.1, "conductivity": 0.1}
"""Relative uncertainty of our values above which a claim is inconclusive.

The uncertainty of the other values is up to 1e-5, 0.2 % and 3 to 11 %.
"""
SOURCES = {
    "Chudak": "runs by the program DynamO of an author of [Pieprzyk 2019]",
    "DynamO test": "[Bannerman 2011], expected by a test of its authors' program",
    "DynamO tutorial": "[Bannerman 2011], a run of its authors' tutorial",
}
"""Names of sources that are not the keys of references."""


def literature(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims that each value agrees with others, and all together."""
    values = Table(dataset, "value")
    named = values.assign(
        name=[NAMES[quantity] for quantity in values.quantity],
        particles=[PARTICLES[dimension] for dimension in values.dimension],
    )
    own = named[named.judged == 1]
    required = [REQUIRED[row.quantity] * row.theirs.value for row in own]
    static = [quantity in EQUILIBRIUM for quantity in values.quantity]
    return [
        *each(
            own,
            "{name} {particles} at packing fraction {packing_fraction:.4g}, {count} particles, by {source}",
            measured=own.ours,
            expected=own.theirs,
            required=required,
            source=[_cite(source) for source in own.source],
            allowance_source="their statement",
            fails_if="contacts are missed, correlations cut too early, or finite numbers act otherwise",
        ),
        *_together(values[static], "Z and pressures beside those of others"),
        *_together(
            values[[not is_static for is_static in static]], "transport coefficients beside those of others"
        ),
    ]


def _cite(source: str) -> str:
    return SOURCES.get(source, f"[{source}]")


def _together(values: Table, claim: str) -> list[Claim]:
    """Return the claim that deviations scatter as the uncertainties of both state."""
    if not values:
        return []
    return [
        Claim.joint(
            claim=claim,
            deviations=(values.ours - values.theirs).deviation,
            source=f"programs of others: {', '.join(map(_cite, dict.fromkeys(values.source)))}",
            fails_if="a bias too small for one value is common to many, or error bars are wrong",
        )
    ]
