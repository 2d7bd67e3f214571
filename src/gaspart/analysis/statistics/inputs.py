"""Checks of the arrays that statistics are made of."""

import numpy as np
from numpy.typing import ArrayLike


def series_of(name: str, values: ArrayLike, shortest: int) -> np.ndarray:
    """Return `values` as a float64 series; raise ValueError if it is too short or not finite."""
    values = np.asarray(values, dtype=float)
    if values.ndim != 1 or values.size < shortest:
        raise ValueError(f"{name}: shape {values.shape} (must be a series of at least {shortest} values)")
    if not np.all(np.isfinite(values)):
        raise ValueError(f"{name}: not all values are finite")
    return values


def positive_errors(errors: ArrayLike, size: int) -> np.ndarray:
    """Return `errors` broadcast to (size,); raise ValueError unless positive and finite."""
    errors = np.broadcast_to(np.asarray(errors, dtype=float), (size,))
    if not np.all((errors > 0.0) & np.isfinite(errors)):
        raise ValueError("errors: must be positive and finite")
    return errors


def positive_freedoms(freedoms: ArrayLike, size: int) -> np.ndarray:
    """Return degrees of freedom broadcast to (size,); raise ValueError unless positive. They may be
    infinite."""
    freedoms = np.broadcast_to(np.asarray(freedoms, dtype=float), (size,))
    if not np.all(freedoms > 0.0):
        raise ValueError("freedoms: must be positive")
    return freedoms
