"""Gases at walls that bind particles: step well, layer of hard spheres, flux from a wall.

Energies are in k_B T unless a temperature is among the arguments. The potential of a step well is constant
within the width w. A particle is in the well if its centre is less than w above the lowest position that it
can reach.
"""

import numpy as np

from gaspart.theory.equations import STABLE_DISCS
from gaspart.theory.geometry import Numbers, Values, check_ranges, checked_packing_fraction, particle_volume
from gaspart.theory.tables import packing_fraction_at

_EXACT = np.sqrt(0.75)
"""Height above a layer of spheres of diameter 1. Any higher point is within one diameter of at most one
centre in the layer.
"""


@check_ranges
def well_ratio(depth: Numbers, width: Numbers, outside: Numbers) -> Values:
    """Compute N_ads / N_gas of an ideal gas in equilibrium with a step well."""
    return width / outside * np.exp(depth)


@check_ranges
def excess_in_well(held: Numbers, free: Numbers, diameter: float, width: float, outside: float) -> Values:
    """Compute ln of the ratio N_ads / N_gas of spheres, relative to an ideal gas."""
    ball, beyond = particle_volume(3, 2.0 * diameter), 0.25 * np.pi * diameter**4
    in_well = held * (ball - 2.0 * beyond / width) + free * beyond / width
    in_gas = free * (ball - 2.0 * beyond / outside) + held * beyond / outside
    return in_gas - in_well


@check_ranges
def length_in_langmuirs_formula(ratio: Numbers, depth: Numbers, outside: Numbers) -> Values:
    """Compute the length that replaces lambda in Langmuir's formula, from a ratio N_ads / N_gas."""
    return ratio * outside * np.exp(-np.asarray(depth, dtype=float))


@check_ranges
def planck_constant(length: Numbers, mass: Numbers, temperature: Numbers) -> Values:
    """Compute Planck's constant h for which a given length is the thermal wavelength."""
    return length * np.sqrt(2.0 * np.pi * mass * np.asarray(temperature, dtype=float))


def scaled_particle_activity(packing_fraction: Numbers) -> Values:
    """Compute the activity of hard discs by scaled-particle theory."""
    eta = checked_packing_fraction(packing_fraction, STABLE_DISCS)
    return eta / (1.0 - eta) * np.exp((3.0 * eta - 2.0 * eta**2) / (1.0 - eta) ** 2)


def layer_diameter(width: Numbers) -> Values:
    """Compute the diameter of the hard discs that represent spheres in a layer."""
    return np.sqrt(1.0 - np.asarray(width, dtype=float) ** 2 / 6.0)


def excluded_in_front(packing_fraction: float, width: float) -> float:
    """Compute the gas volume that a sphere in a layer excludes in front of the layer.

    Each further sphere of diameter 1 in the layer excludes the centres of gas spheres from this additional
    volume.
    """
    eta = float(checked_packing_fraction(packing_fraction, STABLE_DISCS))
    nodes, weights = np.polynomial.legendre.leggauss(32)
    total = 0.0
    for low, high in ((0.5 * width, _EXACT), (_EXACT, 1.0)):
        height = 0.5 * (low + high) + 0.5 * (high - low) * nodes
        radius = np.sqrt(1.0 - height**2)
        closed = 4.0 * radius**2
        if low < _EXACT:
            x, free = 2.0 * radius - 1.0, 1.0 - eta
            work = -np.log(free) + 2.0 * eta * x / free + eta * x**2 / free**2
            slope = 1.0 / free + 2.0 * x / free**2 + (1.0 + eta) * x**2 / free**3
            closed = np.exp(-work) * slope
        total += 0.5 * (high - low) * float(weights @ closed)
    return 0.25 * np.pi * total


def layer_activity(activity: Numbers, packing_fraction: float, gas_density: float, width: float) -> Values:
    """Compute the activity of the hard discs that represent spheres in a well."""
    gained = 2.0 * np.pi / 3.0 - excluded_in_front(packing_fraction, width)
    return activity * layer_diameter(width) ** 2 * np.exp(gas_density * gained)


def excess_of_few(activity: float, held: float, others: float) -> float:
    """Compute the relative excess of discs in a layer next to a small gas."""
    step = 0.05
    lower, middle, upper = np.log(
        packing_fraction_at(activity * np.exp(step * np.array([-1.0, 0.0, 1.0])), 2)
    )
    slope, bend = (upper - lower) / (2.0 * step), (upper - 2.0 * middle + lower) / step**2
    return float((slope * (1.0 - slope) - bend) / (2.0 * (others + slope * held)))


@check_ranges
def langmuir_coverage(activity: Numbers) -> Values:
    """Compute the coverage of independent adsorption sites by Langmuir's isotherm."""
    activity = np.asarray(activity, dtype=float)
    return activity / (1.0 + activity)


@check_ranges
def flux_density(speed: Numbers) -> Values:
    """Compute the probability density of the normal speeds of particles that leave a wall."""
    speed = np.asarray(speed, dtype=float)
    return speed * np.exp(-0.5 * speed**2)


@check_ranges
def slow_flux_share(speed: Numbers) -> Values:
    """Compute the fraction of particles that leave a wall with less than a normal speed."""
    return -np.expm1(-0.5 * np.asarray(speed, dtype=float) ** 2)
