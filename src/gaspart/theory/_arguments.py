"""Checks of the arguments of all formulas of this package."""

import inspect
import math
from collections.abc import Callable
from functools import wraps
from typing import Any, ParamSpec, TypeAlias, TypeVar

import numpy as np

from gaspart.errors import SceneError

Numbers: TypeAlias = float | np.ndarray
"""A number, or an array of them."""
Values: TypeAlias = Any
"""Result of a function of `Numbers`: a number from numbers, an array of their shape from arrays."""

P = ParamSpec("P")
R = TypeVar("R")

_SMALLEST, _LARGEST = 1e-30, 1e30
_POSITIVE = (_SMALLEST, _LARGEST, f"must be from {_SMALLEST:g} to {_LARGEST:g}: choose other units")
_NOT_NEGATIVE = (0.0, math.inf, "must be finite and not negative")
_FINITE = (-math.inf, math.inf, "must be finite")
_RANGES = {
    **dict.fromkeys(("diameter", "contact_distance", "length", "height", "outside", "width"), _POSITIVE),
    **dict.fromkeys(("side", "spacing", "tolerance", "mass", "gas_mass"), _POSITIVE),
    **dict.fromkeys(("temperature", "hot", "cold", "viscosity", "rate", "collision_rate"), _POSITIVE),
    **dict.fromkeys(("number_density", "density", "bulk_density", "activity"), _NOT_NEGATIVE),
    **dict.fromkeys(("time", "diffusion", "collisions", "radius", "size_ratio", "jump"), _NOT_NEGATIVE),
    **dict.fromkeys(("distance", "wave_number"), _NOT_NEGATIVE),
    **dict.fromkeys(("speed", "depth", "weight", "force", "ratio", "x", "z"), _FINITE),
    "accommodation": (1e-6, 1.0, "must be above 0 and at most 1"),
    "side_over_diameter": (1.0, math.inf, "must be finite and at least 1"),
    "count": (1.0, math.inf, "must be finite and at least 1"),
}
"""Smallest and largest value of arguments, by name, and the rule in words."""


def checked(function: Callable[P, R]) -> Callable[P, R]:
    """Return a function that raises SceneError for an argument out of the range of its name.

    Parameters
    ----------
    function : callable
        Formula, whose arguments have names of `_RANGES` or are not checked.

    Returns
    -------
    callable
        The formula with checks. SceneError is a ValueError.
    """
    names = tuple(inspect.signature(function).parameters)

    @wraps(function)
    def checking(*args: P.args, **kwargs: P.kwargs) -> R:
        for name, value in (*zip(names, args, strict=False), *kwargs.items()):
            if name in _RANGES and value is not None:
                checked_range(name, value, *_RANGES[name])
        return function(*args, **kwargs)

    return checking


def checked_range(name: str, value: Any, least: float, most: float, rule: str) -> np.ndarray:
    """Return `value` as a float64 array, if it is finite and within the range.

    Parameters
    ----------
    name : str
        Name of the argument.
    value : array_like
        Number or numbers.
    least, most : float
        Ends of the range, which belong to it.
    rule : str
        Rule in words, for the message.

    Returns
    -------
    ndarray, same shape as `value`
        Numbers.

    Raises
    ------
    SceneError
        If a number is not finite or out of range.
    """
    values = np.asarray(value, dtype=float)
    wrong = ~((values >= least) & (values <= most) & np.isfinite(values))
    if wrong.any():
        raise SceneError(name, float(values[wrong][0]), rule)
    return values


def checked_dimension(dimension: int) -> int:
    """Return `dimension`, if it is 2 or 3.

    Parameters
    ----------
    dimension : int
        Number of dimensions.

    Returns
    -------
    int
        The same number.

    Raises
    ------
    SceneError
        If it is another number.
    """
    if dimension not in (2, 3):
        raise SceneError("dimension", dimension, "must be 2 or 3")
    return dimension


def checked_packing_fraction(packing_fraction: Numbers, largest: float) -> np.ndarray:
    """Return `packing_fraction` as a float64 array, if it is in the range of a formula.

    Parameters
    ----------
    packing_fraction : array_like, [1]
        Packing fraction.
    largest : float, [1]
        Upper end of the range, which begins at 0.

    Returns
    -------
    ndarray, same shape as `packing_fraction`, [1]
        Packing fraction.

    Raises
    ------
    SceneError
        If a number is out of range or NaN.
    """
    rule = f"this formula holds from 0 to {largest:g}"
    return checked_range("packing_fraction", packing_fraction, 0.0, largest, rule)
