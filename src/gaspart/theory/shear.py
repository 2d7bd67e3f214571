"""Gas between two parallel walls: slip, free molecular flow, viscous heating and normal stresses.

The walls slide relative to each other, or a force drives the gas along them. They are diffuse with full
accommodation, a distance `length` apart, and their velocities differ by `velocity`; k_B = 1.
"""

import numpy as np

from gaspart.theory.enskog import enskog_conductivity, enskog_viscosity
from gaspart.theory.geometry import Numbers, Values, check_ranges
from gaspart.theory.heat import FULL

VELOCITY_SLIP = 1.1113
"""Slip coefficient at a diffuse wall for hard spheres: u_gas - u_wall divided by l_0 du/dn, with l_0 = 1 /
(sqrt 2 pi n sigma^2). It is 1.2540 sqrt(pi) / 2: Ohwada, Sone and Aoki, Phys. Fluids A 1, 1588 (1989).
Moments of the linearised Boltzmann equation, derived again, converge to it (tested).
"""
ELEMENTARY_SLIP = 0.9975
"""Slip coefficient as `VELOCITY_SLIP`, from Maxwell's elementary argument: (mu / p) sqrt(pi T / 2 m) with the
viscosity mu. The argument assumes that particles arrive with the distribution of the gas far from the wall. A
measurement must distinguish the two values.
"""
NORMAL_STRESSES = (-1.2, 1.6, -0.4)
"""Normal stresses (P_xx / p - 1) / a^2, and the same for yy and zz, in a flow u along y that varies along x;
a = -P_xy / p.

The stresses follow from moments of the steady Boltzmann equation: (p / mu) (P_ij - p delta_ij) = -dM_ij/dx,
with the additional term -2 P_xy du/dx for yy. Here mu is the viscosity. The transport of P_ij along x is M =
2/5 q (3, 1, 1) for xx, yy, zz, with Fourier's heat flux q, and dq/dx = mu (du/dx)^2. The values are correct
to second order in a, and exact for Maxwell molecules. For spheres, products of stresses and Sonine
polynomials beyond the first are neglected.
"""


@check_ranges
def free_molecular_stress(
    density: Numbers,
    velocity: Numbers,
    temperature: float = 1.0,
    mass: float = 1.0,
    accommodation: tuple[float, float] = FULL,
) -> Values:
    """Compute the shear stress of a gas whose particles collide only with the walls [mass
    length^(2-d)/time^2].

    n velocity sqrt(m T / 2 pi), multiplied by a_1 a_2 / (a_1 + a_2 - a_1 a_2). Exact (closed form).

    Parameters
    ----------
    density : array_like, [1/length^d]
        Number density n in d dimensions.
    velocity : array_like, [length/time]
        Difference of the walls' velocities.
    accommodation : (float, float), default (1.0, 1.0), [1]
        Accommodation coefficients a_1 and a_2 of the walls.
    """
    first, second = accommodation
    part = first * second / (first + second - first * second)
    return density * np.asarray(velocity, dtype=float) * np.sqrt(mass * temperature / (2.0 * np.pi)) * part


@check_ranges
def slip_flow_stress(length: Numbers, density: Numbers, velocity: Numbers, diameter: float = 1.0) -> Values:
    """Compute the shear stress of dilute spheres between sliding walls, with slip at both walls [mass/(length
    time^2)].

    Shear stress of spheres of mass 1 at temperature 1: mu velocity / (length + 2 `VELOCITY_SLIP` l_0), with
    the viscosity mu. The formula is of first order in `velocity` and l_0 / length.

    Parameters
    ----------
    length : array_like, [length]
        Distance between the walls.
    velocity : array_like, [length/time]
        Difference of the walls' velocities.
    """
    path = 1.0 / (np.sqrt(2.0) * np.pi * np.asarray(density, dtype=float) * diameter**2)
    return enskog_viscosity(0.0, 3, diameter) * velocity / (length + 2.0 * VELOCITY_SLIP * path)


@check_ranges
def channel_velocity(
    height: Numbers, length: Numbers, density: Numbers, force: Numbers, diameter: float = 1.0
) -> Values:
    """Compute the velocity of dilute spheres that a force drives along two resting walls [length/time].
    Velocity of spheres of mass 1 at temperature 1. The profile is Poiseuille's parabola with slip: density
    force / (2 mu) [height (length - height) + `VELOCITY_SLIP` l_0 length], with the viscosity mu. The next
    order in l_0 adds 0.6 density force l_0^2 / mu (N. G. Hadjiconstantinou, Phys. Fluids 15, 2352 (2003)).
    """
    height, length, density, force = (np.asarray(a, dtype=float) for a in (height, length, density, force))
    path = 1.0 / (np.sqrt(2.0) * np.pi * density * diameter**2)
    shape = height * (length - height) + VELOCITY_SLIP * path * length
    return 0.5 * density * force / enskog_viscosity(0.0, 3, diameter) * shape


@check_ranges
def interpolated_stress(
    length: Numbers, density: Numbers, velocity: Numbers, diameter: float = 1.0
) -> Values:
    """Compute the shear stress of dilute spheres between sliding walls at any Knudsen number [mass/(length
    time^2)]. Shear stress of spheres of mass 1 at temperature 1: 1 / (1 / free + 1 / fluid), where `free` is
    the stress of free molecular flow and `fluid` the stress without slip, in Sherman's form (F. S. Sherman,
    Rarefied Gas Dynamics 2, 228 (1963)). Between the limits it is an approximation: 2 % above the stress with
    slip at a Knudsen number of 0.1.
    """
    free = free_molecular_stress(density, 1.0)
    fluid = enskog_viscosity(0.0, 3, diameter) / length
    return velocity * free * fluid / (free + fluid)


@check_ranges
def viscous_heating(packing_fraction: Numbers, dimension: int) -> Values:
    """Compute Enskog's viscosity divided by twice the thermal conductivity [mass]. Between two walls, T plus
    this ratio times u^2 is uniform. u is relative to the position of the highest temperature. The result is
    exact if the ratio of the two coefficients is constant; both are proportional to the square root of T. The
    ratio is 2 / 15 in the first Sonine approximation of dilute spheres.
    """
    conductivity = enskog_conductivity(packing_fraction, dimension)
    return 0.5 * enskog_viscosity(packing_fraction, dimension) / conductivity
