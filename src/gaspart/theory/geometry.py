"""Volume of a particle, number density and packing fraction: one definition for discs and spheres."""

import math

from gaspart.scene.geometry import ball_volume
from gaspart.theory._arguments import Numbers, Values, checked, checked_dimension


def unit_sphere_surface(dimension: int) -> float:
    """Surface of the unit ball: 2 pi (2D), 4 pi (3D); exact."""
    return {2: 2.0 * math.pi, 3: 4.0 * math.pi}[checked_dimension(dimension)]


@checked
def particle_volume(dimension: int, diameter: float = 1.0) -> float:
    """Area of a disc, pi sigma^2 / 4, or volume of a sphere, pi sigma^3 / 6 (exact; length^dimension)."""
    return ball_volume(checked_dimension(dimension), 0.5 * diameter)


@checked
def number_density(packing_fraction: Numbers, dimension: int, diameter: float = 1.0) -> Values:
    """Particles per volume, rho = eta / v (exact; 1 / length^dimension)."""
    return packing_fraction / particle_volume(dimension, diameter)


@checked
def packing_fraction(number_density: Numbers, dimension: int, diameter: float = 1.0) -> Values:
    """Fraction of the container's volume that particles fill, eta = rho v (exact; dimensionless)."""
    return number_density * particle_volume(dimension, diameter)
