"""The minimum of a measured cost, with its interval."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from gaspart.analysis.statistics.fits import fit_polynomial
from gaspart.analysis.statistics.inputs import positive_errors, series_of


@dataclass(frozen=True)
class Optimum:
    """Place of a minimum with its 95 % interval, the cost there, and whether it lies between the points."""

    location: float
    low: float
    high: float
    cost: float
    interior: bool


def optimum(x: ArrayLike, cost: ArrayLike, errors: ArrayLike | None = None, within: float = 3.0) -> Optimum:
    """Where a cost is least: a parabola of ln cost against ln x, through the points near the minimum.

    Taken are the points whose cost is below `within` times the least one (at least four, the cheapest
    first). The 95 % interval is Fieller's: all u for which the parabola's slope at u is compatible with 0,
    which stays right when the curvature is uncertain (the interval may then be infinite: low = 0, high =
    inf). errors: of the cost; without, the scatter about the parabola. `interior`: the parabola opens upwards
    and its minimum lies between the points. If it does not, the location is the cheapest point's, and low and
    high are 0 and inf: no minimum was measured.
    """
    x = series_of("x", x, 4)
    cost = series_of("cost", cost, 4)
    if x.size != cost.size or np.any(x <= 0.0) or np.any(cost <= 0.0):
        raise ValueError("x, cost: must be as many, and positive")
    cheapest = np.argsort(cost, kind="stable")
    near = np.sort(cheapest[: max(4, np.count_nonzero(cost < within * cost.min()))])
    if np.unique(x[near]).size < 3:
        raise ValueError("x: needs at least three different values near the minimum")
    middle = np.log(x[near]).mean()
    u = np.log(x[near]) - middle
    relative = None if errors is None else positive_errors(errors, cost.size)[near] / cost[near]
    fit = fit_polynomial(u, np.log(cost[near]), relative, powers=(0, 1, 2))
    level, slope, curvature = fit.values
    freedom = fit.degrees_of_freedom
    quantile = stats.t.ppf(0.975, freedom) if errors is None else stats.norm.ppf(0.975)
    vertex = -0.5 * slope / curvature if curvature > 0.0 else math.nan
    if not u.min() < vertex < u.max():
        best = cheapest[0]
        return Optimum(float(x[best]), 0.0, math.inf, float(cost[best]), False)
    low, high = _fieller(slope, curvature, fit.covariance[1:, 1:], quantile)
    least = math.exp(level + 0.5 * slope * vertex)
    return Optimum(math.exp(vertex + middle), math.exp(low + middle), math.exp(high + middle), least, True)


def _fieller(slope: float, curvature: float, covariance: np.ndarray, quantile: float) -> tuple[float, float]:
    """Interval of u where slope + 2 curvature u differs from 0 by at most `quantile` standard errors."""
    # (slope + 2 c u)^2 <= q^2 (V_ss + 4 V_sc u + 4 V_cc u^2): a quadratic in u.
    square = quantile**2
    a = 4.0 * (curvature**2 - square * covariance[1, 1])
    b = 4.0 * (slope * curvature - square * covariance[0, 1])
    c = slope**2 - square * covariance[0, 0]
    discriminant = b**2 - 4.0 * a * c
    if a <= 0.0 or discriminant < 0.0:
        return -math.inf, math.inf
    root = math.sqrt(discriminant)
    return (-b - root) / (2.0 * a), (-b + root) / (2.0 * a)
