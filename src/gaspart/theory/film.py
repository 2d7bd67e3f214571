"""Hard spheres between two flat hard walls: density profile and pressure by density functional theory.

The unit of length is the diameter sigma, the unit of energy k_B T. The width H of a slit is the distance
between the surfaces of its walls, so the space accessible to centres has the width H - 1.
"""

from __future__ import annotations

import math
from functools import cache
from itertools import combinations

import numpy as np

from gaspart.theory.boltzmann import directions
from gaspart.theory.equations import METASTABLE_SPHERES, carnahan_starling
from gaspart.theory.geometry import (
    check_ranges,
    checked_dimension,
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
    """Return the next step towards the solution by Anderson mixing.

    The computed change is treated as a linear function of the solution. The last steps are combined such that
    the change is as small as possible.
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
    """Compute the derivatives of the free energy density with respect to n_3, n_2 and n_V2.

    All other weighted densities are functions of n_3, n_2 and n_V2.
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


# Cluster integrals of hard discs and spheres in a box, by Monte Carlo.
#
# They describe how walls restrict the positions of clusters. The grand partition function of centres in a box
# with sides l is exactly
#
#     ln Xi = sum over n of z^n / n!  <U_n (l_1 - e_1) (l_2 - e_2) ...>,
#
# an integral over the relative positions of n centres: U_n is Ursell's function of the centres, and e_k is
# their extent along axis k. The terms without e belong to the bulk, the terms with one e to the walls, with
# two to the edges, and with three to the corners. This program computes the constants in `walls`.


def cluster_integrals(order: int, dimension: int, samples: int, seed: int = 0) -> np.ndarray:
    """Compute the cluster integrals of bulk, walls, edges and corners by Monte Carlo."""
    d, rng = checked_dimension(dimension), np.random.default_rng(seed)
    ursell, trees = _graphs(order)
    positions = np.zeros((samples, order, d))
    rows = np.arange(samples)
    for leaf, parent in _random_trees(rng, order, samples):
        away = directions(rng, samples, d) * rng.random((samples, 1)) ** (1.0 / d)
        positions[rows, leaf] = positions[rows, parent] + away
    overlaps = np.zeros(samples, dtype=np.int64)
    for bit, (i, j) in enumerate(combinations(range(order), 2)):
        near = ((positions[:, i] - positions[:, j]) ** 2).sum(axis=1) < 1.0
        overlaps |= near.astype(np.int64) << bit
    ball = math.pi ** (d / 2.0) / math.gamma(d / 2.0 + 1.0)
    weight = ursell[overlaps] / trees[overlaps]
    weight *= order ** (order - 2.0) * ball ** (order - 1.0) / math.factorial(order)
    extents = np.ptp(positions, axis=1)
    chosen = [combinations(range(d), k) for k in range(d + 1)]
    products = [np.mean([extents[:, axes].prod(axis=1) for axes in sets], axis=0) for sets in chosen]
    return np.array([(weight * product).mean() for product in products])


@cache
def _graphs(order: int) -> tuple[np.ndarray, np.ndarray]:
    """Compute Ursell's function and the number of spanning trees of each graph of overlaps.

    A graph is an integer with one bit per pair. U_n is the sum of (-1)^edges over the connected subgraphs
    that contain all n vertices. A tree is a connected subgraph with n - 1 edges.
    """
    pairs = list(combinations(range(order), 2))
    graphs = np.arange(1 << len(pairs))
    neighbours = np.zeros((order, graphs.size), dtype=np.int64)
    edges = np.zeros(graphs.size, dtype=np.int64)
    for bit, (i, j) in enumerate(pairs):
        there = graphs >> bit & 1
        edges += there
        neighbours[i] |= there << j
        neighbours[j] |= there << i
    reached = np.ones(graphs.size, dtype=np.int64)
    for _ in range(order):
        for i in range(order):
            reached |= np.where(reached >> i & 1, neighbours[i], 0)
    connected = reached == (1 << order) - 1
    ursell = np.where(connected, (-1.0) ** edges, 0.0)
    trees = np.where(connected & (edges == order - 1), 1.0, 0.0)
    for bit in range(len(pairs)):  # sums over all subgraphs
        for sums in (ursell, trees):
            halves = sums.reshape(-1, 2, 1 << bit)
            halves[:, 1] += halves[:, 0]
    return ursell, trees


def _random_trees(rng: np.random.Generator, order: int, samples: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Draw random trees, uniformly among the labelled trees, by their Pruefer code.

    Returns the edges. Each edge is a leaf and its parent, both of shape (samples,). The parent is placed
    before the leaf, except for the first leaf, whose parent is the origin.
    """
    code = rng.integers(0, order, (samples, order - 2))
    rows = np.arange(samples)
    degree = np.ones((samples, order), dtype=np.int64)
    for column in code.T:
        degree[rows, column] += 1
    edges = []
    for column in code.T:
        leaf = np.argmax(degree == 1, axis=1)
        edges.append((leaf, column))
        degree[rows, leaf] -= 1
        degree[rows, column] -= 1
    first = np.argmax(degree == 1, axis=1)
    degree[rows, first] = 0
    edges.append((np.argmax(degree == 1, axis=1), first))
    return edges[::-1]
