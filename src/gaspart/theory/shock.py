"""Shock before a piston in a gas at rest: jump of density, temperature and pressure."""

from typing import NamedTuple

import numpy as np

from gaspart.errors import SceneError
from gaspart.theory._arguments import checked, checked_dimension, checked_packing_fraction, checked_range
from gaspart.theory.geometry import number_density
from gaspart.theory.state import HIGHEST_PACKING_FRACTION, compressibility_factor


class Shock(NamedTuple):
    """Steady shock, behind which the gas moves with the piston.

    Parameters
    ----------
    speed : float, [length/time]
        Speed of the front in the gas at rest.
    packing_fraction : float, [1]
        Packing fraction behind the front.
    temperature : float, [energy]
        Temperature k_B T behind the front.
    pressure : float, [energy/length^dimension]
        Pressure behind the front.

    See Also
    --------
    shock_before_piston : Compute the shock of a piston.

    Examples
    --------
    >>> from gaspart import theory
    >>> shock = theory.shock_before_piston(0.01, dimension=3, speed=2.0)
    >>> round(shock.speed, 4), round(shock.temperature, 4)
    (3.317, 2.7518)
    """

    speed: float
    packing_fraction: float
    temperature: float
    pressure: float


@checked
def shock_before_piston(
    packing_fraction: float,
    dimension: int,
    speed: float,
    temperature: float = 1.0,
    mass: float = 1.0,
    diameter: float = 1.0,
) -> Shock:
    """Compute the shock in front of a piston that moves into a gas at rest.

    Parameters
    ----------
    packing_fraction : float, [1]
        Packing fraction of the gas at rest: up to 0.70 for discs, 0.539 for spheres.
    dimension : {2, 3}
        Discs or spheres.
    speed : float, [length/time]
        Speed u of the piston, above 0.
    temperature : float, default 1.0, [energy]
        Temperature k_B T_0 of the gas at rest.
    mass : float, default 1.0, [mass]
        Mass m of a particle.
    diameter : float, default 1.0, [length]
        Diameter sigma of a particle.

    Returns
    -------
    Shock
        Speed of the front and state behind it.

    Raises
    ------
    SceneError
        If an argument is out of range, or if the gas behind the front is denser than Z is known.

    Notes
    -----
    The jump conditions of Rankine and Hugoniot, with the front at D, in the frame of the gas at rest: mass n
    (D - u) = n_0 D, momentum P - P_0 = m n_0 D u, energy d (T - T_0) / 2 = (P + P_0) (1/n_0 - 1/n) / 2. The
    equation of state is P = n T Z (`compressibility_factor`). For a steady shock it is the only
    approximation.

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
        """Return the shock by mass, momentum and energy alone, for a ratio of densities."""
        front = speed * ratio / (ratio - 1.0)
        pressure = ahead + mass * density * front * speed
        gained = (pressure + ahead) * (1.0 - 1.0 / ratio) / density
        return Shock(front, eta * ratio, temperature + gained / d, pressure)

    def excess(ratio: float) -> float:
        """Return its pressure less the pressure of the equation of state."""
        found = behind(ratio)
        factor = float(compressibility_factor(found.packing_fraction, d))
        return found.pressure - ratio * density * found.temperature * factor

    most = min(d + 1.0, highest / eta) * (1.0 - 1e-9)
    if excess(most) >= 0.0:
        raise SceneError("speed", speed, "compresses the gas beyond the densities of the equation of state")
    return behind(brentq(excess, 1.0 + 1e-9, most, xtol=1e-14))
