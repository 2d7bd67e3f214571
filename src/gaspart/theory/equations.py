"""Equations of state by name: Z = P / (rho k_B T) against packing fraction.

Every function returns the dimensionless compressibility factor Z with the shape of `packing_fraction`, and
raises SceneError, a ValueError, outside its range. The module `state` defines the reference equation.
"""

import numpy as np

from gaspart.theory.geometry import Numbers, Values, checked_dimension, checked_packing_fraction

STABLE_DISCS = 0.70
"""Highest packing fraction of the disc fluid, from Bernard and Krauth (2011), see `freezing`."""
METASTABLE_SPHERES = 0.539
"""Packing fraction at rho sigma^3 = 1.03, the highest density of the data behind `kolafa_labik_malijevsky`.
"""

_KLM = np.zeros(23)
_KLM[:9] = 1.0, 4.0, 6.0, 2.3647684, -0.8698551, 1.1062803, -1.1014221, 0.66605866, -0.03633431
_KLM[[10, 14, 22]] = -0.20965164, 0.10555569, -0.00872380


def van_der_waals(packing_fraction: Numbers, dimension: int) -> Values:
    """Compute Z of discs or spheres from the excluded volume alone, without attraction.

    Z = 1 / (1 - b_2 eta), from the equation P = N k_B T / (V - N b) that source A proposes, with b = B2. The
    equation is exact only to first order in eta: its coefficient b_3 is b_2^2, which is 28 % too high in 2D
    and 60 % too high in 3D. Its pressure diverges far below close packing. In one dimension the equation is
    exact.

    Parameters
    ----------
    packing_fraction : array_like, [1]
        Packing fraction eta, from 0 to the divergence at 1/2 (discs) or 1/4 (spheres).
    """
    second = 2.0 ** (checked_dimension(dimension) - 1)
    return 1.0 / (1.0 - second * checked_packing_fraction(packing_fraction, np.nextafter(1.0 / second, 0.0)))


def carnahan_starling(packing_fraction: Numbers) -> Values:
    """Compute Z of spheres by Carnahan and Starling's equation.

    Z = (1 + eta + eta^2 - eta^3) / (1 - eta)^3 (N. F. Carnahan and K. E. Starling (1969)). Z is 0.13 % too
    low at eta = 0.2, and 0.27 % too low at 0.3 to 0.4. So the equation is accurate enough for a figure, but
    not for a test at 0.1 %.

    Parameters
    ----------
    packing_fraction : array_like, [1]
        Packing fraction eta, from 0 to 0.539, the density rho sigma^3 = 1.03.
    """
    eta = checked_packing_fraction(packing_fraction, METASTABLE_SPHERES)
    return (1.0 + eta + eta**2 - eta**3) / (1.0 - eta) ** 3


def kolafa_1986(packing_fraction: Numbers) -> Values:
    """Compute Z of spheres by Kolafa's equation of 1986.

    Z = [1 + eta + eta^2 - 2 eta^3 (1 + eta) / 3] / (1 - eta)^3 (J. Kolafa (1986)). The equation is within 0.1
    % of the reference (tested).

    Parameters
    ----------
    packing_fraction : array_like, [1]
        Packing fraction eta, from 0 to 0.539, the density rho sigma^3 = 1.03.
    """
    eta = checked_packing_fraction(packing_fraction, METASTABLE_SPHERES)
    return (1.0 + eta + eta**2 - 2.0 / 3.0 * eta**3 * (1.0 + eta)) / (1.0 - eta) ** 3


def kolafa_labik_malijevsky(packing_fraction: Numbers) -> Values:
    """Compute Z of spheres by the equation of Kolafa, Labik and Malijevsky.

    The equation is a polynomial in x = eta / (1 - eta), fitted to simulations and to B2 ... B6 (J. Kolafa, S.
    Labik and A. Malijevsky, Phys. Chem. Chem. Phys. 6, 2335 (2004)). The data are at rho sigma^3 = 0.20 to
    1.03 and have a relative error below 4e-5 with 95 % confidence (literature: abstract of the article). A
    public program for Enskog theory uses the same coefficients. A test shows that the coefficients reproduce
    B4, B5 and B6.

    Parameters
    ----------
    packing_fraction : array_like, [1]
        Packing fraction eta, from 0 to 0.539, the density rho sigma^3 = 1.03.
    """
    eta = checked_packing_fraction(packing_fraction, METASTABLE_SPHERES)
    return np.polynomial.polynomial.polyval(eta / (1.0 - eta), _KLM)


def henderson(packing_fraction: Numbers) -> Values:
    """Compute Z of discs by Henderson's equation.

    Z = (1 + eta^2 / 8) / (1 - eta)^2 (D. Henderson (1975)), copied from SklogWiki. Compared with the
    reference, Z is 0.5 % too high at eta = 0.5, 1 % at 0.6 and 2.5 % at 0.7.
    """
    eta = checked_packing_fraction(packing_fraction, STABLE_DISCS)
    return (1.0 + eta**2 / 8.0) / (1.0 - eta) ** 2


def liu(packing_fraction: Numbers) -> Values:
    """Compute Z of the stable fluid of discs by Liu's equation.

    Z = (1 + eta^2/8 + eta^3/18 - 4 eta^4/21) / (1 - eta)^2 (H. Liu, Mol. Phys. (2021)) (literature through
    SklogWiki, which prints eta^4/18). The term eta^3/18 agrees with the virial series and with the tabulated
    values (tested). The equation is within 3e-4 of the virial reference up to eta = 0.4, and within 1e-3 up
    to 0.7.
    """
    eta = checked_packing_fraction(packing_fraction, STABLE_DISCS)
    return (1.0 + eta**2 / 8.0 + eta**3 / 18.0 - 4.0 / 21.0 * eta**4) / (1.0 - eta) ** 2
