"""Hard spheres between two flat hard walls: density profile and pressure by density functional theory.

The unit of length is the diameter sigma, the unit of energy k_B T. The width H of a slit is the distance
between the surfaces of its walls, so the space accessible to centres has the width H - 1.
"""

from __future__ import annotations

import numpy as np

from gaspart.theory.equations import METASTABLE_SPHERES, carnahan_starling
from gaspart.theory.geometry import (
    check_ranges,
    checked_packing_fraction,
    packing_fraction,
)

_RADIUS = 0.5
_MIXING = 0.015
"""Fraction of the computed change of the density that is applied far from the solution. With larger fractions
the iteration oscillates in slits narrower than two diameters.
"""
_NEAR, _NEAR_MIXING, _REMEMBERED = 0.3, 0.05, 5
"""Largest change, in units of the bulk density, that counts as near the solution; the fraction of a change
that is applied there; and the number of stored changes.
"""


@check_ranges
def white_bear_slit(
    bulk_density: float, width: float, spacing: float = 0.01, tolerance: float = 1e-8
) -> tuple[np.ndarray, np.ndarray]:
    """Compute the density profile of hard spheres in a slit in equilibrium with a bulk fluid.

    The profile minimizes the White Bear functional (R. Roth, R. Evans, A. Lang and G. Kahl, J. Phys.:
    Condens. Matter 14, 12063 (2002)). It is found by damped iteration and, near the solution, by Anderson
    mixing (D. G. Anderson, J. ACM 12, 547 (1965)). The bulk pressure of the functional is Carnahan and
    Starling's, which is 0.3 % too low at eta = 0.35. The theory obeys the contact theorem exactly, so the
    pressure on the walls is rho(0).

    Parameters
    ----------
    bulk_density : float, [1]
        Number density of the bulk, in 1 / sigma^3.
    width : float, [1]
        Distance H between the surfaces of the walls, in diameters, above 1.
    spacing : float, default 0.01, [1]
        Spacing of the grid, in diameters; adapted to divide the width and the radius.
    tolerance : float, default 1e-8, [1]
        Largest change of the density at the solution, divided by the bulk density.

    Returns
    -------
    position : ndarray, shape (n,), [1]
        Positions of centres above the contact plane of the lower wall, from 0 to H - 1.
    density : ndarray, shape (n,), [1]
        Densities at these positions, in 1 / sigma^3.

    Examples
    --------
    >>> from gaspart import theory
    >>> position, density = theory.white_bear_slit(0.1, width=3.0, spacing=0.05)
    >>> density[[0, 20]].round(4)
    array([0.124 , 0.0982])
    """
    if not width > 1.0:
        raise ValueError(f"width: {width} (must be larger than a diameter)")
    checked_packing_fraction(packing_fraction(bulk_density, 3), METASTABLE_SPHERES)
    cells = max(4, round((width - 1.0) / spacing))
    step = (width - 1.0) / cells
    half = round(_RADIUS / step)
    offset = step * np.arange(-half, half + 1)
    # Weights of the slices of a sphere, normalised so that the weighted bulk densities are exact on the grid.
    ends = np.where(np.abs(np.arange(-half, half + 1)) == half, 0.5, 1.0) * step
    volume = np.maximum(_RADIUS**2 - offset**2, 0.0) * ends
    volume *= np.pi / 6.0 / volume.sum()
    surface = ends * (np.pi / ends.sum())
    vector = 2.0 * np.pi * offset * ends
    weight = np.where((np.arange(cells + 1) == 0) | (np.arange(cells + 1) == cells), 0.5, 1.0)

    excess = _derivatives(*(np.array([value]) for value in (*_bulk_measures(bulk_density), 0.0)))
    bulk_excess = float(excess[0][0] * np.pi / 6.0 + excess[1][0] * np.pi)
    density = np.full(cells + 1, bulk_density)
    moves: list[np.ndarray] = []
    changes: list[np.ndarray] = []
    for _ in range(20_000):
        weighted = density * weight
        n3, n2 = np.convolve(weighted, volume), np.convolve(weighted, surface)
        towards = np.convolve(weighted, vector)
        by_volume, by_surface, by_vector = _derivatives(n3, n2, towards)
        felt = (
            np.correlate(by_volume, volume, "valid")
            + np.correlate(by_surface, surface, "valid")
            + np.correlate(by_vector, vector, "valid")
        )
        target = bulk_density * np.exp(np.clip(bulk_excess - felt, -20.0, 5.0))
        change = target - density
        changes.append(change)
        largest = float(np.max(np.abs(change))) / bulk_density
        move = _anderson(moves, changes) if largest < _NEAR else _MIXING * change
        density = density + move
        moves.append(move)
        if largest < tolerance:
            return step * np.arange(cells + 1), density
        del moves[:-_REMEMBERED], changes[:-_REMEMBERED]
    raise RuntimeError(f"the profile at density {bulk_density:g}, width {width:g} does not converge")


def _anderson(moves: list[np.ndarray], changes: list[np.ndarray]) -> np.ndarray:
    """Return the next step towards the solution by Anderson mixing. The last steps are combined such that the
    change is as small as possible.
    """
    if not moves:
        return _NEAR_MIXING * changes[-1]
    differences = np.diff(changes, axis=0).T
    shares = np.linalg.lstsq(differences, changes[-1], rcond=1e-10)[0]
    least = changes[-1] - differences @ shares
    return _NEAR_MIXING * least - np.transpose(moves) @ shares


@check_ranges
def white_bear_pressure(bulk_density: float) -> float:
    """Compute the bulk pressure of the White Bear functional.

    Pressure in k_B T / sigma^3, by Carnahan and Starling.

    Parameters
    ----------
    bulk_density : float, [1]
        Number density of the bulk, in 1 / sigma^3.
    """
    return bulk_density * float(carnahan_starling(packing_fraction(bulk_density, 3)))


def _bulk_measures(density: float) -> tuple[float, float]:
    """Return the weighted densities n_3 and n_2 of a homogeneous fluid."""
    return density * np.pi / 6.0, density * np.pi


def _derivatives(
    n3: np.ndarray, n2: np.ndarray, vector: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Compute the derivatives of the free energy density with respect to n_3, n_2 and n_V2, which give all
    others.
    """
    void = 1.0 - n3
    logarithm = np.log(void)
    small = n3 < 1e-4
    safe = np.where(small, 0.5, n3)
    ratio = np.where(
        small, 1.5 + 8.0 * n3 / 3.0, (safe + (1 - safe) ** 2 * np.log(1 - safe)) / (safe * (1 - safe)) ** 2
    )
    slope = np.where(
        small,
        8.0 / 3.0 + 7.5 * n3,
        (-2.0 * np.log(1 - safe) / safe**3 - (2.0 - 5.0 * safe + safe**2) / (safe**2 * (1 - safe) ** 3)),
    )
    n0, n1, v1 = n2 / np.pi, n2 / (2.0 * np.pi), vector / (2.0 * np.pi)
    cube = (n2**3 - 3.0 * n2 * vector**2) / (36.0 * np.pi)
    by_volume = n0 / void + (n1 * n2 - v1 * vector) / void**2 + cube * slope
    by_surface = -logarithm / np.pi + 2.0 * n1 / void + (n2**2 - vector**2) / (12.0 * np.pi) * ratio
    by_vector = -2.0 * v1 / void - n2 * vector / (6.0 * np.pi) * ratio
    return by_volume, by_surface, by_vector
