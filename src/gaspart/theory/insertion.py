"""Random sequential insertion: where it ends, and how often an attempt fails.

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
"""Standard uncertainty of RSA_SATURATION: a few units of the last digit (not verified; a hundredth of that of
what is measured here)."""

# Excess at hard walls, in diameters per side: saturation (1 + c sigma / L)^d for centres in [0, L]^d.
# Computed: fits to insertions to saturation at L/sigma = 4 ... 24 (3D) and 100 (2D).
_WALL_EXCESS = {2: 0.75, 3: 0.64}
_WALL_EXCESS_UNCERTAINTY = {2: 0.04, 3: 0.005}

# Second-order coefficient of the available fraction, (2^d)^2 / 2 - (3/2) b_3: exp(-mu_excess / k_B T) to
# eta^2.
_AVAILABLE_SECOND = {2: 6.0 * math.sqrt(3.0) / math.pi, 3: 17.0}


def _shape_factor(excess: float, dimension: int, side_over_diameter: float, boundary: str) -> float:
    """Saturation in the container over that of the infinite one, for a wall excess in diameters."""
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
    """Packing fraction at saturation of a square or cubic container of side L (dimensionless).

    boundary: "periodic": the infinite value at every L (fluctuations only); "centres_to_walls": source A's
    rule, centres in [0, L]^d, particles counted completely: eta_s (1 + c sigma/L)^d, c = 0.64 (3D, computed,
    L/sigma >= 4) or 0.75 (2D, computed, L/sigma about 100); "wall": particles completely inside, the same
    with centres in L - sigma, so that the packing fraction stays below the infinite value.
    side_over_diameter: None for an infinite container.
    """
    infinite = RSA_SATURATION[checked_dimension(dimension)]
    if side_over_diameter is None or boundary == "periodic":
        return infinite
    return infinite * _shape_factor(_WALL_EXCESS[dimension], dimension, side_over_diameter, boundary)


@checked
def insertion_saturation_uncertainty(
    dimension: int, side_over_diameter: float | None = None, boundary: str = "periodic"
) -> float:
    """Standard uncertainty of `insertion_saturation`: literature's and the wall excess's."""
    relative = RSA_SATURATION_UNCERTAINTY[checked_dimension(dimension)] / RSA_SATURATION[dimension]
    value = insertion_saturation(dimension, side_over_diameter, boundary)
    if side_over_diameter is None or boundary == "periodic":
        return value * relative
    excess, spread = _WALL_EXCESS[dimension], _WALL_EXCESS_UNCERTAINTY[dimension]
    more = _shape_factor(excess + spread, dimension, side_over_diameter, boundary)
    less = _shape_factor(excess - spread, dimension, side_over_diameter, boundary)
    return math.hypot(value * relative, 0.5 * (more - less) * RSA_SATURATION[dimension])


def available_fraction(packing_fraction: Numbers, dimension: int) -> Values:
    """Chance that a random attempt fits: 1 - 2^d eta + c_2 eta^2, c_2 = 6 sqrt 3 / pi (2D), 17 (3D).

    Exact to eta^2, where insertion and equilibrium still agree (Widom 1966, Schaaf and Talbot 1989), so c_2
    follows from B2 and B3 (tested). Infinite or periodic container. The neglected third order limits
    it to about 1 % at eta = 0.05 in 3D and 0.1 in 2D; refused beyond the minimum of the parabola.
    """
    first = 2.0 ** checked_dimension(dimension)
    second = _AVAILABLE_SECOND[dimension]
    eta = checked_packing_fraction(packing_fraction, 0.5 * first / second)
    return 1.0 - first * eta + second * eta**2


def failures_per_particle(packing_fraction: Numbers, dimension: int) -> Values:
    """Mean number of failed attempts before a particle is placed at this packing fraction: 1 / available - 1.

    2^d eta at low density (exact); range that of `available_fraction`.
    """
    available = available_fraction(packing_fraction, dimension)
    return (1.0 - available) / np.asarray(available)
