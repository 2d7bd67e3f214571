"""Checks that every formula of this package makes of its arguments, in one place."""

from typing import Any, TypeAlias

import numpy as np

Numbers: TypeAlias = float | np.ndarray
"""A number, or an array of them."""
Values: TypeAlias = Any
"""What follows from `Numbers`: a number from numbers, an array of their shape from arrays."""


def checked_dimension(dimension: int) -> int:
    """Return `dimension` if it is 2 or 3; raise ValueError otherwise."""
    if dimension not in (2, 3):
        raise ValueError(f"dimension: {dimension} (must be 2 or 3)")
    return dimension


def checked_packing_fraction(packing_fraction: Numbers, largest: float) -> np.ndarray:
    """Return `packing_fraction` as a float64 array; raise ValueError outside [0, largest] (or NaN)."""
    eta = np.asarray(packing_fraction, dtype=float)
    if not np.all((eta >= 0.0) & (eta <= largest)):
        raise ValueError(f"packing_fraction: {packing_fraction} (this formula holds from 0 to {largest})")
    return eta
