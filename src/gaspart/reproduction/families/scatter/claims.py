"""Claims about the statistics of all claims."""

from __future__ import annotations

import math

import xarray as xr

from gaspart.analysis.statistics import jackknife
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.table import Table

NORMAL = "a standard Gaussian distribution, if all claims are true and all uncertainties correct"
MEAN_ERROR = 0.1
"""Required uncertainty of the mean deviation. A mean of 0.3 is then detected; it adds 9 % to the mean square.
Many small errors of equal sign cause such a mean."""


def claims_scatter(ds: xr.Dataset) -> list[Claim]:
    """Return the claims that all scattered deviations are standard Gaussian numbers.

    Scattered deviations are the signed deviations of values without an allowance.
    """
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
        Claim(
            claim="mean of these deviations, signed",
            measured=mean_deviation(Table(ds, "name")),
            expected=0.0,
            required=MEAN_ERROR,
            source=NORMAL,
            fails_if="finite numbers, starts or normalisations that shift many values by little, to one side",
        ),
    ]


def mean_deviation(figures: Table) -> Estimate:
    """Compute the mean of all scattered deviations, with equal weights.

    Values of one figure come from the same runs, and may deviate together. Values of different figures are
    independent. Therefore the error is the jackknife error over figures, which allows for any correlations
    within a figure. The result is NaN for fewer than two figures.
    """
    stating = figures[figures.number > 0]
    if len(stating) < 2:
        return Estimate(math.nan, math.nan)
    mean = jackknife(lambda total, number: total / number, stating.total, stating.number)
    return Estimate(*mean, len(stating) - 1)
