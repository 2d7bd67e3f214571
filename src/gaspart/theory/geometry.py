"""Volume of a body, number density and packing fraction: one definition for discs and spheres."""

import math

from ._arguments import Numbers, Values, checked, checked_dimension

CLOSE_PACKING = {2: math.pi / math.sqrt(12.0), 3: math.pi / math.sqrt(18.0)}
"""Packing fraction of the densest arrangement: triangular lattice (2D), face-centred cubic (3D); exact."""


def unit_sphere_surface(dimension: int) -> float:
    """Surface of the unit ball: 2 pi (2D), 4 pi (3D); exact."""
    return {2: 2.0 * math.pi, 3: 4.0 * math.pi}[checked_dimension(dimension)]


@checked
def body_volume(dimension: int, diameter: float = 1.0) -> float:
    """Area of a disc, pi sigma^2 / 4, or volume of a sphere, pi sigma^3 / 6 (exact; length^dimension)."""
    return unit_sphere_surface(dimension) / dimension * (0.5 * diameter) ** dimension


@checked
def number_density(packing_fraction: Numbers, dimension: int, diameter: float = 1.0) -> Values:
    """Bodies per volume, rho = eta / v (exact; 1 / length^dimension)."""
    return packing_fraction / body_volume(dimension, diameter)


@checked
def packing_fraction(number_density: Numbers, dimension: int, diameter: float = 1.0) -> Values:
    """Fraction of the container's volume that bodies fill, eta = rho v (exact; dimensionless)."""
    return number_density * body_volume(dimension, diameter)
