"""What an accuracy leaves to noise beside a bias, and how much must be measured for that."""

from __future__ import annotations

import math

QUANTILE = 1.96
"""Half of a 95 % interval, in standard errors."""


def room(accuracy: float, bias: float) -> float:
    """The relative standard error that a bias leaves of an accuracy, half of a 95 % interval."""
    return (accuracy - bias) / QUANTILE


def half_width(bias: float, error: float) -> float:
    """The inverse: half of the 95 % interval, for a relative standard error beside a bias."""
    return bias + QUANTILE * error


def required(variance: float, accuracy: float, bias: float, least: float = 0.0) -> float:
    """How much is to be measured for an accuracy, `least` at least, in the unit of which a measurement has
    this relative variance; inf if the bias leaves no room for noise."""
    left = room(accuracy, bias)
    return max(variance / left**2, least) if left > 0.0 else math.inf
