"""Volume of a particle, number density and packing fraction of discs and spheres."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from functools import wraps
from typing import Any, ParamSpec, TypeAlias, TypeVar

import numpy as np

from gaspart.errors import SceneError
from gaspart.scene.sizes import ball_volume

# Validation of the arguments of all formulas in this package.


Numbers: TypeAlias = float | np.ndarray
"""A number, or an array of numbers."""
Values: TypeAlias = Any
"""Result of a function of `Numbers`: a number for numbers, an array of the same shape for arrays."""

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
"""For each argument name, the smallest and largest allowed values, and the rule in words."""


def check_ranges(function: Callable[P, R]) -> Callable[P, R]:
    """Decorate a formula so that it raises SceneError for an argument outside of its range."""
    names = tuple(inspect.signature(function).parameters)

    @wraps(function)
    def checking(*args: P.args, **kwargs: P.kwargs) -> R:
        for name, value in (*zip(names, args, strict=False), *kwargs.items()):
            if name in _RANGES and value is not None:
                checked_range(name, value, *_RANGES[name])
        return function(*args, **kwargs)

    return checking


def checked_range(name: str, value: Any, least: float, most: float, rule: str) -> np.ndarray:
    """Return `value` as a float64 array, if it is finite and within the range."""
    values = np.asarray(value, dtype=float)
    wrong = ~((values >= least) & (values <= most) & np.isfinite(values))
    if wrong.any():
        raise SceneError(name, float(values[wrong][0]), rule)
    return values


def checked_dimension(dimension: int) -> int:
    """Return `dimension`, if it is 2 or 3."""
    if dimension not in (2, 3):
        raise SceneError("dimension", dimension, "must be 2 or 3")
    return dimension


def checked_packing_fraction(packing_fraction: Numbers, largest: float) -> np.ndarray:
    """Return `packing_fraction` as a float64 array, if it is in the range of a formula."""
    rule = f"this formula holds from 0 to {largest:g}"
    return checked_range("packing_fraction", packing_fraction, 0.0, largest, rule)


def unit_sphere_surface(dimension: int) -> float:
    """Return the surface of the unit ball: 2 pi in 2D, 4 pi in 3D."""
    return {2: 2.0 * math.pi, 3: 4.0 * math.pi}[checked_dimension(dimension)]


@check_ranges
def particle_volume(dimension: int, diameter: float = 1.0) -> float:
    """Compute the area of a disc or the volume of a sphere [length^dimension].

    The area of a disc is pi sigma^2 / 4, the volume of a sphere pi sigma^3 / 6 (exact).
    """
    return ball_volume(checked_dimension(dimension), 0.5 * diameter)


@check_ranges
def number_density(packing_fraction: Numbers, dimension: int, diameter: float = 1.0) -> Values:
    """Compute the number of particles per volume from their packing fraction [1/length^dimension].

    rho = eta / v, with v of `particle_volume` (exact).
    """
    return packing_fraction / particle_volume(dimension, diameter)


@check_ranges
def packing_fraction(number_density: Numbers, dimension: int, diameter: float = 1.0) -> Values:
    """Compute the fraction of the container's volume that particles occupy.

    eta = rho v, with v of `particle_volume` (exact).

    Parameters
    ----------
    number_density : array_like, [1/length^dimension]
        Number of particles per volume, rho.
    """
    return number_density * particle_volume(dimension, diameter)
