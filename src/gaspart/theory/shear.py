"""A gas between two walls that slide past each other, or along which a force drives it: slip, free flight,
heating and normal stresses.

The walls are diffuse with full accommodation, a distance `length` apart, and their velocities differ by
`velocity`; k_B = 1.
"""

import numpy as np

from gaspart.theory._arguments import Numbers, Values, checked
from gaspart.theory.enskog import enskog_conductivity, enskog_viscosity
from gaspart.theory.heat import FULL

VELOCITY_SLIP = 1.1113
"""u_gas - u_wall over l_0 du/dn at a diffuse wall, hard spheres, l_0 = 1 / (sqrt 2 pi n sigma^2): 1.2540
sqrt(pi) / 2, Ohwada, Sone and Aoki, Phys. Fluids A 1, 1588 (1989). Moments of the linearised Boltzmann
equation, derived again, converge to it (tested)."""
ELEMENTARY_SLIP = 0.9975
"""`VELOCITY_SLIP` by Maxwell's elementary argument, (mu / p) sqrt(pi T / 2 m) with the viscosity mu:
particles arrive with the distribution of the gas far from the wall. A measurement must distinguish both."""
NORMAL_STRESSES = (-1.2, 1.6, -0.4)
"""(P_xx / p - 1) / a^2, and those of yy and zz, of a flow u along y that changes along x; a = -P_xy / p.

Moments of the steady Boltzmann equation: (p / mu) (P_ij - p delta_ij) = -dM_ij/dx, for yy less 2 P_xy du/dx,
with the viscosity mu; the transport of P_ij along x is M = 2/5 q (3, 1, 1) for xx, yy, zz, with Fourier's
heat flux q, and dq/dx = mu (du/dx)^2. To second order in a; exact for Maxwell molecules. For spheres the
products of stresses are neglected, and Sonine polynomials beyond the first."""


@checked
def free_molecular_stress(
    density: Numbers,
    velocity: Numbers,
    temperature: float = 1.0,
    mass: float = 1.0,
    accommodation: tuple[float, float] = FULL,
) -> Values:
    """Shear stress on the walls of a gas whose particles collide with the walls only, n velocity sqrt(m T / 2
    pi); with the `accommodation` a_1 and a_2 of the walls a_1 a_2 / (a_1 + a_2 - a_1 a_2) of it. Exact
    (closed form)."""
    one, other = accommodation
    part = one * other / (one + other - one * other)
    return density * np.asarray(velocity, dtype=float) * np.sqrt(mass * temperature / (2.0 * np.pi)) * part


@checked
def slip_flow_stress(length: Numbers, density: Numbers, velocity: Numbers, diameter: float = 1.0) -> Values:
    """Shear stress of dilute spheres of mass 1 at temperature 1, with slip at both walls: mu velocity /
    (length + 2 `VELOCITY_SLIP` l_0), mu the viscosity. To first order in `velocity` and l_0 / length."""
    path = 1.0 / (np.sqrt(2.0) * np.pi * np.asarray(density, dtype=float) * diameter**2)
    return enskog_viscosity(0.0, 3, diameter) * velocity / (length + 2.0 * VELOCITY_SLIP * path)


@checked
def channel_velocity(
    height: Numbers, length: Numbers, density: Numbers, force: Numbers, diameter: float = 1.0
) -> Values:
    """Velocity of dilute spheres of mass 1 at temperature 1 that a force on each drives along two walls at
    rest, at a height above one of them: Poiseuille's parabola with slip, density force / (2 mu) [height
    (length - height) + `VELOCITY_SLIP` l_0 length], mu the viscosity.

    To first order in `force` and l_0 / length. The next order in l_0 adds 0.6 density force l_0^2 / mu
    (Hadjiconstantinou, Phys. Fluids 15, 2352 (2003)).
    """
    height, length, density, force = (np.asarray(a, dtype=float) for a in (height, length, density, force))
    path = 1.0 / (np.sqrt(2.0) * np.pi * density * diameter**2)
    shape = height * (length - height) + VELOCITY_SLIP * path * length
    return 0.5 * density * force / enskog_viscosity(0.0, 3, diameter) * shape


@checked
def free_flight_drift(
    time: Numbers, length: float, force: float = 1.0, temperature: float = 1.0, mass: float = 1.0
) -> Values:
    """Mean velocity along two walls of particles that collide with these only, a time after a force on each
    was switched on in equilibrium. Exact (closed form).

    It is force / mass times the mean of the time since a particle was at a wall, `time` at most: the integral
    over t of the share that was at none for t, the average of 1 - |v| t / length, if positive, over Maxwell's
    distribution. It grows with the logarithm of time, without limit: so many particles cross slowly.
    """
    from scipy.special import erf, exp1

    crossing = length / np.sqrt(temperature / mass)
    s = np.asarray(time, dtype=float) / crossing
    w = 0.5 / np.maximum(s, 1e-9) ** 2
    age = s * erf(np.sqrt(w)) + (0.5 * exp1(w) + s**2 * np.expm1(-w)) / np.sqrt(2.0 * np.pi)
    return force / mass * crossing * age


@checked
def interpolated_stress(
    length: Numbers, density: Numbers, velocity: Numbers, diameter: float = 1.0
) -> Values:
    """Shear stress of dilute spheres of mass 1 at temperature 1 at any Knudsen number: 1 / (1 / free + 1 /
    fluid), of the stress of free flight and of that without slip.

    In the form of Sherman, Rarefied Gas Dynamics 2, 228 (1963). To first order in `velocity` right in both
    limits, an approximation between them: 2 % above the stress with slip at a Knudsen number of 0.1.
    """
    free = free_molecular_stress(density, 1.0)
    fluid = enskog_viscosity(0.0, 3, diameter) / length
    return velocity * free * fluid / (free + fluid)


@checked
def viscous_heating(packing_fraction: Numbers, dimension: int) -> Values:
    """Viscosity over twice the conductivity, by Enskog, in units of mass / k_B: between two walls T + this
    times u^2 is the same everywhere, u the velocity relative to the place where T is highest.

    Exact where the ratio does not change: both grow with the square root of T. 2 / 15 in the first Sonine
    approximation of dilute spheres.
    """
    conductivity = enskog_conductivity(packing_fraction, dimension)
    return 0.5 * enskog_viscosity(packing_fraction, dimension) / conductivity
