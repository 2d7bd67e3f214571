r"""Contact value of N particles in a periodic container: closed form, table, expansion in 1/N.

The container is a square or a cube.

Consider N equal particles at fixed energy and zero total momentum. All quantities that depend on pairs in
contact follow from one number, the contact value g_N. It is the density of pairs at contact, averaged over
all directions, divided by N (N - 1) / V^2. With k_B T = 2 E / (d (N - 1)), the exact relations are

.. math:: Z_N = 1 + 2^{d-1} \eta \, \frac{N-1}{N} \, g_N, \qquad
          \nu_N = \nu_1 \, \frac{N-1}{N} \, g_N \, f_{d (N-1)},

where nu_1 is `collision_rate` for a contact value of 1, and f is `speeds.mean_speed_factor`. Z_N is the
canonical compressibility factor, which `gaspart.analysis.compressibility_factor` measures.

The expansion in 1/N (`state.finite_size_correction`) neglects terms that decrease exponentially with the side
of the container. These terms arise because the periodic images of a particle order the surrounding fluid. In
dense or small systems they are larger than the terms of the expansion. `finite_size_remainder` estimates
their size from the table.
"""

import math
from functools import cache

import numpy as np

from gaspart.errors import SceneError
from gaspart.theory.geometry import (
    Numbers,
    Values,
    check_ranges,
    checked_dimension,
    checked_packing_fraction,
    particle_volume,
)
from gaspart.theory.state import (
    HIGHEST_PACKING_FRACTION,
    compressibility_factor,
    compressibility_uncertainty,
    finite_size_correction,
)
from gaspart.theory.tables import (
    chemical_potential_uncertainty,
    excess_chemical_potential,
    insertion_finite_size_correction,
    small_systems,
)

_PAIR_HIGHEST = {2: math.pi / 4.0, 3: math.pi / (6.0 * math.sqrt(2.0))}
"""Packing fraction of two particles in a container of side sqrt(2) diameters. Above this packing fraction,
three of the excluded spheres around the periodic images overlap.
"""
_REMAINDER = {2: (14.665, -39.404, 28.652, 2.17, -3.62), 3: (13.094, -46.965, 46.633, 1.953, -3.727)}
"""Coefficients a0, a1, a2, b0, b1 of `finite_size_remainder`, by maximum likelihood. The fit uses the rows of
`data/small_systems.csv` with at least 4 particles and a side of at least 2.2 diameters
(`benchmarks/small_systems.py fit`): 95 rows for discs with deviations up to 3.9 standard deviations, and 66
rows for spheres with deviations up to 3.2.
"""
_SHORTEST = 2.2
"""Side in diameters below which the expansion in 1/N is not used, because a particle interacts with its own
images.
"""
_NODES = 32  # number of nodes of the integral over packing fractions
LARGEST_REMAINDER = 0.1
"""Relative uncertainty above which `finite_contact_value` and `insertion_potential` raise an error."""


@check_ranges
def pair_contact_value(packing_fraction: Numbers, dimension: int) -> Values:
    """Compute the contact value of two particles in a periodic square or cube. Density of pairs at contact,
    averaged over all directions, divided by 2 / V^2. The centre of the second particle can be anywhere
    outside of the spheres of radius sigma around the first particle and its images. So g = V s / (V - v).
    Here v is the volume of these spheres in the container, and s is the fraction of their surface that no
    sphere around another image covers. At L >= 2 sigma the spheres do not overlap, and g = 1 / (1 - 2^(d-1)
    eta).
    """
    d = checked_dimension(dimension)
    eta = checked_packing_fraction(packing_fraction, _PAIR_HIGHEST[d])
    with np.errstate(divide="ignore"):
        half = np.minimum(
            0.5 * (2.0 * particle_volume(d) / eta) ** (1.0 / d), 1.0
        )  # as a fraction of the side, at most sigma
    if d == 2:
        angle = np.arccos(half)
        covered = 4.0 * angle / math.pi
        overlap = 2.0 * (2.0 * angle - np.sin(2.0 * angle)) / math.pi
    else:
        covered = 3.0 * (1.0 - half)
        overlap = 3.0 * (1.0 - half) ** 2 * (2.0 + half) / 2.0
    return (1.0 - covered) / (1.0 - 2.0 ** (d - 1) * eta * (1.0 - overlap))


@check_ranges
def finite_size_remainder(packing_fraction: Numbers, dimension: int, side: Numbers) -> Values:
    """Estimate the relative remainder of a contact value that the expansion in 1/N neglects. The standard
    deviation of the remainder over the contact value is exp(a - b L), with polynomials a of second and ln b
    of first order in eta. Correlations between images at a distance L have the amplitude exp(a) and decay
    with the rate b. The coefficients maximize the likelihood of the differences between the table
    (`small_systems`) and the expansion. The result is infinite below 2.2 diameters.
    """
    eta = checked_packing_fraction(packing_fraction, HIGHEST_PACKING_FRACTION[checked_dimension(dimension)])
    a0, a1, a2, b0, b1 = _REMAINDER[dimension]
    lengths = np.asarray(side, dtype=float)
    remainder = np.exp(a0 + eta * (a1 + eta * a2) - np.exp(b0 + b1 * eta) * lengths)
    return np.where(lengths < _SHORTEST, math.inf, remainder)


@check_ranges
def finite_contact_value(
    packing_fraction: float, dimension: int, count: int, side: float | None = None
) -> tuple[float, float]:
    """Compute the contact value of N particles in a periodic container, and its uncertainty.

    For two particles in a square or cube, the closed form is used (`pair_contact_value`). For the particle
    numbers in the table (`small_systems`), the ratio of the tabulated value to the expansion is interpolated
    linearly in eta. The uncertainty of the ratio is the difference from an interpolation by a parabola. In
    all other cases, and also if its uncertainty is smaller, the expansion in 1/N is used
    (`finite_size_correction`). The uncertainty of the expansion combines the uncertainty of the equation of
    state, `finite_size_remainder`, and the square of the relative correction for the next order in 1/N.

    Parameters
    ----------
    packing_fraction : float, [1]
        Packing fraction eta within the range of `compressibility_factor`.
    count : int
        Number of particles, at least 2.
    side : float, [1], optional
        Shortest side of the container, in diameters. Default: the side of a square or cube.

    Returns
    -------
    value : float, [1]
        Density of pairs at contact divided by N (N - 1) / V^2.
    uncertainty : float, [1]
        Standard uncertainty of the value.

    Examples
    --------
    >>> from gaspart import theory
    >>> value, uncertainty = theory.finite_contact_value(0.3, 3, count=500)
    >>> round(value, 3), uncertainty < 0.001
    (2.49, True)
    """
    eta = float(
        checked_packing_fraction(packing_fraction, HIGHEST_PACKING_FRACTION[checked_dimension(dimension)])
    )
    if count < 2:
        raise SceneError("count", count, "must be at least 2: a particle alone meets no other one")
    cube = (count * particle_volume(dimension) / max(eta, 1e-12)) ** (1.0 / dimension)
    side = cube if side is None else side
    choices = [_expansion(eta, dimension, count, side)]
    if abs(side - cube) < 1e-6 * cube:
        if count == 2 and eta <= _PAIR_HIGHEST[dimension]:
            return float(pair_contact_value(eta, dimension)), 0.0
        choices += _interpolate_table(eta, dimension, count)
    value, uncertainty = min(choices, key=lambda choice: choice[1] / choice[0])
    _require_small(uncertainty, value, side)
    return value, uncertainty


@check_ranges
def insertion_potential(
    packing_fraction: float, dimension: int, count: int, side: float
) -> tuple[float, float]:
    """Compute -ln P; P is the probability that a further particle fits at a random position. The result is
    the sum of `excess_chemical_potential` and `insertion_finite_size_correction`. The uncertainty combines
    both terms of this remainder, the uncertainty of the equation of state, and the square of the relative
    correction. For a single particle the result is exact: it excludes the fraction 2^d eta of the container.
    """
    d = checked_dimension(dimension)
    eta = float(checked_packing_fraction(packing_fraction, HIGHEST_PACKING_FRACTION[d]))
    if count == 1 and side >= 2.0:
        return -math.log1p(-(2.0**d) * eta), 0.0
    value = float(excess_chemical_potential(eta, d))
    shift = float(insertion_finite_size_correction(eta, d, count))
    fractions = eta * np.linspace(0.0, 1.0, _NODES + 1)[1:]
    sides = side * (eta / fractions) ** (1.0 / d)
    remainders = finite_size_remainder(fractions, d, sides) * (compressibility_factor(fractions, d) - 1.0)
    remainder = float(remainders[-1] + (remainders / fractions).sum() * eta / _NODES)
    bulk_uncertainty = float(chemical_potential_uncertainty(eta, d))
    uncertainty = math.hypot(bulk_uncertainty, remainder, shift**2 / value if value else 0.0)
    _require_small(uncertainty, value + shift, side)
    return value + shift, uncertainty


def _require_small(uncertainty: float, value: float, side: float) -> None:
    """Raise SceneError for an uncertainty above `LARGEST_REMAINDER` times the value."""
    if not uncertainty <= LARGEST_REMAINDER * value:
        rule = (
            f"in a container of {side:.3g} diameters the expansion in 1/N is uncertain by "
            f"{100.0 * uncertainty / value:.2g} %: nothing is stated above {100.0 * LARGEST_REMAINDER:g} %"
        )
        raise SceneError("side", side, rule)


def _expansion(eta: float, dimension: int, count: int, side: float) -> tuple[float, float]:
    """Return the contact value to first order in 1/N, and its uncertainty."""
    eta = max(eta, 1e-6)  # limit of the ratio, where the excess itself vanishes
    excess = float(compressibility_factor(eta, dimension)) - 1.0
    shift = float(finite_size_correction(eta, dimension, count))
    value = (excess + shift) / (2.0 ** (dimension - 1) * eta)
    relative = (
        float(compressibility_uncertainty(eta, dimension)) / excess,
        float(finite_size_remainder(eta, dimension, side)),
        (shift / excess) ** 2,
    )
    return value, value * math.hypot(*relative)


def _interpolate_table(eta: float, dimension: int, count: int) -> list[tuple[float, float]]:
    """Interpolate the contact value and its uncertainty between rows; empty if eta is outside of
    their range.
    """
    fractions, factors, errors = _factors(dimension, count)
    if len(fractions) < 3 or eta > fractions[-1]:
        return []
    nearest = np.sort(np.argsort(np.abs(fractions - eta))[:3])
    factor = float(np.interp(eta, fractions, factors))
    parabola = float(np.polyval(np.polyfit(fractions[nearest], factors[nearest], 2), eta))
    error = math.hypot(float(np.interp(eta, fractions, errors)), parabola - factor)
    value = _expansion(eta, dimension, count, 1.0)[0]
    return [(value * factor, abs(value) * error)]


@cache
def _factors(dimension: int, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return packing fractions and ratios, with errors, of tabulated contact values to the expansion; first
    the limit 1.
    """
    rows = small_systems("contact_value", dimension)
    rows = np.sort(rows[rows.count == count], order="packing_fraction")
    expansion = np.array(
        [_expansion(float(eta), dimension, count, 1.0)[0] for eta in rows["packing_fraction"]]
    )
    fractions = np.append(0.0, rows["packing_fraction"])
    return fractions, np.append(1.0, rows["value"] / expansion), np.append(0.0, rows["error"] / expansion)
