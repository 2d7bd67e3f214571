"""Heat transport between walls: gases at any Knudsen number, and electrons among scatterers with modes.

The walls are diffuse with full accommodation unless stated otherwise; k_B = 1. Fluxes are energies per area
(in 2D per length) and time, from the hot wall to the cold wall.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from gaspart.errors import SceneError
from gaspart.theory.enskog import enskog_conductivity, mean_free_path
from gaspart.theory.geometry import (
    Numbers,
    Values,
    check_ranges,
    checked_dimension,
    checked_packing_fraction,
    checked_range,
    number_density,
    packing_fraction,
)
from gaspart.theory.state import HIGHEST_PACKING_FRACTION, compressibility_factor

TEMPERATURE_JUMP = 2.127
"""Temperature jump coefficient at a diffuse wall for hard spheres: T_gas - T_wall divided by l_0 dT/dn, with
l_0 = 1 / (sqrt 2 pi n sigma^2). It is 2.4001 sqrt(pi) / 2, Sone, Ohwada and Aoki, Phys. Fluids A 1, 363
(1989). Moments of the linearised Boltzmann equation, derived again, differ from this value by less than 0.5 %
and converge to it (tested).
"""
ELEMENTARY_JUMP = 15.0 / 8.0
"""`TEMPERATURE_JUMP` by Maxwell's elementary argument, 2 gamma / (gamma + 1) / Pr with gamma = 5/3 and Pr =
2/3. The argument assumes that particles arrive with the distribution of the gas far from the wall. A
measurement must distinguish the two.
"""
INTERPOLATED = 0.08
"""Maximum relative error of `interpolated_flux` and `interpolated_stress` between their limits. Runs of the
DSMC engine between walls at temperatures 2 and 1 gave 0.929(7) of the interpolated flux at a Knudsen number
of 1, and 0.942(5) at 0.3. Between 4 and 1, and between 9 and 1, they gave 0.942(6) or more at
Knudsen numbers from 0.3 to 10. They gave 0.956(15) of the interpolated stress at 0.3.
"""
METAL_GAP, METAL_BEND, METAL_BEND_ERROR = 10.0, 0.044, 0.0046
"""Gap, in mean free paths, between walls at temperatures 2 and 1. The second number is the second-order
coefficient of the temperature of electrons among scatterers with modes, as a function of position divided by
the gap, without the outermost tenths. The third number is its standard error. The values were computed by the
program `tests/theory/electrons.py`: 10 metals of 20 000 electrons, for 800 or 1200 mean free times.
The coefficient is 0.037 for a linear T^0.85, and -0.12 for a linear T^(3/2) of a gas.
"""


FULL = (1.0, 1.0)
"""Accommodation coefficients of two walls that draw new velocities for all particles."""


@check_ranges
def free_molecular_flux(
    density: Numbers,
    hot: float,
    cold: float,
    dimension: int,
    mass: float = 1.0,
    components: str = "all",
    accommodation: tuple[float, float] = FULL,
) -> Values:
    """Compute the heat flux through a gas whose particles collide only with the walls [energy/(length^(d-1)
    time)].

    (d + 1) n sqrt(T_1 T_2 / (2 pi m)) (sqrt T_1 - sqrt T_2), exact (closed form). A particle carries (d + 1)
    T / 2 from a wall. If a wall changes only the normal component (R. Frederickx and P. Meerts (2010)), a
    particle carries T. Then the flux is multiplied by 2 / (d + 1), 1/2 in 3D and 2/3 in 2D. With partial
    accommodation (J. C. Maxwell (1879)), the flux at the same hit rate is multiplied by a_1 a_2 / (a_1 + a_2
    - a_1 a_2). The returned flux is for the same density. It is multiplied by a_1 a_2 (sqrt T_1 + sqrt T_2) /
    (a_1 (2 - a_2) sqrt T_2 + a_2 (2 - a_1) sqrt T_1), because most particles have the temperature of the wall
    with the larger accommodation.

    Parameters
    ----------
    density : float or ndarray, [1/length^d]
        Mean number density n.
    components : {"all", "normal"}, default "all"
        Components of the velocity that a wall changes.
    accommodation : tuple of float, default (1.0, 1.0), [1]
        Accommodation coefficients a_1 and a_2 of the hot and the cold wall: fractions of particles that
        receive a new velocity; the others are reflected specularly.
    """
    carried = {"all": checked_dimension(dimension) + 1, "normal": 2}[components]
    roots = np.sqrt(hot * cold) * (np.sqrt(hot) - np.sqrt(cold))
    at_hot, at_cold = accommodation
    streams = at_hot * (2.0 - at_cold) * np.sqrt(cold) + at_cold * (2.0 - at_hot) * np.sqrt(hot)
    part = at_hot * at_cold * (np.sqrt(cold) + np.sqrt(hot)) / streams
    return carried * density * roots / np.sqrt(2.0 * np.pi * mass) * part


@check_ranges
def dilute_fourier_flux(length: float, hot: float, cold: float, diameter: float = 1.0) -> float:
    """Compute the heat flux through dilute spheres in a wide gap from Fourier's law [energy/(length^2 time)].
    Heat flux of spheres of mass 1: (2/3) lambda_0 (T_1^(3/2) - T_2^(3/2)) / length, with the conductivity
    lambda_0 proportional to sqrt T. The formula is exact in the limit of a wide gap and a dilute gas, apart
    from the accuracy of lambda_0. It does not depend on the density (Maxwell 1860).
    """
    conductivity = enskog_conductivity(0.0, 3, diameter, 1.0)
    return 2.0 / 3.0 * conductivity * (hot**1.5 - cold**1.5) / length


@check_ranges
def interpolated_flux(length: float, density: float, hot: float, cold: float, diameter: float = 1.0) -> float:
    """Compute the heat flux through dilute spheres between two walls at any Knudsen number [energy/(length^2
    time)]. Heat flux of spheres of mass 1: 1 / (1 / free + 1 / fluid), where `free` is the flux of free
    molecular flow (`free_molecular_flux`) and `fluid` the flux of Fourier's law without temperature jumps
    (`dilute_fourier_flux`) (F. S. Sherman, Rarefied Gas Dynamics 2, 228 (1963)). For small temperature
    differences, it is 4 % above the flux with temperature jumps at a Knudsen number of 0.1, and 7 % above the
    flux of the DSMC engine at a Knudsen number of 1 (`INTERPOLATED`).
    """
    fluid = dilute_fourier_flux(length, hot, cold, diameter)
    free = float(free_molecular_flux(density, hot, cold, 3))
    return free * fluid / (free + fluid) if free else 0.0


@check_ranges
def steady_part(time: Numbers, length: float, diffusivity: float) -> Values:
    """Compute the temperature difference between the halves of a slab divided by its steady value."""
    odd = np.arange(1.0, 200.0, 2.0)
    decay = (2.0 * np.pi * odd) ** 2 * diffusivity / length**2
    modes = np.exp(-np.multiply.outer(np.asarray(time, dtype=float), decay)) / odd**2
    return 1.0 - 8.0 / np.pi**2 * modes.sum(axis=-1)


@dataclass(frozen=True)
class Slab:
    """Steady gas between two walls."""

    position: np.ndarray
    temperature: np.ndarray
    density: np.ndarray
    flux: float


@check_ranges
def conducting_slab(
    length: float,
    density: float,
    hot: float,
    cold: float,
    diameter: float = 1.0,
    jump: float = TEMPERATURE_JUMP,
) -> Slab:
    """Compute the profiles of spheres between walls from Fourier's law with temperature jumps.

    Positions, temperatures and number densities, and the heat flux, for spheres of mass 1: q = -lambda(n, T)
    dT/dx with Enskog's conductivity and a uniform pressure n T Z(eta) (computed numerically). In the dilute
    limit, without jumps, T^(3/2) is linear and q = (2/3) lambda_0 (T_1^(3/2) - T_2^(3/2)) / length (closed
    form). At each wall, the temperature of the gas differs from the temperature of the wall by the jump. The
    errors are of second order in the Knudsen number. The Knudsen layer next to a wall, about a mean free path
    thick, is not described.

    Parameters
    ----------
    length : float, [length]
        Width of the gap.
    density : float, [1/length^3]
        Mean number density.
    jump : float, default `TEMPERATURE_JUMP`, [1]
        Temperature jump at a wall, in mean free paths times dT/dx.
    """
    knudsen = float(mean_free_path(packing_fraction(density, 3, diameter), 3, diameter)) / length
    if knudsen > 0.1:
        raise ValueError(f"density: {density} (a Knudsen number of {knudsen:.2g}; this holds up to 0.1)")
    ends = np.array([hot, cold], dtype=float)
    for _ in range(60):
        slab = _slab_without_jumps(length, density, float(ends[0]), float(ends[1]), diameter)
        eta = packing_fraction(slab.density[[0, -1]], 3, diameter)
        slope = slab.flux / enskog_conductivity(eta, 3, diameter, 1.0) / np.sqrt(ends)
        shift = jump * mean_free_path(eta, 3, diameter) * slope
        ends = 0.5 * (ends + np.array([hot - shift[0], cold + shift[1]]))  # half steps do not overshoot
    return slab


def _slab_without_jumps(length: float, density: float, hot: float, cold: float, diameter: float) -> Slab:
    """Return the slab of a gas without temperature jumps at its walls."""
    temperature = np.linspace(hot, cold, 401)
    eta = np.linspace(0.0, 0.45, 4001)
    table = number_density(eta, 3, diameter) * compressibility_factor(eta, 3)  # pressure / temperature
    steps = -np.diff(temperature)

    def at(pressure: float) -> tuple[np.ndarray, np.ndarray, float]:
        local = np.interp(pressure / temperature, table, eta)
        conductivity = enskog_conductivity(local, 3, diameter, 1.0) * np.sqrt(temperature)
        weights = 0.5 * (conductivity[1:] + conductivity[:-1]) * steps  # heat flux times dx
        number = number_density(local, 3, diameter)
        return number, weights, 0.5 * (number[1:] + number[:-1]) @ weights / weights.sum()

    low, high = 0.0, table[-1] * cold
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if at(middle)[2] < density else (low, middle)
    number, weights, _ = at(high)
    position = np.concatenate([[0.0], np.cumsum(weights)]) * length / weights.sum()
    return Slab(position, temperature, number, float(weights.sum() / length))


# Shock in front of a piston in a gas at rest: jump of density, temperature and pressure.


class Shock(NamedTuple):
    """Steady shock, behind which the gas moves with the piston."""

    speed: float
    packing_fraction: float
    temperature: float
    pressure: float


@check_ranges
def shock_before_piston(
    packing_fraction: float,
    dimension: int,
    speed: float,
    temperature: float = 1.0,
    mass: float = 1.0,
    diameter: float = 1.0,
) -> Shock:
    """Compute the shock in front of a piston that moves into a gas at rest.

    The jump conditions of Rankine and Hugoniot for a front with velocity D, in the frame of the gas at rest,
    are: mass n (D - u) = n_0 D, momentum P - P_0 = m n_0 D u, energy d (T - T_0) / 2 = (P + P_0) (1/n_0 -
    1/n) / 2. The equation of state is P = n T Z (`compressibility_factor`). For a steady shock the equation
    of state is the only approximation.

    Parameters
    ----------
    packing_fraction : float, [1]
        Packing fraction of the gas at rest: up to 0.70 for discs, 0.539 for spheres.
    speed : float, [length/time]
        Speed u of the piston, above 0.
    temperature : float, default 1.0, [energy]
        Temperature k_B T_0 of the gas at rest.

    Examples
    --------
    >>> from gaspart import theory
    >>> shock = theory.shock_before_piston(0.01, dimension=3, speed=2.0)
    >>> round(shock.packing_fraction, 4), round(shock.pressure, 4)
    (0.0252, 0.1466)
    """
    from scipy.optimize import brentq

    d, highest = checked_dimension(dimension), HIGHEST_PACKING_FRACTION[checked_dimension(dimension)]
    eta = float(checked_packing_fraction(packing_fraction, highest))
    checked_range("speed", speed, 1e-9, np.inf, "must be positive")
    density = float(number_density(eta, d, diameter))
    ahead = density * temperature * float(compressibility_factor(eta, d))

    def behind(ratio: float) -> Shock:
        """Return the shock from conservation of mass, momentum and energy, for a density ratio."""
        front = speed * ratio / (ratio - 1.0)
        pressure = ahead + mass * density * front * speed
        gained = (pressure + ahead) * (1.0 - 1.0 / ratio) / density
        return Shock(front, eta * ratio, temperature + gained / d, pressure)

    def excess(ratio: float) -> float:
        """Return the pressure of this shock minus the pressure of the equation of state."""
        shock = behind(ratio)
        factor = float(compressibility_factor(shock.packing_fraction, d))
        return shock.pressure - ratio * density * shock.temperature * factor

    most = min(d + 1.0, highest / eta) * (1.0 - 1e-9)
    if excess(most) >= 0.0:
        raise SceneError("speed", speed, "compresses the gas beyond the densities of the equation of state")
    return behind(brentq(excess, 1.0 + 1e-9, most, xtol=1e-14))
