"""Theory of an infinite gas of equal particles, for the equation that an engine solves.

The equation is named as in `Engine.equation`: "exact" is the dynamics of particles that collide when they
touch, "boltzmann" is the equation of a gas of point particles, and "enskog" is a model of collisions at a
distance of one diameter. In this model, collisions occur at a rate proportional to the contact value of the
engine, and correlations between collisions are neglected. Each function takes a `Gas` and an equation, and
returns NaN if the value is unknown.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from gaspart import theory
from gaspart.scene.facts import Gas
from gaspart.theory.diffusion import ERPENBECK_WOOD_HIGHEST, viscosity_ratio
from gaspart.theory.discretisation import contact_values

EXACT, BOLTZMANN, ENSKOG = "exact", "boltzmann", "enskog"


def contact_value(gas: Gas, equation: str) -> float:
    """Return the contact value of the pair distribution that determines the collision rate."""
    if equation == BOLTZMANN:
        return 1.0
    if equation == ENSKOG:
        density = theory.number_density(gas.packing_fraction, gas.dimension, gas.diameter)
        radius = np.array([0.5 * gas.diameter])
        return float(contact_values(np.atleast_1d(density), radius, gas.dimension)[0, 0])
    return float(theory.contact_value(gas.packing_fraction, gas.dimension))


def excess(gas: Gas, equation: str) -> float:
    """Compute Z - 1, the excess compressibility factor."""
    if equation == BOLTZMANN:
        return 0.0
    return 2.0 ** (gas.dimension - 1) * gas.packing_fraction * contact_value(gas, equation)


def compressibility_factor(gas: Gas, equation: str) -> float:
    """Compute the compressibility factor Z."""
    return 1.0 + excess(gas, equation)


def collision_rate(gas: Gas, equation: str) -> float:
    """Compute the number of collisions of a particle per time."""
    return float(theory.collision_rate(**gas.parameters, contact=contact_value(gas, equation)))


def diffusion(gas: Gas, equation: str) -> float:
    """Compute the coefficient of self-diffusion of spheres (Erpenbeck and Wood, or of the kinetic equation);
    NaN for discs.
    """
    if gas.dimension == 2 or (equation == EXACT and not _fluid(gas)):
        return math.nan
    value = float(theory.enskog_diffusion(**gas.parameters, contact=contact_value(gas, equation)))
    return value * (float(theory.erpenbeck_wood_ratio(gas.packing_fraction)) if equation == EXACT else 1.0)


def shear_viscosity(gas: Gas, equation: str) -> float:
    """Compute the shear viscosity; for spheres, Enskog's value times the ratio measured in dense gases."""
    value = float(theory.enskog_viscosity(**_enskog_arguments(gas, equation)))
    if equation == EXACT and gas.dimension == 3:
        return value * float(viscosity_ratio(gas.packing_fraction)) if _fluid(gas) else math.nan
    return value


def bulk_viscosity(gas: Gas, equation: str) -> float:
    """Compute Enskog's bulk viscosity; 0 for point particles."""
    return float(theory.enskog_bulk_viscosity(**_enskog_arguments(gas, equation)))


def thermal_conductivity(gas: Gas, equation: str) -> float:
    """Compute the thermal conductivity by the theory of Chapman and Enskog, or of Enskog."""
    return float(theory.enskog_conductivity(**_enskog_arguments(gas, equation)))


def chemical_potential(gas: Gas, equation: str) -> float:
    """Compute the excess chemical potential divided by k_B T."""
    if equation != EXACT:
        return 0.0 if equation == BOLTZMANN else math.nan
    return float(theory.excess_chemical_potential(gas.packing_fraction, gas.dimension))


def _fluid(gas: Gas) -> bool:
    """Return True if the density is in the range of the transport data for spheres."""
    return gas.packing_fraction <= ERPENBECK_WOOD_HIGHEST


def _enskog_arguments(gas: Gas, equation: str) -> dict[str, Any]:
    """Return the arguments of Enskog's coefficients; those of point particles do not depend on the
    density.
    """
    if equation == BOLTZMANN:
        return {**gas.parameters, "packing_fraction": 0.0, "contact": 1.0}
    return {**gas.parameters, "contact": contact_value(gas, equation)}


# Difference between a finite periodic gas and an infinite gas, to first order in 1/N.
#
# Each function takes a `Gas` of at least two particles. It returns the relative difference and an exponent p:
# a difference that is smaller by a factor f needs f^p times as many particles. p is 1 for a difference
# proportional to 1/N.


def finite_compressibility_factor(gas: Gas) -> tuple[float, float]:
    """Compute the relative difference of Z between N and infinitely many particles."""
    fraction, dimension = gas.packing_fraction, gas.dimension
    shift = theory.finite_size_correction(fraction, dimension, gas.count, ensemble="canonical")
    return float(shift / theory.compressibility_factor(fraction, dimension)), 1.0


def finite_collision_rate(gas: Gas) -> tuple[float, float]:
    """Compute the relative difference of the collision rate between N and infinitely many particles."""
    factor = theory.collision_rate_finite_size_factor(gas.packing_fraction, gas.dimension, gas.count)
    return float(factor) - 1.0, 1.0


def finite_diffusion(gas: Gas) -> tuple[float, float]:
    """Compute the relative difference of D between a finite and an infinite container (Yeh and Hummer)."""
    fraction, dimension = gas.packing_fraction, gas.dimension
    side = (gas.count * theory.particle_volume(dimension) / fraction) ** (1.0 / dimension)
    value = float(theory.enskog_diffusion(fraction, dimension))
    carried = float(theory.number_density(fraction, dimension)) * value  # modes decay as nu + D
    viscosity = float(theory.enskog_viscosity(fraction, dimension) * viscosity_ratio(fraction))
    lost = theory.yeh_hummer(side, viscosity + carried)
    return -float(lost) / value, float(dimension)
