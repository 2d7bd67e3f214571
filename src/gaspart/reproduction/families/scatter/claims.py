"""Claims about all claims."""

from __future__ import annotations

import xarray as xr

from gaspart.reproduction.claims import Claim

NORMAL = "a standard Gaussian distribution, if all claims are true and all uncertainties correct"


def claims_scatter(ds: xr.Dataset) -> list[Claim]:
    """The deviations of all values without an allowance are standard Gaussian numbers."""
    deviations = ds["deviation"].values[ds["scattered"].values]
    number = deviations.size
    if not number:
        return []
    expected = number / ds.sizes["class"]
    return [
        Claim.joint(
            claim="deviations of all values claimed without an allowance",
            deviations=deviations,
            source=NORMAL,
            fails_if="uncertainties that are too small or too large, or false claims",
        ),
        Claim.chi_square(
            claim=f"probabilities of these deviations in {ds.sizes['class']} equal classes "
            "(chi-square per degree of freedom)",
            chi_square=float(((ds["counts"] - expected) ** 2).sum() / expected),
            degrees_of_freedom=ds.sizes["class"] - 1,
            source=NORMAL,
            fails_if="deviations of one sign, too many near 0, or too many far away",
        ),
    ]
