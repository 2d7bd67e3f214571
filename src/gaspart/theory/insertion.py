"""Saturation of random sequential insertion, and the chance that an attempt fails.

Particles of diameter sigma are placed one after another at uniformly random points, and stay if they overlap
no other.
"""

import math

import numpy as np

from gaspart.theory._arguments import Numbers, Values, checked, checked_dimension, checked_packing_fraction

RSA_SATURATION = {2: 0.547074, 3: 0.384131}
"""Packing fraction at which no further particle fits, infinite container (Zhang, Torquato 2013, as public
programs quote it: 0.5470735 and 0.3841307)."""
RSA_SATURATION_UNCERTAINTY = {2: 3e-6, 3: 3e-6}
"""Standard uncertainty of RSA_SATURATION: a few units of the last digit. It is not verified, and is a
hundredth of the uncertainty of what is measured here.
"""

# Excess at hard walls, in diameters per side: saturation (1 + c sigma / L)^d for centres in [0, L]^d.
# Computed: fits to insertions to saturation at L/sigma = 4 ... 24 (3D) and 100 (2D).
_WALL_EXCESS = {2: 0.75, 3: 0.64}
_WALL_EXCESS_UNCERTAINTY = {2: 0.04, 3: 0.005}

# Second-order coefficient of the available fraction, (2^d)^2 / 2 - (3/2) b_3: exp(-mu_excess / k_B T) to
# eta^2.
_AVAILABLE_SECOND = {2: 6.0 * math.sqrt(3.0) / math.pi, 3: 17.0}


def _shape_factor(excess: float, dimension: int, side_over_diameter: float, boundary: str) -> float:
    """Return the ratio of saturations with and without walls, for a wall excess in diameters."""
    if boundary == "centres_to_walls":
        return (1.0 + excess / side_over_diameter) ** dimension
    if boundary == "wall":
        # Centres have L - sigma; the particles are counted in the volume L^d.
        return ((side_over_diameter - 1.0 + excess) / side_over_diameter) ** dimension
    raise ValueError(f"boundary: {boundary!r} (must be 'periodic', 'wall' or 'centres_to_walls')")


@checked
def insertion_saturation(
    dimension: int, side_over_diameter: float | None = None, boundary: str = "periodic"
) -> float:
    """Compute the packing fraction at which no further particle fits into a square or cube.

    Parameters
    ----------
    dimension : {2, 3}
        Discs or spheres.
    side_over_diameter : float, optional, [1]
        Side L of the container divided by the diameter sigma, at least 1. Default: an infinite container.
    boundary : {"periodic", "wall", "centres_to_walls"}, default "periodic"
        Faces of the container, and what they stop: surfaces ("wall") or centres of particles.

    Returns
    -------
    float, [1]
        Packing fraction at saturation.

    Raises
    ------
    SceneError
        If `dimension` or `side_over_diameter` is out of range.
    ValueError
        If `boundary` has another value.

    See Also
    --------
    insertion_saturation_uncertainty : Standard uncertainty of this value.

    Notes
    -----
    - "periodic": the infinite value eta_s of `RSA_SATURATION` at every L; there are fluctuations only.
    - "centres_to_walls": source A's rule. Centres are in [0, L]^d and particles are counted completely, so
      the value is eta_s (1 + c sigma / L)^d. Computed: c = 0.64 in 3D for L / sigma >= 4, and c = 0.75 in 2D
      for L / sigma about 100.
    - "wall": particles are completely inside. The value is the same with centres in L - sigma, so that the
      packing fraction stays below the infinite value.

    Examples
    --------
    >>> from gaspart import theory
    >>> round(theory.insertion_saturation(3, 10.0, "wall"), 4)
    0.3441
    """
    infinite = RSA_SATURATION[checked_dimension(dimension)]
    if side_over_diameter is None or boundary == "periodic":
        return infinite
    return infinite * _shape_factor(_WALL_EXCESS[dimension], dimension, side_over_diameter, boundary)


@checked
def insertion_saturation_uncertainty(
    dimension: int, side_over_diameter: float | None = None, boundary: str = "periodic"
) -> float:
    """Compute the standard uncertainty of `insertion_saturation`.

    Parameters
    ----------
    dimension : {2, 3}
        Discs or spheres.
    side_over_diameter : float, optional, [1]
        Side of the container divided by the diameter, at least 1. Default: an infinite container.
    boundary : {"periodic", "wall", "centres_to_walls"}, default "periodic"
        Faces of the container, as for `insertion_saturation`.

    Returns
    -------
    float, [1]
        Standard uncertainty of the packing fraction at saturation.

    Raises
    ------
    SceneError
        If `dimension` or `side_over_diameter` is out of range.
    ValueError
        If `boundary` has another value.

    Notes
    -----
    The uncertainty of the literature's value and the uncertainty of the wall excess, added in quadrature.

    Examples
    --------
    >>> from gaspart import theory
    >>> float(f"{theory.insertion_saturation_uncertainty(3, 10.0, 'wall'):.2g}")
    0.00054
    """
    relative = RSA_SATURATION_UNCERTAINTY[checked_dimension(dimension)] / RSA_SATURATION[dimension]
    value = insertion_saturation(dimension, side_over_diameter, boundary)
    if side_over_diameter is None or boundary == "periodic":
        return value * relative
    excess, spread = _WALL_EXCESS[dimension], _WALL_EXCESS_UNCERTAINTY[dimension]
    more = _shape_factor(excess + spread, dimension, side_over_diameter, boundary)
    less = _shape_factor(excess - spread, dimension, side_over_diameter, boundary)
    return math.hypot(value * relative, 0.5 * (more - less) * RSA_SATURATION[dimension])


def available_fraction(packing_fraction: Numbers, dimension: int) -> Values:
    """Compute the chance that a random attempt to insert a particle succeeds.

    Parameters
    ----------
    packing_fraction : array_like, [1]
        Packing fraction eta, from 0 to the minimum of the parabola: 0.605 for discs, 0.235 for spheres.
    dimension : {2, 3}
        Discs or spheres.

    Returns
    -------
    ndarray, same shape as `packing_fraction`, [1]
        Chance that no particle is in the way.

    Raises
    ------
    SceneError
        If an argument is out of range.

    Notes
    -----
    1 - 2^d eta + c_2 eta^2, with c_2 = 6 sqrt 3 / pi (2D) or 17 (3D). It is exact to eta^2, where insertion
    and equilibrium still agree [1]_ [2]_. So c_2 follows from B2 and B3 (tested). It holds for an infinite or
    periodic container. The third order is neglected, which limits it to about 1 % at eta = 0.05 in 3D and 0.1
    in 2D.

    References
    ----------
    .. [1] B. Widom (1966).
    .. [2] P. Schaaf and J. Talbot (1989).

    Examples
    --------
    >>> from gaspart import theory
    >>> float(theory.available_fraction(0.05, dimension=3).round(4))
    0.6425
    """
    first = 2.0 ** checked_dimension(dimension)
    second = _AVAILABLE_SECOND[dimension]
    eta = checked_packing_fraction(packing_fraction, 0.5 * first / second)
    return 1.0 - first * eta + second * eta**2


def failures_per_particle(packing_fraction: Numbers, dimension: int) -> Values:
    """Compute the mean number of failed attempts before a particle is placed.

    Parameters
    ----------
    packing_fraction : array_like, [1]
        Packing fraction eta, in the range of `available_fraction`.
    dimension : {2, 3}
        Discs or spheres.

    Returns
    -------
    ndarray, same shape as `packing_fraction`, [1]
        Mean number of failures at this packing fraction.

    Raises
    ------
    SceneError
        If an argument is out of range.

    Notes
    -----
    1 / `available_fraction` - 1, which is 2^d eta at low density (exact).

    Examples
    --------
    >>> from gaspart import theory
    >>> float(theory.failures_per_particle(0.05, dimension=3).round(4))
    0.5564
    """
    available = available_fraction(packing_fraction, dimension)
    return (1.0 - available) / np.asarray(available)
