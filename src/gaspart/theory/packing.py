"""Saturation of random sequential insertion, and the probability that an attempt fails.

Particles of diameter sigma are placed one after another at uniformly random positions. A particle stays if it
overlaps with no other.
"""

from __future__ import annotations

import math

import numpy as np

from gaspart.scene.sizes import CLOSE_PACKING
from gaspart.theory.geometry import (
    Numbers,
    Values,
    check_ranges,
    checked_dimension,
    checked_packing_fraction,
    packing_fraction,
)

RSA_SATURATION = {2: 0.547074, 3: 0.384131}
"""Packing fraction at which no further particle fits, in an infinite container (Zhang, Torquato 2013, as
quoted by public programs: 0.5470735 and 0.3841307).
"""
RSA_SATURATION_UNCERTAINTY = {2: 3e-6, 3: 3e-6}
"""Standard uncertainty of `RSA_SATURATION`, a few units of the last digit. It was not verified; it is a
hundredth of the uncertainty of measurements with this program.
"""

# Excess at hard walls, in diameters per side: the saturation is multiplied by (1 + c sigma / L)^d for centres
# in [0, L]^d. Computed from fits to insertions until saturation at L/sigma = 4 ... 24 (3D) and 100 (2D).
_WALL_EXCESS = {2: 0.75, 3: 0.64}
_WALL_EXCESS_UNCERTAINTY = {2: 0.04, 3: 0.005}

# Second-order coefficient of the available fraction, (2^d)^2 / 2 - (3/2) b_3, from exp(-mu_excess / k_B T) to
# order eta^2.
_AVAILABLE_SECOND = {2: 6.0 * math.sqrt(3.0) / math.pi, 3: 17.0}


def _shape_factor(excess: float, dimension: int, side_over_diameter: float, boundary: str) -> float:
    """Return the ratio of saturations with and without walls, for a wall excess in diameters."""
    if boundary == "centres_to_walls":
        return (1.0 + excess / side_over_diameter) ** dimension
    if boundary == "wall":
        # Centres can move over L - sigma; the packing fraction refers to the volume L^d.
        return ((side_over_diameter - 1.0 + excess) / side_over_diameter) ** dimension
    raise ValueError(f"boundary: {boundary!r} (must be 'periodic', 'wall' or 'centres_to_walls')")


@check_ranges
def insertion_saturation(
    dimension: int, side_over_diameter: float | None = None, boundary: str = "periodic"
) -> float:
    """Compute the packing fraction at which no further particle fits into a square or cube.

    - "periodic": the infinite value eta_s of `RSA_SATURATION` for every L; the actual values fluctuate about
      it.
    - "centres_to_walls": the convention of source A. Centres are in [0, L]^d and the complete volume of the
      particles counts, so the value is eta_s (1 + c sigma / L)^d. Computed: c = 0.64 in 3D for L / sigma >=
      4, and c = 0.75 in 2D for L / sigma about 100.
    - "wall": particles are completely inside. The number of particles is the same as for centres in a side of
      L - sigma, so the packing fraction is below the infinite value.

    See also `insertion_saturation_uncertainty`.

    Parameters
    ----------
    side_over_diameter : float, optional, [1]
        Side L of the container divided by the diameter sigma, at least 1. Default: an infinite container.
    boundary : {"periodic", "wall", "centres_to_walls"}, default "periodic"
        Faces of the container, and what they stop: surfaces ("wall") or centres ("centres_to_walls") of
        particles.
    """
    infinite = RSA_SATURATION[checked_dimension(dimension)]
    if side_over_diameter is None or boundary == "periodic":
        return infinite
    return infinite * _shape_factor(_WALL_EXCESS[dimension], dimension, side_over_diameter, boundary)


@check_ranges
def insertion_saturation_uncertainty(
    dimension: int, side_over_diameter: float | None = None, boundary: str = "periodic"
) -> float:
    """Compute the standard uncertainty of `insertion_saturation`, from the literature's value and the wall
    excess.
    """
    relative = RSA_SATURATION_UNCERTAINTY[checked_dimension(dimension)] / RSA_SATURATION[dimension]
    value = insertion_saturation(dimension, side_over_diameter, boundary)
    if side_over_diameter is None or boundary == "periodic":
        return value * relative
    excess, spread = _WALL_EXCESS[dimension], _WALL_EXCESS_UNCERTAINTY[dimension]
    more = _shape_factor(excess + spread, dimension, side_over_diameter, boundary)
    less = _shape_factor(excess - spread, dimension, side_over_diameter, boundary)
    return math.hypot(value * relative, 0.5 * (more - less) * RSA_SATURATION[dimension])


def available_fraction(packing_fraction: Numbers, dimension: int) -> Values:
    """Compute the probability that a random attempt to insert a particle succeeds. 1 - 2^d eta + c_2 eta^2,
    with c_2 = 6 sqrt 3 / pi (2D) or 17 (3D). It is exact to order eta^2, up to which random insertion and
    equilibrium agree (B. Widom (1966); P. Schaaf and J. Talbot (1989)). So c_2 follows from B2 and B3
    (tested). The accuracy is about 1 % up to eta = 0.05 in 3D and 0.1 in 2D.
    """
    first = 2.0 ** checked_dimension(dimension)
    second = _AVAILABLE_SECOND[dimension]
    eta = checked_packing_fraction(packing_fraction, 0.5 * first / second)
    return 1.0 - first * eta + second * eta**2


def failures_per_particle(packing_fraction: Numbers, dimension: int) -> Values:
    """Compute the mean number of failed attempts before a particle is placed.

    1 / `available_fraction` - 1, which is 2^d eta at low density (exact).

    Parameters
    ----------
    packing_fraction : array_like, [1]
        Packing fraction eta, in the range of `available_fraction`.
    """
    available = available_fraction(packing_fraction, dimension)
    return (1.0 - available) / np.asarray(available)


# Freezing of hard discs and spheres, and the pressure of their crystals.
#
# Units: diameter 1 and k_B T = 1; number densities in 1 / sigma^d, pressures in k_B T / sigma^d.


COEXISTENCE_PRESSURE = {2: 9.185, 3: 11.5727}
"""Pressure P sigma^d / k_B T at which the fluid and the ordered phase of an infinite system coexist.

Discs (liquid and hexatic): Bernard and Krauth, Phys. Rev. Lett. 107, 155704 (2011); Engel and others, Phys.
Rev. E 87, 042134 (2013), where it is written as beta P (2 sigma)^2 with the radius sigma. The equal-area
construction for their pressures of 1024^2 discs (`theory.literature`) gives 9.1850. Spheres (fluid and
face-centred cubic): 11.5727(10), Fernandez and others, Phys. Rev. Lett. 108, 165701 (2012), abstract. Equal
pressures and chemical potentials of etomica's equations give 11.5681; etomica fitted them to simulations of
the fluid and of a crystal without vacancies.
"""
COEXISTENCE_DENSITY = {2: (0.700 * 4.0 / np.pi, 0.716 * 4.0 / np.pi), 3: (0.939, 1.0375)}
"""Number densities of the freezing fluid and of the melting ordered phase; the sources are the same as above.
"""
CRYSTAL_OF_1024_DISCS = (0.725, 9.382, 0.024)
"""Packing fraction, pressure and uncertainty of the pressure for a crystal of 1024 discs, in a periodic
container with a side ratio of 1 to sqrt(3) / 2: P V_0 / N k_B T = 8.125(21), Zollweg and Chester, Phys. Rev.
B 46, 11186 (1992), figure 1, as digitised in jellyfysh/HistoricDisks.
"""
ETOMICA_CRYSTAL_UNCERTAINTY = 1.6e-5
"""Relative uncertainty of `etomica_crystal` above 0.527: its largest difference from ten runs of DynamO."""
_ETOMICA = [-0.4338711486444215, 0.390812049911003, 0.595451683236023, 18.59059648880398, -288.1675745716088]
_ETOMICA += [3206.943027086472, -21037.60905875148, 83177.92071175583, -180636.8017944632, 170205.791013758]
LOWEST_CRYSTAL = {2: 0.70, 3: 0.49}
"""Packing fraction below which the equations of crystals are not plotted, because crystals do not persist
there.
"""


def coexistence_packing_fractions(dimension: int) -> np.ndarray:
    """Compute the packing fractions of the coexisting fluid and ordered phase.

    The values come from `COEXISTENCE_DENSITY`, which has the sources.

    Returns
    -------
    ndarray, shape (2,), [1]
        Packing fractions of the freezing fluid and of the melting ordered phase.
    """
    return packing_fraction(np.array(COEXISTENCE_DENSITY[checked_dimension(dimension)]), dimension)


def _expansion(eta: Numbers, dimension: int) -> np.ndarray:
    """Return alpha = V / V_closest - 1, after checking the range."""
    eta = np.asarray(eta, dtype=float)
    if not np.all((eta >= LOWEST_CRYSTAL[dimension]) & (eta < CLOSE_PACKING[dimension])):
        low, high = LOWEST_CRYSTAL[dimension], CLOSE_PACKING[dimension]
        raise ValueError(f"packing_fraction: {eta} (this formula holds from {low} to {high:.4f})")
    return CLOSE_PACKING[dimension] / eta - 1.0


def etomica_crystal(packing_fraction: Numbers) -> Values:
    """Compute Z of the face-centred cubic crystal of spheres without vacancies, from etomica's fit.

    Z = 3/x + c_0 + c_1 x + ... + c_9 x^9 with x = 1 - eta / eta_c. etomica fitted the coefficients to
    simulations of its authors above 0.524 (github.com/etomica/etomica, HardSphereSolid.java, commit b6fc002).
    From 0.527 to 0.545 the difference from runs of DynamO with 1.1e6 spheres is at most
    `ETOMICA_CRYSTAL_UNCERTAINTY`; the errors of these runs are 3 to 6e-6 (`literature`, tested). Speedy's
    equation is lower than these runs by 2 to 5e-4.

    Parameters
    ----------
    packing_fraction : array_like, [1]
        Packing fraction eta, from 0.49 (`LOWEST_CRYSTAL`) to below close packing, 0.7405.
    """
    x = 1.0 - 1.0 / (1.0 + _expansion(packing_fraction, 3))
    return 3.0 / x + np.polynomial.polynomial.polyval(x, _ETOMICA)


def alder_hoover_young_crystal(packing_fraction: Numbers, dimension: int) -> Values:
    """Compute Z of a crystal from its free-volume limit and fitted corrections.

    Z = d/alpha + a_0 + a_1 alpha + ... with alpha = V / V_c - 1 (B. J. Alder, W. G. Hoover and D. A. Young,
    J. Chem. Phys. 49, 3688 (1968)). Discs on the triangular lattice: 2/alpha + 1.90(1) + 0.67(7) alpha (by
    SklogWiki) + 1.5 alpha^2 (not verified; 0.4 % below `CRYSTAL_OF_1024_DISCS`, 1.2 % without this term).
    Spheres, face-centred cubic: 3/alpha + 2.566 + 0.55 alpha (2.56 and 0.56 by SklogWiki) - 1.19 alpha^2 +
    5.95 alpha^3 (not verified; within 0.15 % of Speedy's fit). The free-volume term is exact at close
    packing. The fits are accurate to about 0.3 %. The equation is only plotted; no claim depends on it.

    Parameters
    ----------
    packing_fraction : array_like, [1]
        Packing fraction eta, from 0.70 for discs, 0.49 for spheres (`LOWEST_CRYSTAL`), to below close
        packing.
    """
    alpha = _expansion(packing_fraction, checked_dimension(dimension))
    series = {2: (1.90, 0.67, 1.5), 3: (2.566, 0.55, -1.19, 5.95)}[dimension]
    return dimension / alpha + np.polynomial.polynomial.polyval(alpha, series)


@check_ranges
def crystal_finite_size_correction(compressibility_factor: Values, count: Values) -> Values:
    """Compute the difference in Z between a finite periodic crystal and the infinite crystal.

    Z_N - Z_infinity: -(Z - 1) / N, for a crystal whose centre of mass is free. The centre of mass can move in
    the complete volume V, and the other N - 1 particles in their free volumes: Q_N ~ V v_f^(N-1), so Z_N =
    1/N + (1 - 1/N) Z. The formula is exact at close packing. At lower density there are further, unknown
    terms of order 1/N, about V / V_c - 1 times as large.

    Parameters
    ----------
    compressibility_factor : float or ndarray, [1]
        Z of the infinite crystal.
    """
    return -(compressibility_factor - 1.0) / count
