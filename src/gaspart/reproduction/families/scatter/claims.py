"""Claims about all claims."""

from __future__ import annotations

import xarray as xr

from gaspart.reproduction.claims import Claim
from gaspart.reproduction.table import Table

NORMAL = "a standard Gaussian distribution, if all claims are true and all uncertainties correct"


def claims_scatter(ds: xr.Dataset) -> list[Claim]:
    """The deviations of all values without an allowance are standard Gaussian numbers."""
    claims, classes = Table(ds, "claim"), Table(ds, "class")
    deviations = claims.deviation[claims.scattered]
    if not deviations.size:
        return []
    expected = deviations.size / len(classes)
    return [
        Claim.joint(
            claim="deviations of all values claimed without an allowance",
            deviations=deviations,
            source=NORMAL,
            fails_if="uncertainties that are too small or too large, or false claims",
        ),
        Claim.chi_square(
            claim=f"probabilities of these deviations in {len(classes)} equal classes "
            "(chi-square per degree of freedom)",
            chi_square=float(((classes.counts - expected) ** 2).sum() / expected),
            degrees_of_freedom=len(classes) - 1,
            source=NORMAL,
            fails_if="deviations of one sign, too many near 0, or too many far away",
        ),
    ]
