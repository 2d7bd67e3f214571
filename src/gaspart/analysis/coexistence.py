"""The pressure at which two phases coexist, from a loop of P against volume: Maxwell's equal areas."""

from __future__ import annotations

import math

import numpy as np

REPEATS = 100
"""Number of redrawn loops, whose scatter gives the error."""
_FINE = 2000


def plateau(
    volume: np.ndarray, pressure: np.ndarray, error: np.ndarray
) -> tuple[float, float, tuple[float, float]]:
    """Pressure of the horizontal line that cuts off equal areas of the loop, its error, and the volumes at
    its ends.

    volume (per particle, any order), pressure and its standard errors: (P,). A finite system in the
    coexistence region has a loop (Mayer and Wood, J. Chem. Phys. 42, 4268 (1965)) because its interface costs
    free energy; the area between the ends is the difference in free energy, so the line is where both phases
    have the same chemical potential. The loop is interpolated monotonically between points (Fritsch and
    Carlson). The error is half of the width of the middle 68 % of loops redrawn from the points' errors.
    Without a loop, or if less than half of those redrawn have one: NaN, NaN, (NaN, NaN).
    """
    order = np.argsort(volume)
    volume, pressure, error = (np.asarray(values, dtype=float)[order] for values in (volume, pressure, error))
    value, ends = _equal_areas(volume, pressure)
    noise = error * np.random.default_rng(0).standard_normal((REPEATS, error.size))
    redrawn = np.array([_equal_areas(volume, pressure + shift)[0] for shift in noise])
    found = redrawn[np.isfinite(redrawn)]
    if math.isnan(value) or found.size < REPEATS / 2:
        return math.nan, math.nan, (math.nan, math.nan)
    return value, float(0.5 * np.diff(np.percentile(found, [15.87, 84.13]))[0]), ends


def _equal_areas(volume: np.ndarray, pressure: np.ndarray) -> tuple[float, tuple[float, float]]:
    """The line's height and its ends, largest volume first."""
    from scipy.interpolate import PchipInterpolator
    from scipy.optimize import brentq

    v = np.linspace(volume[0], volume[-1], _FINE)
    p = PchipInterpolator(volume, pressure)(v)
    rising = np.flatnonzero(np.diff(p) > 0.0)
    nothing = math.nan, (math.nan, math.nan)
    if rising.size == 0:
        return nothing
    low, high = p[rising[0] : rising[-1] + 2].min(), p[rising[0] : rising[-1] + 2].max()
    low, high = max(low, p[-1]), min(high, p[0])
    if not low < high:
        return nothing

    def ends(level: float) -> tuple[int, int]:
        inside = np.flatnonzero((p[:-1] - level) * (p[1:] - level) <= 0.0)
        return inside[0], inside[-1] + 1

    def excess(level: float) -> float:
        first, last = ends(level)
        return float(np.trapezoid(p[first : last + 1] - level, v[first : last + 1]))

    margin = 1e-9 * (high - low)
    if excess(low + margin) * excess(high - margin) > 0.0:
        return nothing
    level = brentq(excess, low + margin, high - margin, xtol=1e-6)
    first, last = ends(level)
    return float(level), (float(v[last]), float(v[first]))
