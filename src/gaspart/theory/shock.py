"""A shock that a piston drives through a gas at rest: the jump of density, temperature and pressure."""

from typing import NamedTuple

import numpy as np

from gaspart.errors import SceneError
from gaspart.theory._arguments import checked, checked_dimension, checked_packing_fraction, checked_range
from gaspart.theory.geometry import number_density
from gaspart.theory.state import HIGHEST_PACKING_FRACTION, compressibility_factor


class Shock(NamedTuple):
    """Of a steady shock: speed, of its front in the gas at rest; packing_fraction, temperature and pressure
    behind it, where the gas moves with the piston."""

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
    """The shock in front of a piston at a speed u, in a gas at rest of this packing fraction and temperature.

    The jump conditions of Rankine and Hugoniot, with the front at D, in the frame of the gas at rest: mass
    n (D - u) = n_0 D, momentum P - P_0 = m n_0 D u, energy d (T - T_0) / 2 = (P + P_0) (1/n_0 - 1/n) / 2, and
    the equation of state P = n T Z (`compressibility_factor`). Exact for a steady shock but for that. Raises
    SceneError for a speed that is not positive, and for a gas that is denser behind it than Z is known.
    """
    from scipy.optimize import brentq

    d, highest = checked_dimension(dimension), HIGHEST_PACKING_FRACTION[checked_dimension(dimension)]
    eta = float(checked_packing_fraction(packing_fraction, highest))
    checked_range("speed", speed, 1e-9, np.inf, "must be positive")
    density = float(number_density(eta, d, diameter))
    ahead = density * temperature * float(compressibility_factor(eta, d))

    def behind(ratio: float) -> Shock:
        """By mass, momentum and energy alone, for a ratio of densities."""
        front = speed * ratio / (ratio - 1.0)
        pressure = ahead + mass * density * front * speed
        gained = (pressure + ahead) * (1.0 - 1.0 / ratio) / density
        return Shock(front, eta * ratio, temperature + gained / d, pressure)

    def excess(ratio: float) -> float:
        """Of its pressure over that of the equation of state."""
        found = behind(ratio)
        factor = float(compressibility_factor(found.packing_fraction, d))
        return found.pressure - ratio * density * found.temperature * factor

    most = min(d + 1.0, highest / eta) * (1.0 - 1e-9)
    if excess(most) >= 0.0:
        raise SceneError("speed", speed, "compresses the gas beyond the densities of the equation of state")
    return behind(brentq(excess, 1.0 + 1e-9, most, xtol=1e-14))
