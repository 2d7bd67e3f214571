"""Difference between a finite gas in a periodic container and an infinite one, to first order.

Each function takes a `Gas` of two particles or more. It returns the relative difference, and the power with
which the number of particles grows for a smaller one: 1 for a difference in proportion to 1/N.
"""

from __future__ import annotations

from gaspart import theory
from gaspart.scene.gas import Gas


def compressibility_factor(gas: Gas) -> tuple[float, float]:
    """Compute the relative difference of Z at fixed energy."""
    fraction, dimension = gas.packing_fraction, gas.dimension
    shift = theory.finite_size_correction(fraction, dimension, gas.count, ensemble="canonical")
    return float(shift / theory.compressibility_factor(fraction, dimension)), 1.0


def collision_rate(gas: Gas) -> tuple[float, float]:
    """Compute the relative difference of the collisions of a particle per time at fixed energy."""
    factor = theory.collision_rate_finite_size_factor(gas.packing_fraction, gas.dimension, gas.count)
    return float(factor) - 1.0, 1.0


def diffusion(gas: Gas) -> tuple[float, float]:
    """Compute the relative difference of D, by Yeh and Hummer's shift.

    The shift is proportional to one over the side.
    """
    fraction, dimension = gas.packing_fraction, gas.dimension
    side = (gas.count * theory.particle_volume(dimension) / fraction) ** (1.0 / dimension)
    value = float(theory.enskog_diffusion(fraction, dimension))
    carried = float(theory.number_density(fraction, dimension)) * value  # modes decay with nu + D
    viscosity = float(theory.enskog_viscosity(fraction, dimension) * theory.viscosity_ratio(fraction))
    lost = theory.yeh_hummer(side, viscosity + carried)
    return -float(lost) / value, float(dimension)
