"""The minimum of a measured cost, with its interval."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import stdtrit

from gaspart.analysis.statistics.fits import fit_linear
from gaspart.analysis.statistics.inputs import series_of

FLAT = 0.05
"""Part of the least cost by which that of a flat minimum may be exceeded."""


@dataclass(frozen=True)
class Optimum:
    """Place of a minimum with its 95 % interval, the cost there, whether it lies between the points; and from
    where to where the cost exceeds the least by less than FLAT."""

    location: float
    low: float
    high: float
    cost: float
    interior: bool
    flat_low: float
    flat_high: float


def optimum(x: ArrayLike, cost: ArrayLike, within: float = 3.0) -> Optimum:
    """Where the cost a + b / x + c x is least, which falls steeply and rises slowly: at sqrt(b / c).

    The three parts are fitted to the points near the minimum: those whose cost is below `within` times the
    least one (at least four, the cheapest first). The interval is that of the logarithm, by propagation, from
    the relative scatter about the curve. `interior`: b and c are positive and the
    minimum lies between the points. If it does not, the location is the cheapest point's, the intervals are
    from 0 to inf: no minimum was measured.
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
    gradient = np.array([0.0, 0.5 / falling, -0.5 / rising])  # of ln location
    quantile = stdtrit(fit.degrees_of_freedom, 0.975)
    spread = math.exp(quantile * math.sqrt(gradient @ covariance @ gradient))
    middle = math.sqrt(falling * rising)
    most = FLAT * (constant + 2.0 * middle) + 2.0 * middle  # of b / x + c x
    root = math.sqrt(most**2 - 4.0 * middle**2)
    flat = (most - root) / (2.0 * rising), (most + root) / (2.0 * rising)
    return Optimum(best, best / spread, best * spread, constant + 2.0 * middle, True, *flat)
