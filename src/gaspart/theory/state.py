"""Reference equation of state: value, uncertainty, and shift in a finite system.

The equation of discs is the virial series to B10 with a linear tail. The equation of spheres is Kolafa, Labik
and Malijevsky's. Only the fluid branch is included. All quantities are dimensionless and depend only on the
packing fraction.
"""

import numpy as np

from gaspart.theory.equations import METASTABLE_SPHERES, STABLE_DISCS, kolafa_labik_malijevsky, liu
from gaspart.theory.geometry import Numbers, Values, check_ranges, checked_dimension, checked_packing_fraction
from gaspart.theory.virial import (
    HIGHEST_ORDER,
    linear_tail,
    linear_tail_uncertainty,
    partial_sum,
    partial_sum_uncertainty,
)

HIGHEST_PACKING_FRACTION = {2: STABLE_DISCS, 3: METASTABLE_SPHERES}
"""Largest packing fraction of the reference: the limit of the liquid in 2D, and the end of the data in 3D
(metastable above 0.4915).
"""

# Relative standard uncertainty of the equation of spheres, up to each packing fraction. It is the largest
# difference from the independent equation that etomica fitted to its authors' simulations
# (github.com/etomica/etomica, HardSphereFluid.java, commit 6c23860). 193 runs of DynamO with up to 2e6
# spheres, up to 0.471, agree with it (tested).
_SPHERES_ERROR = np.array([0.445059, 0.523599]), np.array([4.3e-6, 1e-5, 1.1e-4])
# Upper estimate of the error of the series of discs near freezing: 0.140 at eta = 0.67 and 0.267 at 0.68,
# from the pressures of 224 and 870 discs by Li and others, J. Chem. Phys. 157, 234111 (2022), extrapolated in
# 1/N to infinity; and 1.2 at 0.70, from the coexistence pressure.
_NEAR_FREEZING = 0.036, 0.6478, 45
# Step of the central differences in `_slope_and_curvature`: truncation and rounding errors are both below
# 1e-6 of the result.
_STEP = 1e-4
_NODES = 32  # number of nodes of an integral over ln(eta), whose integrand is a polynomial in eta


def virial_with_tail(packing_fraction: Numbers, dimension: int = 2) -> Values:
    """Compute Z by the virial series to B10 plus `virial.linear_tail`: the reference for discs, up to eta =
    0.70.
    """
    eta = checked_packing_fraction(packing_fraction, HIGHEST_PACKING_FRACTION[checked_dimension(dimension)])
    return partial_sum(eta, HIGHEST_ORDER, dimension) + linear_tail(eta, dimension)


def compressibility_factor(packing_fraction: Numbers, dimension: int) -> Values:
    """Compute the compressibility factor of the infinite fluid, by the reference equation.

    Z = P / (rho k_B T). Discs: `virial_with_tail`. Spheres: `kolafa_labik_malijevsky`; states above 0.4915
    are metastable. See also `compressibility_uncertainty` and `finite_contact_value`.
    """
    if checked_dimension(dimension) == 2:
        return virial_with_tail(packing_fraction, 2)
    return kolafa_labik_malijevsky(packing_fraction)


def compressibility_uncertainty(packing_fraction: Numbers, dimension: int) -> Values:
    """Estimate the standard uncertainty of `compressibility_factor`.

    Discs: four contributions are added in quadrature. They are the uncertainties of the coefficients; the
    slope of the tail; the difference from Liu's independent equation, limited to the complete tail, because
    the series is more accurate at low density; and an error that both equations share near freezing, 0.4 % at
    eta = 0.65 and 10 % at 0.70. Spheres: the smaller of two bounds. One is the difference from another
    equation (4.3e-6 of Z up to eta = 0.445, 1e-5 up to 0.524). The other is the difference from the virial
    series to B10 plus its tail and the uncertainties of the coefficients (below 1e-6 for eta < 0.1).
    """
    eta = checked_packing_fraction(packing_fraction, HIGHEST_PACKING_FRACTION[checked_dimension(dimension)])
    coefficients = partial_sum_uncertainty(eta, HIGHEST_ORDER, dimension)
    tail = linear_tail(eta, dimension)
    if dimension == 2:
        between = np.minimum(tail, np.abs(virial_with_tail(eta, 2) - liu(eta)))
        size, where, power = _NEAR_FREEZING
        lacking = size * (eta / where) ** power
        return np.sqrt(coefficients**2 + linear_tail_uncertainty(eta, 2) ** 2 + between**2 + lacking**2)
    reference = kolafa_labik_malijevsky(eta)
    series = np.abs(reference - virial_with_tail(eta, 3)) + tail + coefficients
    ends, errors = _SPHERES_ERROR
    return np.minimum(series, errors[np.searchsorted(ends, eta)] * reference)


def contact_value(packing_fraction: Numbers, dimension: int) -> Values:
    """Compute the pair distribution at contact of the infinite fluid.

    Contact value g(sigma); Enskog theory calls it chi: g(sigma) = (Z - 1) / (2^(d-1) eta) by the virial
    theorem (exact), with Z of `compressibility_factor`. At eta = 0 the value is the limit 1.
    """
    eta = checked_packing_fraction(packing_fraction, HIGHEST_PACKING_FRACTION[checked_dimension(dimension)])
    excess = compressibility_factor(eta, dimension) - 1.0
    first_order = 2.0 ** (dimension - 1) * eta
    # Below 1e-8, Z - 1 is lost in the rounding of Z; g - 1 is less than 3 eta there.
    return np.where(eta > 1e-8, excess / np.where(eta > 1e-8, first_order, 1.0), 1.0)


def _slope_and_curvature(eta: np.ndarray, dimension: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the first and second derivative of eta Z(eta) by (mostly central) differences."""
    centre = np.clip(eta, _STEP, HIGHEST_PACKING_FRACTION[dimension] - _STEP)
    low, mid, high = (
        (centre + shift) * compressibility_factor(centre + shift, dimension) for shift in (-_STEP, 0.0, _STEP)
    )
    return (high - low) / (2.0 * _STEP), (high - 2.0 * mid + low) / _STEP**2


def reduced_compressibility(packing_fraction: Numbers, dimension: int) -> Values:
    """Compute k_B T d rho / dP of the infinite fluid, its structure factor S(0).

    1 / (d(eta Z) / d eta) (exact), with Z of `compressibility_factor`.
    """
    eta = checked_packing_fraction(packing_fraction, HIGHEST_PACKING_FRACTION[checked_dimension(dimension)])
    return 1.0 / _slope_and_curvature(eta, dimension)[0]


def speed_of_sound(packing_fraction: Numbers, dimension: int) -> Values:
    """Compute the adiabatic speed of sound of the infinite fluid.

    Speed of sound in units of sqrt(k_B T / m): sqrt(d(eta Z)/d eta + 2 Z^2 / d); the heat capacity per
    particle is d/2 (exact).
    """
    eta = checked_packing_fraction(packing_fraction, HIGHEST_PACKING_FRACTION[checked_dimension(dimension)])
    slope, _ = _slope_and_curvature(eta, dimension)
    return np.sqrt(slope + 2.0 / dimension * compressibility_factor(eta, dimension) ** 2)


def adiabatic_temperature(packing_fraction: Numbers, initial: Numbers, dimension: int) -> Values:
    """Compute the temperature after adiabatic compression divided by the initial temperature. exp(2/d times
    the integral of Z over ln eta), because d/2 N k_B dT = -P dV (exact), with Z of `compressibility_factor`.
    """
    highest = HIGHEST_PACKING_FRACTION[checked_dimension(dimension)]
    start = np.log(checked_packing_fraction(initial, highest))
    stop = np.log(checked_packing_fraction(packing_fraction, highest))
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    half = 0.5 * (stop - start)
    eta = np.exp(np.multiply.outer(nodes, half) + 0.5 * (start + stop))
    integral = half * np.tensordot(weights, compressibility_factor(eta, dimension), 1)
    return np.exp(2.0 / dimension * integral)


@check_ranges
def finite_size_correction(
    packing_fraction: Numbers, dimension: int, count: int, ensemble: str = "dynamics"
) -> Values:
    """Compute the difference in Z between a finite periodic system and the infinite system.

    Z_N - Z_infinity, to first order in 1/N. Terms of order 1/N^2 are neglected. Exponentially small terms are
    also neglected; they matter if the side is only a few diameters (`finite_size_remainder`).

    "canonical": in a periodic container the grand partition function is exp(P V / k_B T), up to terms that
    decrease exponentially with the side. For N particles the saddle point gives

        ln Q_N = [P V - N mu] / k_B T - (1/2) ln(2 pi <dN^2>),    <dN^2> = N k_B T / P',   P' = dP / d rho,

    and minus its derivative with respect to V at fixed N, with d rho / dV = - rho / V, is

        P_N = P - k_B T (rho / 2V) P'' / P',    so    Z_N - Z = - (eta / 2N) (eta Z)'' / (eta Z)'   (in eta).

    Checks (tested): to first order in eta the result is -b_2 eta / N, which is exact because only N (N-1) / 2
    pairs exist. For hard rods on a ring it is exact at every density.

    "dynamics": the mean of Z = 1 + sum (dr . dp) / (2 E t), with absolute values. E is the kinetic energy,
    and the total momentum is zero, as in a periodic run. The configurations are distributed as in the
    canonical ensemble. Two particles of a system with zero total momentum have <v_12^2> = 2 <v^2> N / (N-1).
    The collisional virial is proportional to it, because the contact rate and the impulse are both
    proportional to the normal speed. So Z_N - 1 is the canonical value times N / (N-1), and to first order in
    eta there is no correction. If the total momentum is not zero, E is the energy relative to the centre of
    mass.

    Parameters
    ----------
    count : int
        Number N of particles, at least 2.
    ensemble : {"dynamics", "canonical"}, default "dynamics"
        Periodic run at fixed energy with zero total momentum ("dynamics"), or the canonical ensemble.

    Examples
    --------
    >>> from gaspart import theory
    >>> round(float(theory.finite_size_correction(0.3, dimension=3, count=500)), 5)
    0.0036
    >>> round(float(theory.finite_size_correction(0.3, 3, count=500, ensemble="canonical")), 5)
    -0.00238
    """
    if ensemble not in ("canonical", "dynamics"):
        raise ValueError(f"ensemble: {ensemble!r} (must be 'canonical' or 'dynamics')")
    if count < 2:
        raise ValueError(f"count: {count} (must be at least 2)")
    eta = checked_packing_fraction(packing_fraction, HIGHEST_PACKING_FRACTION[checked_dimension(dimension)])
    slope, curvature = _slope_and_curvature(eta, dimension)
    canonical = -0.5 * eta / count * curvature / slope
    if ensemble == "canonical":
        return canonical
    excess = compressibility_factor(eta, dimension) - 1.0
    return (excess + canonical) * count / (count - 1.0) - excess


@check_ranges
def constant_enthalpy_factor(packing_fraction: Numbers, dimension: int, count: Numbers) -> Values:
    """Compute the pressure of N particles under a piston divided by the infinite fluid's.

    P V_0 / (N k_B <T> Z), with V_0 = <V> and Z of the infinite fluid at N / V_0. The ensemble of constant
    pressure and enthalpy (H. C. Andersen, J. Chem. Phys. 72, 2384 (1980)) has the weight Q(V) (H - P V)^(f/2
    - 1), with f degrees of freedom. The mean of the derivative of the weight with respect to V vanishes: <d
    ln Q / dV> = P (f/2 - 1) <1 / (H - P V)>. This is expanded to second order in V - V_0. The variance of V
    is s V_0^2 / N with 1/s = y' + 2 Z^2 / d and y = eta Z(eta). With the canonical correction of Q
    (`finite_size_correction`) and f = d N, the ratio is

        1 + (s / N) [y' / Z + (2 / d) y' - eta y'' Z / (d y')].

    For an ideal gas the factor is 1 + 1/N, which is exact. The formula is of first order in 1/N. The
    temperature is 2 <E> / (d N).
    """
    eta = checked_packing_fraction(packing_fraction, HIGHEST_PACKING_FRACTION[checked_dimension(dimension)])
    slope, curvature = _slope_and_curvature(eta, dimension)
    z = compressibility_factor(eta, dimension)
    variance = speed_of_sound(eta, dimension) ** -2
    bracket = slope / z + 2.0 / dimension * slope - eta * curvature * z / (dimension * slope)
    return 1.0 + variance / np.asarray(count, dtype=float) * bracket
