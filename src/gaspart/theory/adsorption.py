"""Gases at walls that hold particles: a step well, a hard layer in it, and the flux from a wall.

Energies are in k_B T unless a temperature is among the arguments. A well of width w holds a particle whose
centre is within w of the lowest position that it can reach.
"""

import numpy as np

from gaspart.theory._arguments import Numbers, Values, checked, checked_packing_fraction
from gaspart.theory.equations import STABLE_DISCS
from gaspart.theory.geometry import particle_volume
from gaspart.theory.potential import packing_fraction_at

_EXACT = np.sqrt(0.75)
"""Height above a layer of spheres of diameter 1 from which on a point is near one of them at most."""


@checked
def well_ratio(depth: Numbers, width: Numbers, outside: Numbers) -> Values:
    """N_ads / N_gas = (w / outside) e^{depth / k_B T} of an ideal gas in equilibrium (exact).

    `outside`: the volume that centres can reach outside the well, over its area. Langmuir's formula
    N_ads / N_gas = (A lambda / V) e^{depth / k_B T} (Frederickx and Meerts 2010, section 4.5) with the width
    of the well where the thermal wavelength lambda is there.
    """
    return width / outside * np.exp(depth)


@checked
def excess_in_well(held: Numbers, free: Numbers, diameter: float, width: float, outside: float) -> Values:
    """ln of N_ads / N_gas of spheres over that of an ideal gas, to first order in the densities.

    held, free: number densities in the well and outside, both of uniform thickness, `width` and `outside`,
    of at least a diameter. A sphere's ball of radius sigma, 4 pi sigma^3 / 3, is closed to other centres;
    beyond a plane at a random distance within a layer of thickness t lies pi sigma^4 / (4 t) of it (exact).
    """
    ball, beyond = particle_volume(3, 2.0 * diameter), 0.25 * np.pi * diameter**4
    in_well = held * (ball - 2.0 * beyond / width) + free * beyond / width
    in_gas = free * (ball - 2.0 * beyond / outside) + held * beyond / outside
    return in_gas - in_well


@checked
def length_in_langmuirs_formula(ratio: Numbers, depth: Numbers, outside: Numbers) -> Values:
    """The length in the place of lambda in N_ads / N_gas = (A lambda / V) e^{depth / k_B T} (identity)."""
    return ratio * outside * np.exp(-np.asarray(depth, dtype=float))


@checked
def planck_constant(length: Numbers, mass: Numbers, temperature: Numbers) -> Values:
    """h for which `length` is the thermal wavelength: length sqrt(2 pi m k_B T) (definition)."""
    return length * np.sqrt(2.0 * np.pi * mass * np.asarray(temperature, dtype=float))


def scaled_particle_activity(packing_fraction: Numbers) -> Values:
    """Discs: eta / (1 - eta) exp[(3 eta - 2 eta^2) / (1 - eta)^2], scaled-particle theory.

    It is z w e^{depth / k_B T} pi sigma^2 / 4 of a layer of coverage eta whose gas has the activity z. From
    Z = 1 / (1 - eta)^2 (Helfand, Frisch and Lebowitz, J. Chem. Phys. 34, 1037 (1961); tested to the
    second order).
    """
    eta = checked_packing_fraction(packing_fraction, STABLE_DISCS)
    return eta / (1.0 - eta) * np.exp((3.0 * eta - 2.0 * eta**2) / (1.0 - eta) ** 2)


def layer_diameter(width: Numbers) -> Values:
    """Diameter of the hard discs that spheres of diameter 1 are in a layer of this width, sqrt(1 - w^2 / 6).

    The centres' heights are uniform and independent, so their difference has the mean square w^2 / 6 (to
    first order in w^2, where neighbours touch).
    """
    return np.sqrt(1.0 - np.asarray(width, dtype=float) ** 2 / 6.0)


def excluded_in_front(packing_fraction: float, width: float) -> float:
    """The volume in front of a layer that each further sphere, of diameter 1, closes to the gas's centres.

    Of a single sphere it is the part of its ball of radius 1 that lies in front of the layer, 2 pi / 3 where
    that is thin; of more it is less, since their balls overlap. At the height h above the layer's middle a
    sphere of the gas needs a circle without discs of the radius R = sqrt(1 - h^2): its probability is exact
    up to R = 1/2, and scaled-particle theory's beyond (Helfand, Frisch and Lebowitz, J. Chem. Phys. 34, 1037
    (1961)); the volume is the derivative of what is closed with respect to the number of discs. Raises
    SceneError beyond the stable discs.
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
    """The activity of the hard discs that spheres of diameter 1 are in a well of this width.

    activity: beta P w e^{depth / k_B T} pi / 4 of the gas, whose pressure P is the density at contact with a
    hard wall; it is right for a single sphere in a thin well. To first order in the gas's density: a sphere
    closes less of the gas's room where others do so already, see `excluded_in_front`.
    """
    gained = 2.0 * np.pi / 3.0 - excluded_in_front(packing_fraction, width)
    return activity * layer_diameter(width) ** 2 * np.exp(gas_density * gained)


def excess_of_few(activity: float, held: float, others: float) -> float:
    """By what part a layer of hard discs holds more, on average, than one in equilibrium with a large gas.

    The gas with which it exchanges has on average `others` particles, and its activity goes down with each
    that the layer gains. To the first order beyond Gaussian fluctuations, with the cumulants kappa_n of the
    number of discs under a large gas, whose mean is `held`, that is (kappa_2 - kappa_3) / (2 (others +
    kappa_2)) discs; kappa_2 = S held, kappa_3 = (S^2 + S') held, S = d ln eta / d ln z, S' = dS / d ln z.
    An ideal layer has no such excess (exact: the number is binomial).
    """
    step = 0.05
    lower, middle, upper = np.log(
        packing_fraction_at(activity * np.exp(step * np.array([-1.0, 0.0, 1.0])), 2)
    )
    slope, bend = (upper - lower) / (2.0 * step), (upper - 2.0 * middle + lower) / step**2
    return float((slope * (1.0 - slope) - bend) / (2.0 * (others + slope * held)))


@checked
def langmuir_coverage(activity: Numbers) -> Values:
    """K / (1 + K): places that each hold one particle (Langmuir, J. Am. Chem. Soc. 40, 1361
    (1918))."""
    activity = np.asarray(activity, dtype=float)
    return activity / (1.0 + activity)


@checked
def flux_density(speed: Numbers) -> Values:
    """Density of the normal speeds, in units of sqrt(k_B T / m), with which particles leave a wall in
    equilibrium: v e^{-v^2 / 2} (exact)."""
    speed = np.asarray(speed, dtype=float)
    return speed * np.exp(-0.5 * speed**2)


@checked
def slow_flux_share(speed: Numbers) -> Values:
    """Share of those particles that leave more slowly than this: 1 - e^{-v^2 / 2} (exact)."""
    return -np.expm1(-0.5 * np.asarray(speed, dtype=float) ** 2)
