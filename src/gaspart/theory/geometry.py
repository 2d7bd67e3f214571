"""Volume of a particle, number density and packing fraction of discs and spheres."""

import math

from gaspart.scene.geometry import ball_volume
from gaspart.theory._arguments import Numbers, Values, checked, checked_dimension


def unit_sphere_surface(dimension: int) -> float:
    """Return the surface of the unit ball: 2 pi in 2D, 4 pi in 3D (exact)."""
    return {2: 2.0 * math.pi, 3: 4.0 * math.pi}[checked_dimension(dimension)]


@checked
def particle_volume(dimension: int, diameter: float = 1.0) -> float:
    """Compute the area of a disc or the volume of a sphere.

    Parameters
    ----------
    dimension : {2, 3}
        Discs or spheres.
    diameter : float, default 1.0, [length]
        Diameter sigma of a particle.

    Returns
    -------
    float, [length^dimension]
        Area or volume v.

    Raises
    ------
    SceneError
        If an argument is out of range.

    Notes
    -----
    pi sigma^2 / 4 of a disc, pi sigma^3 / 6 of a sphere (exact).

    Examples
    --------
    >>> from gaspart import theory
    >>> round(theory.particle_volume(3), 4)
    0.5236
    """
    return ball_volume(checked_dimension(dimension), 0.5 * diameter)


@checked
def number_density(packing_fraction: Numbers, dimension: int, diameter: float = 1.0) -> Values:
    """Compute the number of particles per volume from their packing fraction.

    Parameters
    ----------
    packing_fraction : array_like, [1]
        Packing fraction eta.
    dimension : {2, 3}
        Discs or spheres.
    diameter : float, default 1.0, [length]
        Diameter sigma of a particle.

    Returns
    -------
    float or ndarray, same shape as `packing_fraction`, [1/length^dimension]
        Number density rho.

    Raises
    ------
    SceneError
        If an argument is out of range.

    Notes
    -----
    rho = eta / v, with v of `particle_volume` (exact).

    Examples
    --------
    >>> from gaspart import theory
    >>> round(theory.number_density(0.3, dimension=3), 4)
    0.573
    """
    return packing_fraction / particle_volume(dimension, diameter)


@checked
def packing_fraction(number_density: Numbers, dimension: int, diameter: float = 1.0) -> Values:
    """Compute the fraction of the container's volume that particles occupy.

    Parameters
    ----------
    number_density : array_like, [1/length^dimension]
        Number of particles per volume, rho.
    dimension : {2, 3}
        Discs or spheres.
    diameter : float, default 1.0, [length]
        Diameter sigma of a particle.

    Returns
    -------
    float or ndarray, same shape as `number_density`, [1]
        Packing fraction eta.

    Raises
    ------
    SceneError
        If an argument is out of range.

    Notes
    -----
    eta = rho v, with v of `particle_volume` (exact).

    Examples
    --------
    >>> from gaspart import theory
    >>> round(theory.packing_fraction(0.5, dimension=2), 4)
    0.3927
    """
    return number_density * particle_volume(dimension, diameter)
