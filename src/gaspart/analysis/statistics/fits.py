"""Linear least squares with covariance: polynomials and power laws."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import chdtrc

from gaspart.analysis.statistics.inputs import positive_errors, series_of


@dataclass(frozen=True)
class Fit:
    """Parameters of a linear least-squares fit. Without errors given there is no test: p_value is NaN."""

    values: np.ndarray
    covariance: np.ndarray
    chi_square: float
    degrees_of_freedom: int
    p_value: float
    residuals: np.ndarray

    @property
    def errors(self) -> np.ndarray:
        """Standard errors of the parameters."""
        return np.sqrt(np.diag(self.covariance))


@dataclass(frozen=True)
class PowerLaw:
    """y = amplitude x^exponent."""

    exponent: float
    exponent_error: float
    amplitude: float
    amplitude_error: float
    chi_square: float
    degrees_of_freedom: int
    p_value: float


def fit_linear(design: ArrayLike, y: ArrayLike, errors: ArrayLike | None = None) -> Fit:
    """Least-squares fit of y = design @ values (design: (points, parameters)), weighted by 1 / errors^2.

    With errors: covariance from them, and a chi-square test of the model. Without: all points count alike,
    and the covariance is scaled by the residuals' scatter (so there is no test). Raises ValueError if there
    are fewer points than parameters (or as many, without errors), or the columns are dependent.
    """
    y = series_of("y", y, 1)
    design = np.asarray(design, dtype=float)
    if design.ndim != 2 or design.shape[0] != y.size or not np.all(np.isfinite(design)):
        raise ValueError(f"design: shape {design.shape} (must be ({y.size}, parameters) and finite)")
    freedom = y.size - design.shape[1]
    if freedom < (1 if errors is None else 0):
        raise ValueError(f"y: {y.size} points are too few for {design.shape[1]} parameters")
    scale = np.ones(y.size) if errors is None else positive_errors(errors, y.size)
    weighted = design / scale[:, None]
    # Columns are brought to one length: powers of a small x differ by many decades.
    lengths = np.linalg.norm(weighted, axis=0)
    if np.any(lengths == 0.0) or np.linalg.matrix_rank(weighted / lengths) < design.shape[1]:
        raise ValueError("design: its columns are not independent")
    left, singular, right = np.linalg.svd(weighted / lengths, full_matrices=False)
    inverse = (right.T / singular) / lengths[:, None]
    values = inverse @ (left.T @ (y / scale))
    covariance = inverse @ inverse.T
    residuals = y - design @ values
    chi_square = float(np.sum((residuals / scale) ** 2))
    if errors is None:
        return Fit(values, covariance * chi_square / freedom, math.nan, freedom, math.nan, residuals)
    p_value = float(chdtrc(freedom, chi_square)) if freedom else math.nan
    return Fit(values, covariance, chi_square, freedom, p_value, residuals)


def fit_polynomial(
    x: ArrayLike,
    y: ArrayLike,
    errors: ArrayLike | None = None,
    powers: Sequence[int] = (0, 1),
    fixed: Mapping[int, float] | None = None,
) -> Fit:
    """Fit y = sum of values[i] x^powers[i] plus the terms held fixed, {power: coefficient}; see `fit_linear`.

    The result does not include the uncertainty of the fixed coefficients: repeat the fit with them shifted to
    see it.
    """
    x = series_of("x", x, 1)
    y = series_of("y", y, 1)
    if x.size != y.size:
        raise ValueError(f"x, y: {x.size} and {y.size} values (must be as many)")
    held = sum(coefficient * x**power for power, coefficient in (fixed or {}).items())
    return fit_linear(np.stack([x**power for power in powers], axis=1), y - held, errors)


def fit_power_law(x: ArrayLike, y: ArrayLike, errors: ArrayLike | None = None) -> PowerLaw:
    """Fit y = amplitude x^exponent as a line of ln y against ln x (x, y > 0; errors: of y); see `fit_linear`.

    The errors become errors / y of the logarithm, good while they are below some 20 %.
    """
    x = series_of("x", x, 2)
    y = series_of("y", y, 2)
    if x.size != y.size or np.any(x <= 0.0) or np.any(y <= 0.0):
        raise ValueError("x, y: must be as many, and positive")
    relative = None if errors is None else positive_errors(errors, y.size) / y
    # About the middle of ln x the two parameters are nearly independent; the amplitude is carried back to x =
    # 1.
    middle = np.log(x).mean()
    fit = fit_polynomial(np.log(x) - middle, np.log(y), relative)
    exponent = float(fit.values[1])
    to_one = np.array([1.0, -middle])
    amplitude = math.exp(fit.values @ to_one)
    return PowerLaw(
        exponent=exponent,
        exponent_error=float(fit.errors[1]),
        amplitude=amplitude,
        amplitude_error=amplitude * math.sqrt(to_one @ fit.covariance @ to_one),
        chi_square=fit.chi_square,
        degrees_of_freedom=fit.degrees_of_freedom,
        p_value=fit.p_value,
    )
