"""Distribution of the time of free flight of a particle between two collisions.

All functions take `packing_fraction`, dimension 2 or 3, and the diameter, temperature (k_B = 1) and mass of
the particles. Range: the collision rate at a given speed is exact in equilibrium at zero density. At higher
density it is multiplied by chi, as in Enskog theory. The distribution assumes that consecutive collisions are
independent (molecular chaos), which holds at low density. At a packing fraction of 0.05 the shortest flights
are 2 % less frequent (from events of 1000 and of 4000 spheres). Literature: Chapman and Cowling, The
mathematical theory of non-uniform gases (1970), chapter 5, for spheres.
"""

import math

import numpy as np

from gaspart.theory.enskog import collision_rate
from gaspart.theory.geometry import Numbers, Values, check_ranges, checked_dimension
from gaspart.theory.speeds import maxwell_pdf, mean_speed

_SPEEDS = 160
"""Number of points of the quadrature over speeds."""
_FASTEST = 8.0
"""Highest speed of the quadrature in thermal speeds. A fraction of less than exp(-32) of the particles is
faster.
"""


@check_ranges
def collision_rate_at_speed(
    speed: Numbers,
    packing_fraction: float,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
) -> Values:
    """Compute the number of collisions per time of a particle at a given speed [1/time]. nu(v) is
    `collision_rate` times u divided by the mean relative speed of all pairs. Here u is the mean relative
    speed between a particle of speed v and partners with Maxwellian velocities. Let the unit of speed be
    sqrt(2 k_B T / m), and c the speed v in this unit. Then u = exp(-c^2) / sqrt(pi) + (c + 1 / (2 c)) erf(c)
    in 3D. In 2D, u is the mean of Rice's distribution, sqrt(pi)/2 exp(-c^2 / 2) [(1 + c^2) I_0(c^2 / 2) + c^2
    I_1(c^2 / 2)]. The formula is exact in equilibrium at zero density. At higher density it is multiplied by
    chi, as in Enskog theory.
    """
    from scipy.special import erf, ive

    gas = {"diameter": diameter, "temperature": temperature, "mass": mass}
    thermal = math.sqrt(2.0 * temperature / mass)
    c = np.abs(np.asarray(speed, dtype=float)) / thermal
    if checked_dimension(dimension) == 3:
        slow = np.maximum(c, 1e-4)  # (c + 1 / 2c) erf(c) -> 1 / sqrt(pi)
        relative = np.exp(-(slow**2)) / math.sqrt(math.pi) + (slow + 0.5 / slow) * erf(slow)
    else:
        x = 0.5 * c**2  # ive(n, x) = exp(-x) I_n(x)
        relative = 0.5 * math.sqrt(math.pi) * ((1.0 + 2.0 * x) * ive(0, x) + 2.0 * x * ive(1, x))
    mean = math.sqrt(2.0) * mean_speed(dimension, temperature, mass) / thermal
    return collision_rate(packing_fraction, dimension, **gas) * relative / mean


@check_ranges
def free_time_pdf(
    time: Numbers,
    packing_fraction: float,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
) -> Values:
    """Compute the probability density of the time between two collisions of a particle [1/time]. The density
    is int f nu(v)^2 exp(-nu(v) t) dv / nu, where f is Maxwell's distribution of speeds and nu(v) is
    `collision_rate_at_speed`. The density decreases more slowly than an exponential, because slow particles
    collide less often. The integral is computed by Gauss-Legendre quadrature to 1e-9. Consecutive collisions
    are assumed to be independent. At a packing fraction of 0.05 the shortest flights are 2 % less frequent.
    """
    gas = {"diameter": diameter, "temperature": temperature, "mass": mass}
    points, weights = np.polynomial.legendre.leggauss(_SPEEDS)
    fastest = _FASTEST * math.sqrt(temperature / mass)
    speeds, weights = 0.5 * fastest * (points + 1.0), 0.5 * fastest * weights
    rates = collision_rate_at_speed(speeds, packing_fraction, dimension, **gas)
    weights = weights * maxwell_pdf(speeds, dimension, temperature, mass) * rates**2
    times = np.asarray(time, dtype=float)
    decay = np.exp(-rates * times[..., None])
    return decay @ weights / collision_rate(packing_fraction, dimension, **gas)
