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
    """Compute N_ads / N_gas of an ideal gas in equilibrium with a step well.

    Parameters
    ----------
    depth : array_like, [1]
        Depth of the well in k_B T.
    width : float or ndarray, [length]
        Width w of the well.
    outside : float or ndarray, [length]
        Volume that centres can reach outside the well, divided by its area.

    Returns
    -------
    float or ndarray, [1]
        Number N_ads of particles in the well divided by the number N_gas outside.

    Raises
    ------
    SceneError
        If an argument is out of range.

    Notes
    -----
    The ratio is (w / outside) e^{depth / k_B T} (exact). Langmuir's formula is N_ads / N_gas = (A lambda / V)
    e^{depth / k_B T} [1]_. Here the width of the well replaces the thermal wavelength lambda.

    References
    ----------
    .. [1] R. Frederickx and P. Meerts (2010), section 4.5.

    Examples
    --------
    >>> from gaspart.theory.adsorption import well_ratio
    >>> round(float(well_ratio(depth=3.0, width=0.1, outside=10.0)), 4)
    0.2009
    """
    return width / outside * np.exp(depth)


@check_ranges
def excess_in_well(held: Numbers, free: Numbers, diameter: float, width: float, outside: float) -> Values:
    """Compute ln of the ratio N_ads / N_gas of spheres, relative to an ideal gas.

    Parameters
    ----------
    held : float or ndarray, [1/length^3]
        Number density of the spheres in the well.
    free : float or ndarray, [1/length^3]
        Number density of the spheres outside the well.
    diameter : float, [length]
        Diameter sigma of a sphere.
    width : float, [length]
        Uniform thickness of the well, at least a diameter.
    outside : float, [length]
        Uniform thickness of the space outside the well, at least a diameter.

    Returns
    -------
    float or ndarray, [1]
        Logarithm of the ratio, to first order in the densities.

    Raises
    ------
    SceneError
        If an argument is out of range.

    Notes
    -----
    A sphere excludes other centres from a ball of radius sigma and volume 4 pi sigma^3 / 3. Consider a sphere
    at a random position in a layer of thickness t. The mean volume of the part of its ball beyond one surface
    of the layer is pi sigma^4 / (4 t) (exact).
    """
    ball, beyond = particle_volume(3, 2.0 * diameter), 0.25 * np.pi * diameter**4
    in_well = held * (ball - 2.0 * beyond / width) + free * beyond / width
    in_gas = free * (ball - 2.0 * beyond / outside) + held * beyond / outside
    return in_gas - in_well


@check_ranges
def length_in_langmuirs_formula(ratio: Numbers, depth: Numbers, outside: Numbers) -> Values:
    """Compute the length that replaces lambda in Langmuir's formula, from a ratio N_ads / N_gas.

    Parameters
    ----------
    ratio : float or ndarray, [1]
        Ratio N_ads / N_gas.
    depth : array_like, [1]
        Depth of the well in k_B T.
    outside : float or ndarray, [length]
        Volume V that centres can reach outside the well, divided by its area A.

    Returns
    -------
    float or ndarray, [length]
        Length lambda in N_ads / N_gas = (A lambda / V) e^{depth / k_B T} (identity).

    Raises
    ------
    SceneError
        If an argument is out of range.
    """
    return ratio * outside * np.exp(-np.asarray(depth, dtype=float))


@check_ranges
def planck_constant(length: Numbers, mass: Numbers, temperature: Numbers) -> Values:
    """Compute Planck's constant h for which a given length is the thermal wavelength.

    Parameters
    ----------
    length : float or ndarray, [length]
        Thermal wavelength.
    mass : float or ndarray, [mass]
        Mass m of a particle.
    temperature : array_like, [energy]
        Temperature times k_B.

    Returns
    -------
    float or ndarray, [energy time]
        Planck's constant h = length sqrt(2 pi m k_B T) (definition).

    Raises
    ------
    SceneError
        If an argument is out of range.
    """
    return length * np.sqrt(2.0 * np.pi * mass * np.asarray(temperature, dtype=float))


def scaled_particle_activity(packing_fraction: Numbers) -> Values:
    """Compute the activity of hard discs by scaled-particle theory.

    Parameters
    ----------
    packing_fraction : array_like, [1]
        Packing fraction eta (coverage) of the discs, from 0 to 0.70.

    Returns
    -------
    ndarray, same shape as `packing_fraction`, [1]
        Dimensionless activity z w e^{depth / k_B T} pi sigma^2 / 4 of a layer of coverage eta in equilibrium
        with a gas of activity z.

    Raises
    ------
    SceneError
        If an argument is out of range.

    Notes
    -----
    The activity is eta / (1 - eta) exp[(3 eta - 2 eta^2) / (1 - eta)^2]. It follows from Z = 1 / (1 - eta)^2
    [1]_ (tested to the second order).

    References
    ----------
    .. [1] E. Helfand, H. L. Frisch and J. L. Lebowitz, J. Chem. Phys. 34, 1037 (1961).

    Examples
    --------
    >>> from gaspart.theory.adsorption import scaled_particle_activity
    >>> round(float(scaled_particle_activity(0.3)), 4)
    1.8628
    """
    eta = checked_packing_fraction(packing_fraction, STABLE_DISCS)
    return eta / (1.0 - eta) * np.exp((3.0 * eta - 2.0 * eta**2) / (1.0 - eta) ** 2)


def layer_diameter(width: Numbers) -> Values:
    """Compute the diameter of the hard discs that represent spheres in a layer.

    Parameters
    ----------
    width : array_like, [1]
        Width w of the layer, in diameters of the spheres.

    Returns
    -------
    ndarray, same shape as `width`, [1]
        Diameter of the discs, in diameters of the spheres.

    Notes
    -----
    The diameter is sqrt(1 - w^2 / 6). The heights of the centres are uniform and independent, so the mean
    square of the difference of two heights is w^2 / 6. The formula is correct to first order in w^2 for
    neighbours in contact.
    """
    return np.sqrt(1.0 - np.asarray(width, dtype=float) ** 2 / 6.0)


def excluded_in_front(packing_fraction: float, width: float) -> float:
    """Compute the gas volume that a sphere in a layer excludes in front of the layer.

    Each further sphere of diameter 1 in the layer excludes the centres of gas spheres from this additional
    volume.

    Parameters
    ----------
    packing_fraction : float, [1]
        Coverage eta of the layer, from 0 to 0.70, the limit of the stable disc fluid.
    width : float, [1]
        Width of the layer, in diameters of the spheres.

    Returns
    -------
    float, [1]
        Excluded volume per additional sphere, divided by the cube of the diameter.

    Raises
    ------
    SceneError
        If the coverage is above the limit of the stable disc fluid.

    Notes
    -----
    For a single sphere, the volume is the part of its exclusion ball of radius 1 in front of the layer: 2 pi
    / 3 if the layer is thin. For more spheres it is smaller, because their balls overlap. The layer is
    described by discs in its middle plane. At a height h above this plane, a sphere of the gas fits only if a
    circle of radius R = sqrt(1 - h^2) below it contains no disc centre. The probability of an empty circle is
    exact up to R = 1/2. For larger R it follows from scaled-particle theory [1]_. The result is the
    derivative of the total excluded volume with respect to the number of discs.

    References
    ----------
    .. [1] E. Helfand, H. L. Frisch and J. L. Lebowitz, J. Chem. Phys. 34, 1037 (1961).
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
    """Compute the activity of the hard discs that represent spheres in a well.

    Parameters
    ----------
    activity : float or ndarray, [1]
        Activity beta P w e^{depth / k_B T} pi / 4, where P is the pressure of the gas. The density of the gas
        at contact with a hard wall is beta P.
    packing_fraction : float, [1]
        Coverage eta of the layer, from 0 to 0.70.
    gas_density : float or ndarray, [1]
        Number density of the gas times the cube of the diameter of the spheres.
    width : float, [1]
        Width w of the well, in diameters of the spheres.

    Returns
    -------
    float or ndarray, [1]
        Activity of the discs.

    Raises
    ------
    SceneError
        If an argument is out of range.

    Notes
    -----
    The argument `activity` is correct for a single sphere in a thin well. The function corrects it to first
    order in the density of the gas. Reason: a sphere excludes less additional volume in front of the layer if
    other spheres already exclude a part of this volume, see `excluded_in_front`.
    """
    gained = 2.0 * np.pi / 3.0 - excluded_in_front(packing_fraction, width)
    return activity * layer_diameter(width) ** 2 * np.exp(gas_density * gained)


def excess_of_few(activity: float, held: float, others: float) -> float:
    """Compute the relative excess of discs in a layer next to a small gas.

    Parameters
    ----------
    activity : float, [1]
        Activity of the discs.
    held : float
        Mean number of discs in the layer in equilibrium with an infinite gas.
    others : float
        Mean number of particles in the gas that exchanges with the layer.

    Returns
    -------
    float, [1]
        Mean excess of the number of discs, divided by the number in equilibrium with an infinite gas.

    Notes
    -----
    The activity of the gas decreases with each particle that the layer gains. To first order beyond Gaussian
    fluctuations, the excess is (kappa_2 - kappa_3) / (2 (others + kappa_2)) discs. In equilibrium with an
    infinite gas, the cumulants of the number of discs are kappa_2 = S held and kappa_3 = (S^2 + S') held,
    with S = d ln eta / d ln z and S' = dS / d ln z. An ideal layer has no such excess. This is exact, because
    the number of particles in it is binomially distributed.
    """
    step = 0.05
    lower, middle, upper = np.log(
        packing_fraction_at(activity * np.exp(step * np.array([-1.0, 0.0, 1.0])), 2)
    )
    slope, bend = (upper - lower) / (2.0 * step), (upper - 2.0 * middle + lower) / step**2
    return float((slope * (1.0 - slope) - bend) / (2.0 * (others + slope * held)))


@check_ranges
def langmuir_coverage(activity: Numbers) -> Values:
    """Compute the coverage of independent adsorption sites by Langmuir's isotherm.

    Parameters
    ----------
    activity : array_like, [1]
        Product K of the equilibrium constant and the pressure.

    Returns
    -------
    float or ndarray, same shape as `activity`, [1]
        Fraction K / (1 + K) of occupied sites; each site can hold one particle.

    Raises
    ------
    SceneError
        If an argument is out of range.

    References
    ----------
    .. [1] I. Langmuir, J. Am. Chem. Soc. 40, 1361 (1918).
    """
    activity = np.asarray(activity, dtype=float)
    return activity / (1.0 + activity)


@check_ranges
def flux_density(speed: Numbers) -> Values:
    """Compute the probability density of the normal speeds of particles that leave a wall.

    Parameters
    ----------
    speed : array_like, [1]
        Normal speed v in units of sqrt(k_B T / m).

    Returns
    -------
    float or ndarray, same shape as `speed`, [1]
        Probability density v e^{-v^2 / 2} in equilibrium (exact).

    Raises
    ------
    SceneError
        If an argument is out of range.
    """
    speed = np.asarray(speed, dtype=float)
    return speed * np.exp(-0.5 * speed**2)


@check_ranges
def slow_flux_share(speed: Numbers) -> Values:
    """Compute the fraction of particles that leave a wall with less than a normal speed.

    Parameters
    ----------
    speed : array_like, [1]
        Normal speed v in units of sqrt(k_B T / m).

    Returns
    -------
    float or ndarray, same shape as `speed`, [1]
        Fraction 1 - e^{-v^2 / 2} in equilibrium (exact).

    Raises
    ------
    SceneError
        If an argument is out of range.
    """
    return -np.expm1(-0.5 * np.asarray(speed, dtype=float) ** 2)
