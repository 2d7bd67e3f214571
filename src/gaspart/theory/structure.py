"""Structure of the fluid of spheres: pair distribution and structure factor.

The theories are the Percus-Yevick equation and the correction of Verlet and Weis. Lengths are in diameters
and wave numbers in inverse diameters. Packing fractions eta are numbers. For discs no such closed form
exists, because the Percus-Yevick equation has a closed solution in odd dimensions only.
"""

from functools import cache

import numpy as np

from gaspart.theory.equations import METASTABLE_SPHERES, carnahan_starling
from gaspart.theory.geometry import Numbers, Values, check_ranges, checked_packing_fraction

_NODES = 64  # on a circle around each zero; radius: `_PART` times the distance to the nearest zero
_PART = 0.35
_FURTHEST = 5
"""Largest distance, in diameters, at which g(r) is computed. Beyond it, the terms grow exponentially and
cancel.
"""
_SMALL = 1e-3  # wave number below which a quotient of small numbers is replaced by its limit


@check_ranges
def percus_yevick_structure_factor(wave_number: Numbers, packing_fraction: float) -> Values:
    """Compute S(k) of spheres from the Percus-Yevick equation. S(k) = 1 / (1 - rho c(k)). The direct
    correlation function is -(a + b r + a eta r^3 / 2) inside the diameter and 0 outside, with a = (1 + 2
    eta)^2 / (1 - eta)^4, b = -6 eta (1 + eta / 2)^2 / (1 - eta)^4 (M. S. Wertheim, Phys. Rev. Lett. 10, 321
    (1963)) (E. Thiele, J. Chem. Phys. 39, 474 (1963)). The integral is computed by Gauss-Legendre quadrature,
    exact to rounding up to k = 100.
    """
    eta = float(checked_packing_fraction(packing_fraction, METASTABLE_SPHERES))
    k = np.asarray(wave_number, dtype=float)
    nodes, weights = np.polynomial.legendre.leggauss(80)
    r = 0.5 * (nodes + 1.0)
    a = (1.0 + 2.0 * eta) ** 2 / (1.0 - eta) ** 4
    b = -6.0 * eta * (1.0 + 0.5 * eta) ** 2 / (1.0 - eta) ** 4
    inside = a + b * r + 0.5 * a * eta * r**3
    integral = np.sinc(k[..., None] * r / np.pi) @ (0.5 * weights * r**2 * inside)
    return 1.0 / (1.0 + 24.0 * eta * integral)


@check_ranges
def percus_yevick_rdf(distance: Numbers, packing_fraction: float) -> Values:
    """Compute g(r) of spheres from the Percus-Yevick equation, up to 5 diameters. Pair distribution g(r),
    which is 0 inside the diameter: r g(r) is the inverse of Wertheim's Laplace transform (M. S. Wertheim,
    Phys. Rev. Lett. 10, 321 (1963)). With L = (1 + eta / 2) t + 1 + 2 eta and S = (1 - eta)^2 t^3 + 6 eta (1
    - eta) t^2 + 18 eta^2 t - 12 eta (1 + 2 eta), it is a sum over n < r. The terms are the residues of (-12
    eta)^(n-1) t (L / S)^n e^{t (r - n)} at the three zeros of S. The residues are computed together, as an
    integral over circles around all three zeros.
    """
    eta = float(checked_packing_fraction(packing_fraction, METASTABLE_SPHERES))
    r = np.asarray(distance, dtype=float)
    if np.any(r > _FURTHEST):
        raise ValueError(f"distance: {np.max(r):g} (this formula is computed up to {_FURTHEST} diameters)")
    t, parts, ratio = _circles(eta)
    total = np.zeros(r.shape)
    for shell in range(1, _FURTHEST + 1):
        beyond = r >= shell
        if not beyond.any():
            break
        factor = (-12.0 * eta) ** (shell - 1) * t * parts * ratio**shell
        total[beyond] += (np.exp(np.multiply.outer(r[beyond] - shell, t)) @ factor).real
    return np.divide(total, r, out=np.zeros(r.shape), where=r >= 1.0)[()]


@cache
def _circles(eta: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return nodes (n,) on circles around the zeros of S, their weights for integrals over 2 pi i,
    and L / S.
    """
    linear = 6.0 * eta * (1.0 - eta)
    cubic = np.array([(1.0 - eta) ** 2, linear, 18.0 * eta**2, -12.0 * eta * (1.0 + 2.0 * eta)])
    zeros = np.roots(cubic)
    apart = np.abs(zeros[:, None] - zeros)[~np.eye(3, dtype=bool)].reshape(3, 2).min(axis=1)
    steps = np.exp(2j * np.pi * (np.arange(_NODES) + 0.5) / _NODES)
    circles = _PART * apart[:, None] * steps
    t = (zeros[:, None] + circles).ravel()
    return t, circles.ravel() / _NODES, ((1.0 + 0.5 * eta) * t + 1.0 + 2.0 * eta) / np.polyval(cubic, t)


_RARE = 1e-5
"""Packing fraction below which the term that Verlet and Weis add, of order eta^2, is lost in rounding."""


@cache
def _verlet_weis(eta: float) -> tuple[float, float, float, float]:
    """Return the parameters of the g(r) of Verlet and Weis at a packing fraction.

    The parameters are the packing fraction and the diameter of the Percus-Yevick fluid, and the amplitude and
    the inverse range of the term that is added to its g(r). With this amplitude and range, the contact value
    and the compressibility are equal to Carnahan and Starling's. S(0) is 1 + 24 eta times the integral of r^2
    (g
    - 1), to which the added term contributes 12 eta A / mu.
    """
    effective = eta - eta**2 / 16.0
    diameter = (effective / eta) ** (1.0 / 3.0)
    if eta < _RARE:
        return effective, diameter, 0.0, 1.0
    contact = (carnahan_starling(eta) - 1.0) / (4.0 * eta)
    amplitude = float(contact - percus_yevick_rdf(1.0 / diameter, effective))
    inverse = (1.0 + 4.0 * eta + 4.0 * eta**2 - 4.0 * eta**3 + eta**4) / (1.0 - eta) ** 4
    lacking = 1.0 / inverse - float(percus_yevick_structure_factor(0.0, effective))
    lacking += float(_overlapping(np.zeros(()), eta, effective, diameter))
    return effective, diameter, amplitude, 12.0 * eta * amplitude / lacking


def _overlapping(k: np.ndarray, eta: float, effective: float, diameter: float) -> np.ndarray:
    """Return the contribution to S(k) of pairs between the smaller diameter and 1."""
    nodes, weights = np.polynomial.legendre.leggauss(12)
    r = 0.5 * (1.0 - diameter) * (nodes + 1.0) + diameter
    g = percus_yevick_rdf(r / diameter, effective)
    parts = 0.5 * (1.0 - diameter) * weights * r**2 * g
    return 24.0 * eta * np.sinc(k[..., None] * r / np.pi) @ parts


@check_ranges
def verlet_weis_rdf(distance: Numbers, packing_fraction: float) -> Values:
    """Compute g(r) of spheres by the theory of Verlet and Weis.

    Pair distribution g(r), which is 0 inside the diameter: g(r) is the Percus-Yevick function at the packing
    fraction eta - eta^2 / 16, with the corresponding smaller diameter, plus A / r exp(-mu (r - 1)) cos(mu (r
    - 1)) beyond contact (L. Verlet and J.-J. Weis, Phys. Rev. A 5, 939 (1972)). A and mu do not come from
    fitted formulas. They follow from the conditions that the contact value and the compressibility are equal
    to Carnahan and Starling's (as in a public program for integral equations).

    Parameters
    ----------
    distance : array_like, [diameter]
        Distances r, at most 4.9.
    packing_fraction : float, [1]
        Packing fraction eta, above 0 and at most 0.539.
    """
    effective, diameter, amplitude, rate = _of(packing_fraction)
    r = np.asarray(distance, dtype=float)
    beyond = np.maximum(r, 1.0)
    added = amplitude / beyond * np.exp(-rate * (beyond - 1.0)) * np.cos(rate * (beyond - 1.0))
    return np.where(r >= 1.0, percus_yevick_rdf(r / diameter, effective) + added, 0.0)[()]


@check_ranges
def verlet_weis_structure_factor(wave_number: Numbers, packing_fraction: float) -> Values:
    """Compute S(k) of spheres by the theory of Verlet and Weis.

    S(k) that corresponds to `verlet_weis_rdf`. The Fourier transform of `verlet_weis_rdf` is a closed form,
    except for pairs closer than a diameter, whose contribution is subtracted by numerical integration.

    Parameters
    ----------
    packing_fraction : float, [1]
        Packing fraction eta, above 0 and at most 0.539.
    """
    eta = float(packing_fraction)
    effective, diameter, amplitude, rate = _of(eta)
    k = np.asarray(wave_number, dtype=float)
    safe = np.maximum(k, _SMALL)
    # integral of e^{-mu x} cos(mu x) e^{i k x} from 0
    wave = 0.5 / (rate * (1.0 - 1j) - 1j * safe) + 0.5 / (rate * (1.0 + 1j) - 1j * safe)
    added = 24.0 * eta * amplitude * (np.exp(1j * safe) * wave).imag / safe
    overlap = _overlapping(k, eta, effective, diameter)
    return percus_yevick_structure_factor(k * diameter, effective) - overlap + added


def _of(packing_fraction: float) -> tuple[float, float, float, float]:
    """Return `_verlet_weis` for a packing fraction within the range; raise an error otherwise."""
    eta = float(checked_packing_fraction(packing_fraction, METASTABLE_SPHERES))
    if eta <= 0.0:
        raise ValueError(f"packing_fraction: {eta:g} (must be above 0)")
    return _verlet_weis(eta)
