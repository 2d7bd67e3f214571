r"""Hard particles between hard walls: what a container shifts in the pressure that its walls feel.

Centres can touch a container that has walls on w of its d axes only within l = L - sigma on each of these,
so that is the volume V to which the fluid's thermodynamics applies. With the surface tension gamma of the
fluid at the plane of the centres and the free energy tau of an edge (3D) or corner (2D), the grand potential
is, all walled sides being alike,

.. math:: \Omega / V = -P + 2 w \gamma / l + 2 w (w-1) \tau / l^2 .

Its derivative by the chemical potential is the number of particles, by one of the lengths the force on a
wall:

.. math:: N / V = \rho + 2 w \Gamma / l + 2 w (w-1) \Gamma_\tau / l^2, \qquad
          F / A = P - 2 (w-1) \gamma / l - 2 (w-1)(w-2) \tau / l^2 ,

with Gamma = - rho (d gamma / d rho) / (dP / d rho), likewise Gamma_tau, and rho the density of a bulk fluid
of the same chemical potential. To second order in the density all of this is exact. Between two walls (w = 1)
there are no edges and the walls feel just P. Everything here is in diameters and k_B T.
"""

import math
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np

from gaspart.theory._arguments import Numbers, Values, checked, checked_dimension, checked_packing_fraction
from gaspart.theory.geometry import number_density
from gaspart.theory.state import compressibility_factor, compressibility_uncertainty, finite_size_correction

_TABLES = Path(__file__).parent / "data"
_DENSEST = 0.49
"""Where the table of the surface tension of spheres ends."""
# To second order in rho, from the overlap of two centres in a box (exact): gamma = -coefficient rho^2 and
# tau = coefficient rho^2.
_SURFACE = {2: 1.0 / 3.0, 3: math.pi / 8.0}
_EDGE = {2: 1.0 / 16.0, 3: 1.0 / 15.0}
_THIRD_DISCS = 2.3560
"""The third order of gamma for discs over the second, over eta: the cluster integral of three centres at a
wall, by quasi-Monte Carlo (`tests/theory/test_walls.py`; 1e-4)."""
_STEP = 1e-4  # of the central differences, in packing fraction


@cache
def _shape(dimension: int) -> tuple[np.ndarray, np.ndarray]:
    """Polynomials in eta for gamma (1 - eta)^d over its second-order form, which is 1 at eta = 0, and for its
    uncertainty. Spheres: through the table's points to some 1e-4. Discs: exact to third order, and a tenth of
    what (1 - eta)^-2 adds to that."""
    if dimension == 2:
        beyond = np.array([0.0, 0.0, 2.0 * _THIRD_DISCS - 1.0, -_THIRD_DISCS])
        return np.array([1.0, _THIRD_DISCS - 2.0]), -0.1 * beyond
    eta, tension, uncertainty = np.loadtxt(
        _TABLES / "surface_tension_3d.csv", delimiter=",", skiprows=1, unpack=True
    )
    scale = -_SURFACE[3] * number_density(eta, 3) ** 2 / (1.0 - eta) ** 3
    design = eta[:, None] ** np.arange(1, 6)
    excess = np.linalg.lstsq(design, tension / scale - 1.0, rcond=None)[0]
    spread = np.linalg.lstsq(design, -uncertainty / scale, rcond=None)[0]
    return np.concatenate([[1.0], excess]), np.concatenate([[0.0], spread])


def _tension(packing_fraction: Numbers, dimension: int, which: int) -> Values:
    eta = checked_packing_fraction(packing_fraction, _DENSEST)
    scale = -_SURFACE[checked_dimension(dimension)] * number_density(eta, dimension) ** 2
    polynomial = np.polynomial.polynomial.polyval(eta, _shape(dimension)[which])
    return scale / (1.0 - eta) ** dimension * polynomial


def surface_tension(packing_fraction: Numbers, dimension: int) -> Values:
    """gamma sigma^(d-1) / k_B T of the fluid at a hard wall, its area counted where centres touch (negative).

    Spheres: White Bear II, Hansen-Goos and Roth, J. Phys. Condens. Matter 18, 8413 (2006) (table, computed).
    Discs: the exact second order times (1 + 0.356 eta) / (1 - eta)^2, exact to third order (computed). Range:
    eta <= 0.49.
    """
    return _tension(packing_fraction, dimension, 0)


def surface_tension_uncertainty(packing_fraction: Numbers, dimension: int) -> Values:
    """Standard uncertainty of `surface_tension`. Spheres: its distance from scaled particle theory, or 1 %;
    discs: a tenth of all that is beyond the exact third order (an estimate)."""
    return np.abs(_tension(packing_fraction, dimension, 1))


@checked
def wall_pressure(
    length: float, density: float, count: int, dimension: int, axes: int
) -> tuple[float, float]:
    """Mean pressure of `count` particles on the walls of a container, and its uncertainty.

    The force on a wall over the area that centres can touch, of the canonical ensemble: the module's
    equations, and the canonical correction of first order in 1/N (`finite_size_correction`). The uncertainty
    is that of the equation of state, of the surface tension, and of the edges, whose second order is
    uncertain by as much as gamma exceeds its own.

    length: the side of the container along each of its walled `axes`, in diameters; density: particles per
    volume that centres can touch. Returns two numbers in k_B T / sigma^d. Raises ValueError for a container
    no larger than a particle, a number of axes it does not have, or a fluid that would be denser than eta =
    0.49.
    """
    if not length > 1.0:
        raise ValueError(f"length: {length} (must be above 1, the diameter)")
    if not 1 <= axes <= checked_dimension(dimension):
        raise ValueError(f"axes: {axes} (from 1 to {dimension} have walls)")
    arguments = length - 1.0, density, count, dimension, axes
    eta, value = _in_container(*arguments)
    tension = float(surface_tension(eta, dimension))
    relative = float(surface_tension_uncertainty(eta, dimension)) / abs(tension)
    second_order = -_SURFACE[dimension] * number_density(eta, dimension) ** 2
    errors = (
        number_density(eta, dimension) * float(compressibility_uncertainty(eta, dimension)),
        _in_container(*arguments, tension=1.0 + relative)[1] - value,
        _in_container(*arguments, edge=tension / second_order)[1] - value,
    )
    return value, math.hypot(*errors)


def _in_container(
    inner: float,
    density: float,
    count: int,
    dimension: int,
    axes: int,
    tension: float = 1.0,
    edge: float = 1.0,
) -> tuple[float, float]:
    """Packing fraction of the bulk, and pressure on the walls, with gamma and tau multiplied."""
    surfaces, edges = 2 * axes / inner, 2 * axes * (axes - 1) / inner**2

    def gamma(eta: float) -> Values:
        return tension * surface_tension(eta, dimension)

    def tau(eta: float) -> Values:
        return edge * _EDGE[dimension] * number_density(eta, dimension) ** 2

    def excess(eta: float) -> float:
        """By how much the particles at this density of the bulk are too many."""
        slope = _slope(lambda x: x * compressibility_factor(x, dimension), eta)
        adsorbed = -eta / slope * (surfaces * _slope(gamma, eta) + edges * _slope(tau, eta))
        return float(number_density(eta, dimension) + adsorbed - density)

    low, high = _STEP, _DENSEST - _STEP
    if excess(high) < 0.0:
        raise ValueError(f"density: {density} (the fluid would be denser than {_DENSEST})")
    while high - low > 1e-13:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if excess(middle) < 0.0 else (low, middle)
    z = compressibility_factor(low, dimension) + finite_size_correction(low, dimension, count, "canonical")
    at_surface = 2 * (axes - 1) * gamma(low) / inner
    at_edges = 2 * (axes - 1) * (axes - 2) * tau(low) / inner**2
    return low, float(number_density(low, dimension) * z - at_surface - at_edges)


def _slope(function: Callable[[float], Values], eta: float) -> float:
    """d function / d eta, by a central difference."""
    return (function(eta + _STEP) - function(eta - _STEP)) / (2.0 * _STEP)
