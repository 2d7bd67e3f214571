"""Statistics of simulations: errors of correlated series, fits with covariance, and tests of distributions.

Conventions: `error` is one standard deviation of the estimate. Errors passed to a fit are standard deviations
of independent Gaussian scatter. They are treated as exact unless their degrees of freedom are passed. Arrays
are one-dimensional and of equal length unless noted. A `p_value` is the probability that chi-square would be
at least as large as observed if the model were correct. Functions raise ValueError if their inputs are too
short, of unequal length, or not finite.
"""

from gaspart.analysis.statistics.blocks import (
    CorrelatedMean,
    Histogram,
    autocorrelation_time,
    common_freedom,
    correlated_mean,
    count_changes,
    histogram_chi_square,
    slow_mean,
)
from gaspart.analysis.statistics.fits import (
    KNOWN_FREEDOM,
    Combination,
    Fit,
    Optimum,
    PowerLaw,
    average,
    bootstrap,
    combine,
    combine_estimates,
    fit_curve,
    fit_linear,
    fit_polynomial,
    fit_power_law,
    histogram_means,
    jackknife,
    mean_of,
    means_of,
    optimum,
    steady_mean,
)

__all__ = [
    "KNOWN_FREEDOM",
    "Combination",
    "CorrelatedMean",
    "Fit",
    "Histogram",
    "Optimum",
    "PowerLaw",
    "autocorrelation_time",
    "average",
    "bootstrap",
    "combine",
    "combine_estimates",
    "common_freedom",
    "correlated_mean",
    "count_changes",
    "fit_curve",
    "fit_linear",
    "fit_polynomial",
    "fit_power_law",
    "histogram_chi_square",
    "histogram_means",
    "jackknife",
    "mean_of",
    "means_of",
    "optimum",
    "slow_mean",
    "steady_mean",
]
