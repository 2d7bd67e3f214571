"""Tables of measured values, by this program and by other programs."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

from gaspart.errors import SceneError
from gaspart.theory.geometry import Numbers, Values, check_ranges, checked_dimension, checked_packing_fraction
from gaspart.theory.state import (
    HIGHEST_PACKING_FRACTION,
    compressibility_factor,
    compressibility_uncertainty,
    contact_value,
    reduced_compressibility,
)


def literature(quantity: str, dimension: int) -> np.recarray:
    """Return published values of hard discs and spheres that other programs measured.

    One row per value. The fields are attributes of the array: `packing_fraction`; `count`, the number of
    particles; `container`, periodic: "cube", "square", or the sides of a triangular lattice such as "29 x 30"
    discs; `value` and its standard `error`, with diameter = mass = k_B T = 1; `source`. No value is corrected
    for the number of particles. The provenance of all values is in `data/README.md`. See also `measurements`.

    Parameters
    ----------
    quantity : str
        For spheres "Z", "Z_crystal" (face-centred cubic), "diffusion", "viscosity" or "conductivity". For
        discs "pressure", from the liquid to the hexatic phase.

    Examples
    --------
    >>> from gaspart import theory
    >>> rows = theory.literature("Z", 3)
    >>> len(rows), int(rows.count.max())
    (193, 2125764)
    """
    return _of("literature", quantity, dimension)


def measurements(quantity: str, dimension: int) -> np.recarray:
    """Return values of hard discs and spheres measured by this program, for citation.

    One row per value, with the fields and units of `literature`. `source` is the figure of the reproduction.
    All values are for fluids. "Z" and "contact_value" are for the infinite system; the finite-size effect is
    subtracted to first order in 1/N. "viscosity", "bulk_viscosity" and "conductivity" are Green-Kubo
    integrals up to 16 collisions of a particle (30 in dense gases). "diffusion" is N / (N - 1) times the
    diffusion coefficient of particles with zero total momentum. The last four quantities are for `count`
    particles. For discs they grow with the logarithm of time and of the container. `data/README.md` states
    the commit and the command that made the table.

    Parameters
    ----------
    quantity : {"Z", "contact_value", "viscosity", "bulk_viscosity", "conductivity", "diffusion"}
        Quantity; "diffusion" exists for spheres only.

    Examples
    --------
    >>> from gaspart import theory
    >>> rows = theory.measurements("Z", 3)
    >>> rows.dtype.names
    ('dimension', 'quantity', 'packing_fraction', 'count', 'container', 'value', 'error', 'source')
    """
    return _of("measured", quantity, dimension)


def small_systems(quantity: str, dimension: int) -> np.recarray:
    """Return values measured by this program for few particles in a periodic square or cube.

    One row per system, with the fields of `literature`. Units are diameter = mass = k_B T = 1, with k_B T = 2
    E / (d (N - 1)). "contact_value": density of pairs at contact divided by N (N - 1) / V^2. "Z" and
    "collision_rate" follow from it exactly (`finite_contact_value`): Z is the canonical value, which
    `gaspart.analysis.compressibility_factor` measures; the rate is 2 N_coll / (N t). "diffusion": slope of
    the mean-squared displacement relative to the centre of mass, divided by 2 d. Errors are standard
    deviations over independent runs. In six rows, dense spheres have several states, and no run changes from
    one state to another. Their errors, 4 to 86 %, are standard deviations of single runs. Recipe and seeds
    are in `data/README.md`.

    Parameters
    ----------
    quantity : {"contact_value", "Z", "collision_rate", "diffusion"}
        Quantity of equal particles at fixed energy and zero total momentum.

    Examples
    --------
    >>> from gaspart import theory
    >>> rows = theory.small_systems("contact_value", 3)
    >>> int(rows.count.max()) >= 64
    True
    """
    return _of("small_systems", quantity, dimension)


def _of(table: str, quantity: str, dimension: int) -> np.recarray:
    """Return the rows of a quantity; raise SceneError if the table has no row."""
    rows = _read(table)
    same = rows[rows.dimension == checked_dimension(dimension)]
    matches = same[same.quantity == quantity]
    if not len(matches):
        raise SceneError("quantity", quantity, f"must be one of {', '.join(np.unique(same.quantity))}")
    return matches


@cache
def _read(table: str) -> np.recarray:
    """Return the rows of a table."""
    path = Path(__file__).parent / "data" / f"{table}.csv"
    return np.genfromtxt(path, delimiter=",", names=True, dtype=None, encoding="utf-8").view(np.recarray)


# Chemical potential of the fluid, from the reference equation of state.
#
# It is in units of k_B T, relative to an ideal gas. The activity is eta e^{mu_excess}, which is eta in a
# dilute gas.


_LOWEST = 1e-9
"""Packing fraction below which the fluid is an ideal gas to nine digits."""
_STEP = 2e-3  # step of central differences of the compressibility


def excess_free_energy(packing_fraction: Numbers, dimension: int) -> Values:
    """Compute the excess free energy per particle from the equation of state.

    F_excess / (N k_B T). The integral of (Z - 1) / eta' from 0 to eta (exact thermodynamics), with Z of
    `compressibility_factor`, by Gauss-Legendre quadrature. Multiplied by -N, it is the logarithm of the
    configuration integral Q of source C, Eq. 46, for a large container.
    """
    eta = checked_packing_fraction(packing_fraction, HIGHEST_PACKING_FRACTION[checked_dimension(dimension)])
    nodes, weights = np.polynomial.legendre.leggauss(40)
    inner = 0.5 * eta[..., None] * (nodes + 1.0)
    return 0.5 * eta * 2.0 ** (dimension - 1) * (contact_value(inner, dimension) @ weights)


def excess_chemical_potential(packing_fraction: Numbers, dimension: int) -> Values:
    """Compute the excess chemical potential from the equation of state.

    Excess potential mu_excess / (k_B T). Z - 1 + `excess_free_energy` (exact thermodynamics). See also
    `chemical_potential_uncertainty`.
    """
    excess = compressibility_factor(packing_fraction, dimension) - 1.0
    return excess + excess_free_energy(packing_fraction, dimension)


def chemical_potential_uncertainty(packing_fraction: Numbers, dimension: int) -> Values:
    """Compute the standard uncertainty of `excess_chemical_potential`; errors of Z are assumed to have the
    same sign.
    """
    eta = checked_packing_fraction(packing_fraction, HIGHEST_PACKING_FRACTION[checked_dimension(dimension)])
    nodes, weights = np.polynomial.legendre.leggauss(40)
    inner = 0.5 * eta[..., None] * (nodes + 1.0)
    below = (compressibility_uncertainty(inner, dimension) / (nodes + 1.0)) @ weights
    return compressibility_uncertainty(eta, dimension) + below


def activity(packing_fraction: Numbers, dimension: int) -> Values:
    """Compute the activity from the packing fraction.

    Activity eta exp(mu_excess / k_B T): mu_excess is `excess_chemical_potential`. See also
    `packing_fraction_at`.
    """
    return np.asarray(packing_fraction) * np.exp(excess_chemical_potential(packing_fraction, dimension))


@check_ranges
def insertion_finite_size_correction(packing_fraction: Numbers, dimension: int, count: int) -> Values:
    """Compute the shift of the insertion potential due to the finite number of particles. The value is -ln
    P_N - mu_excess / (k_B T), to first order in 1/N, in a periodic container. P_N is the probability that a
    random position in the container is free for another particle. With the configuration integral Q_N as in
    `state.finite_size_correction`, P_N = Q_(N+1) / (V Q_N) is

        (1 / 2N) [1 / S - 1 + eta S' / S],    where S = `reduced_compressibility` and S' is its derivative
        with respect to eta

    To first order in the density the correction is zero, which is exact.
    """
    highest = HIGHEST_PACKING_FRACTION[checked_dimension(dimension)]
    eta = np.clip(checked_packing_fraction(packing_fraction, highest), _STEP, highest - _STEP)
    s = reduced_compressibility(eta, dimension)
    low, high = (reduced_compressibility(eta + step, dimension) for step in (-_STEP, _STEP))
    slope = (high - low) / (2.0 * _STEP)
    return 0.5 / count * (1.0 / s - 1.0 + eta * slope / s)


@cache
def _table(dimension: int) -> tuple[np.ndarray, np.ndarray]:
    """Return ln(eta) and ln(activity) from `_LOWEST` to the end of the reference."""
    eta = np.geomspace(_LOWEST, HIGHEST_PACKING_FRACTION[dimension], 12001)
    eta[-1] = HIGHEST_PACKING_FRACTION[dimension]
    return np.log(eta), np.log(eta) + excess_chemical_potential(eta, dimension)


@check_ranges
def packing_fraction_at(activity: Numbers, dimension: int) -> Values:
    """Compute the packing fraction from the activity.

    Packing fraction eta, with a relative error of at most 1e-5. See also `activity`.

    Parameters
    ----------
    activity : array_like, [1]
        Activity eta exp(mu_excess / k_B T), above 0.
    """
    activity = np.asarray(activity, dtype=float)
    eta, table = _table(checked_dimension(dimension))
    if np.any(np.log(activity) > table[-1]):
        raise ValueError(f"activity: {np.max(activity):g} (above the reference's range)")
    return np.where(activity < _LOWEST, activity, np.exp(np.interp(np.log(activity), table, eta)))
