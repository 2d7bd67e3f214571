"""Least squares with covariance: polynomials, power laws and other curves."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics.blocks import positive_errors, positive_freedoms, series_of


@dataclass(frozen=True)
class Fit:
    """Parameters of a linear least-squares fit. `freedoms` are the degrees of freedom of the errors of the
    parameters. For a correct model, `chi_square` divided by `degrees_of_freedom` follows Fisher's F
    distribution with `degrees_of_freedom` and `error_freedom`. If the caller passes no errors, the fit cannot
    be tested, and `p_value` is NaN.
    """

    values: np.ndarray
    covariance: np.ndarray
    freedoms: np.ndarray
    chi_square: float
    degrees_of_freedom: int
    error_freedom: float
    p_value: float
    residuals: np.ndarray

    @property
    def errors(self) -> np.ndarray:
        """Standard errors of the parameters."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def estimates(self) -> Estimate:
        """Parameters (parameters,) with their uncertainties."""
        return Estimate(self.values, self.errors, self.freedoms)

    def estimate(self, number: int) -> Estimate:
        """Return a parameter with its uncertainty, by its index."""
        return self.estimates[number]


@dataclass(frozen=True)
class PowerLaw:
    """Power law y = amplitude x^exponent. `exponent_freedom` is the number of degrees of freedom of the
    exponent's error.
    """

    exponent: float
    exponent_error: float
    exponent_freedom: float
    amplitude: float
    amplitude_error: float
    chi_square: float
    degrees_of_freedom: int
    p_value: float

    @property
    def estimate(self) -> Estimate:
        """Exponent with its uncertainty."""
        return Estimate(self.exponent, self.exponent_error, self.exponent_freedom)


Values = ArrayLike | Estimate
"""Values without errors, or an Estimate of an array, which includes errors and degrees of freedom."""


def fit_linear(
    design: ArrayLike, y: Values, errors: ArrayLike | None = None, freedoms: ArrayLike = math.inf
) -> Fit:
    """Fit y = design @ values by least squares with weights 1 / errors^2. The design has the shape (points,
    parameters). If errors are passed, the covariance of the parameters follows from them, and chi-square
    tests the model. Without errors, all points have equal weight, and the covariance follows from the scatter
    of the residuals. The model is then not tested. `freedoms` are the degrees of freedom of the errors: one
    number for all points, or one for each point. They are needed if the errors come from the scatter of a few
    samples; see `_of_estimated_errors`. If y is an Estimate, it provides the errors and their degrees of
    freedom. Raises ValueError if there are fewer points than parameters (or equally many, without errors), or
    if the columns are dependent.
    """
    y, errors, freedoms = _with_errors(y, errors, freedoms)
    y = series_of("y", y, 1)
    design = np.asarray(design, dtype=float)
    if design.ndim != 2 or design.shape[0] != y.size or not np.all(np.isfinite(design)):
        raise ValueError(f"design: shape {design.shape} (must be ({y.size}, parameters) and finite)")
    freedom = y.size - design.shape[1]
    if freedom < (1 if errors is None else 0):
        raise ValueError(f"y: {y.size} points are too few for {design.shape[1]} parameters")
    scale = np.ones(y.size) if errors is None else positive_errors(errors, y.size)
    weighted = design / scale[:, None]
    # Columns are scaled to equal length, because powers of a small x differ by many decades.
    lengths = np.linalg.norm(weighted, axis=0)
    if np.any(lengths == 0.0) or np.linalg.matrix_rank(weighted / lengths) < design.shape[1]:
        raise ValueError("design: its columns are not independent")
    basis, singular, right = np.linalg.svd(weighted / lengths, full_matrices=False)
    inverse = (right.T / singular) / lengths[:, None]
    values = inverse @ (basis.T @ (y / scale))
    covariance = inverse @ inverse.T
    residuals = y - design @ values
    chi_square = float(np.sum((residuals / scale) ** 2))
    if errors is None:
        covariance, own = covariance * chi_square / freedom, np.full(values.size, float(freedom))
        return Fit(values, covariance, own, math.nan, freedom, math.inf, math.nan, residuals)
    few = 1.0 / positive_freedoms(freedoms, y.size)
    covariance, own, factor, error_freedom = _of_estimated_errors(inverse @ basis.T, basis, covariance, few)
    chi_square /= factor
    p_value = math.nan
    if freedom:
        from scipy.special import chdtrc, fdtrc

        each = chi_square / freedom
        p_value = float(fdtrc(freedom, error_freedom, each) if few.any() else chdtrc(freedom, chi_square))
    return Fit(values, covariance, own, chi_square, freedom, error_freedom, p_value, residuals)


def _with_errors(y: Values, errors: ArrayLike | None, freedoms: ArrayLike) -> tuple:
    """Return values, their errors, and the degrees of freedom of the errors."""
    return (y.value, y.error, y.freedom) if isinstance(y, Estimate) else (y, errors, freedoms)


def _of_estimated_errors(
    shares: np.ndarray, basis: np.ndarray, covariance: np.ndarray, few: np.ndarray
) -> tuple[np.ndarray, np.ndarray, float, float]:
    """Return the covariance of a fit to points with estimated errors, and parameters of its test. The results
    are the covariance, the degrees of freedom of the parameters, the factor by which chi-square is too large,
    and the second degrees of freedom of the test.

    - shares : (parameters, points), contribution of the error of each point to each parameter.
    - basis : (points, parameters), orthonormal columns that span the columns of the weighted design.
    - few : (points,), reciprocal degrees of freedom of the errors.

    A point with an underestimated error has too much weight, and also makes the covariance too small. To
    first order in `few`, each of these two effects changes the contribution of the point by the fraction 2
    few (1 - leverage) (for the weighted mean: Meier, Biometrics 9, 59 (1953)). With f - 2 instead of f
    degrees of freedom, as in the mean of 1 / chi-square, the errors are accurate to a few per cent for f >=
    3; for smaller f, f / 3 is used. The degrees of freedom follow Welch and Satterthwaite. The test follows
    Welch, Biometrika 38, 330 (1951); for linear models Johansen, Biometrika 67, 85 (1980).
    """
    free = 1.0 - np.clip((basis**2).sum(axis=1), 0.0, 1.0)
    with np.errstate(divide="ignore"):
        freedoms = 1.0 / ((shares**2 / np.diag(covariance)[:, None]) ** 2 @ few)
        weight = 1.0 / np.maximum(1.0 / few - 2.0, 1.0 / (3.0 * few))
    corrected = covariance + (4.0 * weight * free * shares) @ shares.T
    number, spread = len(few) - len(covariance), float(free**2 @ few)
    if not number or spread == 0.0:
        return corrected, freedoms, 1.0, math.inf
    factor = 1.0 + (2.0 - 6.0 / (number + 2.0)) * spread / number
    return corrected, freedoms, factor, number * (number + 2.0) / (3.0 * spread)


def fit_polynomial(
    x: ArrayLike,
    y: Values,
    errors: ArrayLike | None = None,
    powers: Sequence[int] = (0, 1),
    fixed: Mapping[int, float] | None = None,
    freedoms: ArrayLike = math.inf,
) -> Fit:
    """Fit y = sum of values[i] x^powers[i] plus the fixed terms {power: coefficient}; see `fit_linear`. The
    result does not include the uncertainty of the fixed coefficients. To estimate it, repeat the fit with
    shifted coefficients.
    """
    x = series_of("x", x, 1)
    y, errors, freedoms = _with_errors(y, errors, freedoms)
    y = series_of("y", y, 1)
    if x.size != y.size:
        raise ValueError(f"x, y: {x.size} and {y.size} values (must be as many)")
    held = sum(coefficient * x**power for power, coefficient in (fixed or {}).items())
    return fit_linear(np.stack([x**power for power in powers], axis=1), y - held, errors, freedoms)


def fit_power_law(
    x: ArrayLike, y: Values, errors: ArrayLike | None = None, freedoms: ArrayLike = math.inf
) -> PowerLaw:
    """Fit y = amplitude x^exponent as a line of ln y against ln x; see `fit_linear`. x and y must be
    positive; `errors` are errors of y. The logarithm has the errors errors / y, which is accurate if they are
    below about 20 %.
    """
    x = series_of("x", x, 2)
    y, errors, freedoms = _with_errors(y, errors, freedoms)
    y = series_of("y", y, 2)
    if x.size != y.size or np.any(x <= 0.0) or np.any(y <= 0.0):
        raise ValueError("x, y: must be as many, and positive")
    relative = None if errors is None else positive_errors(errors, y.size) / y
    # Relative to the mean of ln x the two parameters are nearly independent; the amplitude is then
    # extrapolated to x = 1.
    middle = np.log(x).mean()
    fit = fit_polynomial(np.log(x) - middle, np.log(y), relative, freedoms=freedoms)
    exponent = float(fit.values[1])
    to_one = np.array([1.0, -middle])
    amplitude = math.exp(fit.values @ to_one)
    return PowerLaw(
        exponent=exponent,
        exponent_error=float(fit.errors[1]),
        exponent_freedom=float(fit.freedoms[1]),
        amplitude=amplitude,
        amplitude_error=amplitude * math.sqrt(to_one @ fit.covariance @ to_one),
        chi_square=fit.chi_square,
        degrees_of_freedom=fit.degrees_of_freedom,
        p_value=fit.p_value,
    )


def fit_curve(
    function: Callable[..., np.ndarray],
    x: ArrayLike,
    y: Estimate,
    start: Sequence[float],
    bounds: tuple[Sequence[float], Sequence[float]] | tuple[float, float] = (-math.inf, math.inf),
) -> tuple[np.ndarray, np.ndarray]:
    """Fit the parameters of function(x, *parameters) to values with known errors. Returns the parameters and
    their covariance. Raises ValueError if an error is not positive and finite, because scipy would then
    return the starting values. Raises RuntimeError if the fit does not converge.
    """
    from scipy.optimize import curve_fit

    errors = positive_errors(y.error, np.size(y.value))
    solution = curve_fit(
        function, x, y.value, start, sigma=errors, absolute_sigma=True, bounds=bounds, check_finite=True
    )
    return solution[0], solution[1]


# Means of independent numbers, and functions of means by resampling.


@dataclass(frozen=True)
class Combination:
    """Weighted mean of independent values, and a test of their scatter; see `Fit`. Chi-square tests if the
    scatter of the values agrees with their errors.
    """

    value: float
    error: float
    freedom: float
    chi_square: float
    degrees_of_freedom: int
    error_freedom: float
    p_value: float

    @property
    def estimate(self) -> Estimate:
        """Mean with its uncertainty."""
        return Estimate(self.value, self.error, self.freedom)


def mean_of(values: ArrayLike) -> Estimate:
    """Compute the mean of N independent numbers, at least two, and its standard error. The error follows from
    the scatter between the numbers and has N - 1 degrees of freedom.
    """
    values = series_of("values", values, 2)
    error = float(values.std(ddof=1) / math.sqrt(values.size))
    return Estimate(float(values.mean()), error, values.size - 1)


def average(estimates: Estimate | Sequence[Estimate]) -> Estimate:
    """Average independent estimates with equal weights, and propagate their uncertainties. The elements of an
    array of estimates are averaged along its first axis.
    """
    return sum(estimates, Estimate(0.0)) / len(estimates)


KNOWN_FREEDOM = 2.0
"""Minimum number of degrees of freedom for which the error of a bin counts as known. With fewer, the run is
too short compared with the correlation time, or the bin was occupied in too few blocks.
"""


def means_of(samples: ArrayLike, sizes: ArrayLike | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Compute the means of N independent samples (N, ...) over axis 0, and their standard errors. The errors
    follow from the scatter between the samples. If each sample is itself a mean over several items, `sizes`
    (N,) are the numbers of items. The result is then the mean over all items with equal weights. The variance
    of a sample is assumed to be inversely proportional to its size.
    """
    values = np.asarray(samples)
    if sizes is None or np.ptp(sizes) == 0.0:
        return values.mean(axis=0), values.std(axis=0, ddof=1) / math.sqrt(len(values))
    weights = np.asarray(sizes, dtype=float)
    mean = np.average(values, axis=0, weights=weights)
    variance = np.average((values - mean) ** 2, axis=0, weights=weights) / (len(values) - 1.0)
    return mean, np.sqrt(variance)


def histogram_means(
    samples: ArrayLike, sizes: ArrayLike | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Compute means of N histograms (N, bins), their errors, and the degrees of freedom of the errors. A bin
    that is filled in n histograms has at most n - 1 degrees of freedom: few counts scatter by chance as
    little as many. An error with fewer than `KNOWN_FREEDOM` is NaN, and so is the error of a bin without
    scatter, unless no filled bin has any: nothing moves, and the errors of filled bins are 0.
    """
    filled = (np.asarray(samples) != 0.0).sum(axis=0)
    means, errors = means_of(samples, sizes)
    if filled.any() and not errors.any():
        return means, errors, np.full(means.shape, len(np.asarray(samples)) - 1.0)
    known = (errors > 0.0) & (filled > KNOWN_FREEDOM)
    return means, np.where(known, errors, np.nan), np.where(known, filled - 1.0, np.nan)


def steady_mean(series: ArrayLike, *changes: ArrayLike) -> Estimate:
    """Compute the steady current through a system that stores energy, from block means. The series contains
    the mean currents in K blocks. Each array (K,) in `changes` is the change of a bounded quantity, such as
    the stored energy, during each block. Energy that is stored in one block is returned in another. So the
    means of the blocks are anticorrelated, and their scatter overestimates the error of the long-time mean.
    Therefore the currents are regressed on the changes by least squares. The result is the fitted current in
    a block without a change of these quantities. It differs from the mean over all blocks by a bounded amount
    divided by the length of the run. The number of degrees of freedom is K - 1 - len(changes). Raises
    ValueError under the conditions of `fit_linear`.
    """
    series = series_of("series", series, 2)
    design = [np.ones(series.size)]
    for change in changes:
        change = series_of("change", change, 2)
        if np.ptp(change) > 0.0:  # a constant quantity stores nothing
            design.append(change / np.abs(change).max())
    fit = fit_linear(np.stack(design, axis=1), series)
    return Estimate(fit.values[0], fit.errors[0], fit.degrees_of_freedom)


def combine(values: Values, errors: ArrayLike | None = None, freedoms: ArrayLike = math.inf) -> Combination:
    """Compute the mean weighted by 1 / error^2, and chi-square about the mean; see `fit_linear`."""
    number = len(values) if isinstance(values, Estimate) else np.size(values)
    fit = fit_linear(np.ones((number, 1)), values, errors, freedoms)
    mean = fit.estimate(0)
    return Combination(
        value=mean.value,
        error=mean.error,
        freedom=mean.freedom,
        chi_square=fit.chi_square,
        degrees_of_freedom=fit.degrees_of_freedom,
        error_freedom=fit.error_freedom,
        p_value=fit.p_value,
    )


def combine_estimates(estimates: Estimate | Sequence[Estimate]) -> Estimate:
    """Average independent estimates with weights 1 / error^2; NaN for an empty list. The estimates may be the
    elements of a single array estimate.
    """
    stacked = estimates if isinstance(estimates, Estimate) else Estimate.stack(estimates)
    return combine(stacked).estimate if stacked else Estimate(math.nan, math.nan)


def bootstrap(function: Callable[..., float], samples: ArrayLike, repeats: int = 1000) -> Estimate:
    """Compute function(samples), and its standard error by the bootstrap. The samples are resampled with
    replacement along axis 0. The random numbers are always the same, so identical samples give identical
    errors. `function` must return a single number. The scatter between resampled means of n samples is
    smaller than the standard error by the factor sqrt(1 - 1/n), so the scatter is divided by this factor. The
    error has n - 1 degrees of freedom (Efron and Tibshirani, An introduction to the bootstrap (1993), section
    5.3).
    """
    samples = np.asarray(samples)
    if samples.shape[0] < 2:
        raise ValueError(f"samples: {samples.shape[0]} (must be at least 2)")
    generator = np.random.default_rng(0)
    draws = generator.integers(0, samples.shape[0], size=(repeats, samples.shape[0]))
    scatter = np.std([function(samples[draw]) for draw in draws], ddof=1)
    number = samples.shape[0]
    return Estimate(float(function(samples)), float(scatter) * math.sqrt(number / (number - 1.0)), number - 1)


def jackknife(function: Callable[..., Any], *samples: ArrayLike) -> tuple[Any, Any]:
    """Compute function(means of the samples), and its standard error by the jackknife. Each block is omitted
    once. The samples are arrays whose axis 0 runs over the same n independent blocks (at least two).
    `function` receives the means of the arrays over the blocks and returns a number or an array. For smooth
    functions the error is correct to first order and includes correlations between the samples (Tukey 1958).
    Returns (value, error) as arrays.
    """
    series = [np.asarray(sample, dtype=float) for sample in samples]
    blocks = series[0].shape[0]
    if blocks < 2 or any(sample.shape[0] != blocks for sample in series):
        raise ValueError(f"samples: {[len(sample) for sample in series]} blocks (as many, and at least 2)")
    sums = [sample.sum(axis=0) for sample in series]
    partial = np.array(
        [
            function(
                *((total - sample[k]) / (blocks - 1) for total, sample in zip(sums, series, strict=True))
            )
            for k in range(blocks)
        ]
    )
    error = np.sqrt((blocks - 1) / blocks * ((partial - partial.mean(axis=0)) ** 2).sum(axis=0))
    return np.asarray(function(*(total / blocks for total in sums)), dtype=float), error


# Minimum of a measured cost, with its interval.


FLAT = 0.05
"""Maximum relative excess of the cost over its minimum that still counts as part of a flat minimum."""


@dataclass(frozen=True)
class Optimum:
    """Minimum of a cost: its position, the 95 % interval of the position, and its cost. Two further
    properties state if the minimum lies between the points, and the interval in which the relative excess of
    the cost over its minimum is less than FLAT.
    """

    location: float
    low: float
    high: float
    cost: float
    interior: bool
    flat_low: float
    flat_high: float


def optimum(x: ArrayLike, cost: ArrayLike, within: float = 3.0) -> Optimum:
    """Find the minimum sqrt(b / c) of a cost a + b/x + c x. As a function of x, such a cost falls steeply and
    rises slowly. The three terms are fitted to the points near the minimum: to all points with a cost below
    `within` times the smallest cost, but at least to the four cheapest points. The interval of the position
    is computed for its logarithm, by error propagation from the relative scatter of the points about the
    curve. `interior` is True if b and c are positive and the minimum lies between the points. Otherwise the
    points determine no minimum: the position is the x of the cheapest point, and the intervals extend from 0
    to inf.
    """
    x = series_of("x", x, 4)
    cost = series_of("cost", cost, 4)
    if x.size != cost.size or np.any(x <= 0.0) or np.any(cost <= 0.0):
        raise ValueError("x, cost: must be as many, and positive")
    cheapest = np.argsort(cost, kind="stable")
    near = np.sort(cheapest[: max(4, np.count_nonzero(cost < within * cost.min()))])
    at, seen = x[near], cost[near]
    if np.unique(at).size < 3:
        raise ValueError("x: needs at least three different values near the minimum")
    design = np.stack([np.ones(at.size), 1.0 / at, at], axis=1) / seen[:, None]
    fit = fit_linear(design, np.ones(at.size))
    (constant, falling, rising), covariance = fit.values, fit.covariance
    best = math.sqrt(falling / rising) if min(falling, rising) > 0.0 else math.nan
    if not at.min() < best < at.max():
        least = cheapest[0]
        return Optimum(float(x[least]), 0.0, math.inf, float(cost[least]), False, 0.0, math.inf)
    gradient = np.array([0.0, 0.5 / falling, -0.5 / rising])  # of ln position
    from scipy.special import stdtrit

    quantile = stdtrit(fit.degrees_of_freedom, 0.975)
    spread = math.exp(quantile * math.sqrt(gradient @ covariance @ gradient))
    middle = math.sqrt(falling * rising)
    most = FLAT * (constant + 2.0 * middle) + 2.0 * middle  # of b / x + c x
    root = math.sqrt(most**2 - 4.0 * middle**2)
    flat = (most - root) / (2.0 * rising), (most + root) / (2.0 * rising)
    return Optimum(best, best / spread, best * spread, constant + 2.0 * middle, True, *flat)
