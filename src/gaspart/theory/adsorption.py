"""Gases at walls that hold particles: a step well, a hard layer in it, and the flux from a wall.

Energies are in k_B T unless a temperature is among the arguments. A well of width w holds a particle whose
centre is within w of the lowest position that it can reach.
"""

import numpy as np

from gaspart.theory._arguments import Numbers, Values, checked, checked_packing_fraction
from gaspart.theory.equations import STABLE_DISCS


@checked
def well_ratio(depth: Numbers, width: Numbers, outside: Numbers) -> Values:
    """N_ads / N_gas = (w / outside) e^{depth / k_B T} of an ideal gas in equilibrium (exact).

    `outside`: the volume that centres can reach outside the well, over its area. Langmuir's formula
    N_ads / N_gas = (A lambda / V) e^{depth / k_B T} (Frederickx and Meerts 2010, section 4.5) with the width
    of the well where the thermal wavelength lambda is there.
    """
    return width / outside * np.exp(depth)


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
