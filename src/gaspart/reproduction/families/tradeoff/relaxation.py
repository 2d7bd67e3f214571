"""The time in which speeds that are equal at first become Maxwell's, by theory."""

from __future__ import annotations

import numpy as np

from gaspart import theory

FREE_TIMES = 2.5
"""Mean free times over which the relaxation of speeds is integrated."""


def relaxation_time(slower: float) -> float:
    """Compute the relaxation time of a gas with collisions rarer by a factor.

    Its speeds follow the homogeneous Boltzmann equation.
    """
    times = np.linspace(0.0, FREE_TIMES / slower, 251)
    curve = theory.relaxation(3)
    end = theory.kurtosis(3)
    remainder = (end - curve.kurtosis(curve.collisions(times))) / (end - 1.0)
    return float(np.trapezoid(remainder, times) * slower)
