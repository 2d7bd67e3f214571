"""Equations of state by name: compressibility factor Z = P / (rho k_B T) against packing fraction.

All take `packing_fraction` (number or array) and return Z of the same shape, dimensionless.
All raise ValueError outside the stated range. `state` defines which of them is the reference.
"""

import numpy as np

from gaspart.scene.geometry import CLOSE_PACKING
from gaspart.theory._arguments import Numbers, Values, checked_dimension, checked_packing_fraction

STABLE_DISCS = 0.70
"""Highest packing fraction of the disc fluid, by Bernard and Krauth (2011): see `freezing`."""
METASTABLE_SPHERES = 0.539
"""Packing fraction of rho sigma^3 = 1.03, where the data behind `kolafa_labik_malijevsky` end."""

_KLM = np.zeros(23)
_KLM[:9] = 1.0, 4.0, 6.0, 2.3647684, -0.8698551, 1.1062803, -1.1014221, 0.66605866, -0.03633431
_KLM[[10, 14, 22]] = -0.20965164, 0.10555569, -0.00872380


def van_der_waals(packing_fraction: Numbers, dimension: int) -> Values:
    """Z = 1 / (1 - b_2 eta): source A's proposal P = N k_B T / (V - N b), with b = B2.

    Exact to the first order in eta only (its b_3 is b_2^2, 28 % too high in 2D and 60 % in 3D); diverges at
    eta = 1/2 (2D), 1/4 (3D), far below close packing. Exact in one dimension. Range: below the divergence.
    """
    second = 2.0 ** (checked_dimension(dimension) - 1)
    return 1.0 / (1.0 - second * checked_packing_fraction(packing_fraction, np.nextafter(1.0 / second, 0.0)))


def carnahan_starling(packing_fraction: Numbers) -> Values:
    """Spheres: Z = (1 + eta + eta^2 - eta^3) / (1 - eta)^3 (Carnahan and Starling 1969).

    0.13 % low at eta = 0.2, 0.27 % low at 0.3 to 0.4: to be drawn, not to be tested against at 0.1 %.
    """
    eta = checked_packing_fraction(packing_fraction, METASTABLE_SPHERES)
    return (1.0 + eta + eta**2 - eta**3) / (1.0 - eta) ** 3


def kolafa_1986(packing_fraction: Numbers) -> Values:
    """Spheres: Z = [1 + eta + eta^2 - 2 eta^3 (1 + eta) / 3] / (1 - eta)^3 (Kolafa 1986).

    Within 0.1 % of the reference (tested); to be drawn.
    """
    eta = checked_packing_fraction(packing_fraction, METASTABLE_SPHERES)
    return (1.0 + eta + eta**2 - 2.0 / 3.0 * eta**3 * (1.0 + eta)) / (1.0 - eta) ** 3


def kolafa_labik_malijevsky(packing_fraction: Numbers) -> Values:
    """Spheres: a polynomial in x = eta / (1 - eta), fitted to simulations and to B2 ... B6.

    Kolafa, Labik and Malijevsky, Phys. Chem. Chem. Phys. 6, 2335 (2004): data at rho sigma^3 = 0.20 to 1.03
    with a relative error below 4e-5 at 95 % confidence (literature: its abstract). Coefficients: the
    same in a public program of Enskog's theory; that they give B4, B5 and B6 back is tested.
    """
    eta = checked_packing_fraction(packing_fraction, METASTABLE_SPHERES)
    return np.polynomial.polynomial.polyval(eta / (1.0 - eta), _KLM)


def percus_yevick_virial(packing_fraction: Numbers) -> Values:
    """Spheres: Z = (1 + 2 eta + 3 eta^2) / (1 - eta)^2, virial route of Percus-Yevick (exact there)."""
    eta = checked_packing_fraction(packing_fraction, METASTABLE_SPHERES)
    return (1.0 + 2.0 * eta + 3.0 * eta**2) / (1.0 - eta) ** 2


def percus_yevick_compressibility(packing_fraction: Numbers) -> Values:
    """Spheres: Z = (1 + eta + eta^2) / (1 - eta)^3, compressibility route of Percus-Yevick (exact there)."""
    eta = checked_packing_fraction(packing_fraction, METASTABLE_SPHERES)
    return (1.0 + eta + eta**2) / (1.0 - eta) ** 3


def scaled_particle(packing_fraction: Numbers) -> Values:
    """Discs: Z = 1 / (1 - eta)^2, scaled-particle theory (Helfand and others 1961); to 4 %."""
    return 1.0 / (1.0 - checked_packing_fraction(packing_fraction, STABLE_DISCS)) ** 2


def henderson(packing_fraction: Numbers) -> Values:
    """Discs: Z = (1 + eta^2 / 8) / (1 - eta)^2 (Henderson 1975, by SklogWiki).

    Against the reference: 0.5 % high at eta = 0.5, 1 % at 0.6, 2.5 % at 0.7.
    """
    eta = checked_packing_fraction(packing_fraction, STABLE_DISCS)
    return (1.0 + eta**2 / 8.0) / (1.0 - eta) ** 2


def santos_haro_yuste(packing_fraction: Numbers) -> Values:
    """Discs: Z = 1 / [1 - 2 eta + (2 eta_c - 1) eta^2 / eta_c^2], eta_c close packing.

    Santos, Lopez de Haro and Yuste 1995: the simplest that has B2 and a pole at close packing; good to 1.6 %
    up to eta = 0.55.
    """
    eta = checked_packing_fraction(packing_fraction, STABLE_DISCS)
    closest = CLOSE_PACKING[2]
    return 1.0 / (1.0 - 2.0 * eta + (2.0 * closest - 1.0) * (eta / closest) ** 2)


def liu(packing_fraction: Numbers) -> Values:
    """Discs, stable fluid: Z = (1 + eta^2/8 + eta^3/18 - 4 eta^4/21) / (1 - eta)^2 (Liu 2021, Mol. Phys.).

    Literature through SklogWiki, which prints eta^4/18; the power 3 is the one that agrees with the virial
    series and with the tabulated values (tested). Within 3e-4 of the virial reference up to eta = 0.4, 1e-3
    up to 0.7.
    """
    eta = checked_packing_fraction(packing_fraction, STABLE_DISCS)
    return (1.0 + eta**2 / 8.0 + eta**3 / 18.0 - 4.0 / 21.0 * eta**4) / (1.0 - eta) ** 2
