"""Cluster integrals of hard discs and spheres in a box, by Monte Carlo.

They describe how walls restrict the positions of clusters. The grand partition function of centres in a box
with sides l is exactly

    ln Xi = sum over n of z^n / n!  <U_n (l_1 - e_1) (l_2 - e_2) ...>,

an integral over the relative positions of n centres: U_n is Ursell's function of the centres, and e_k is
their extent along axis k. The terms without e belong to the bulk, the terms with one e to the walls, with
two to the edges, and with three to the corners. This program computes the constants in `walls`.
"""

import math
from functools import cache
from itertools import combinations

import numpy as np

from gaspart.theory.boltzmann import directions
from gaspart.theory.geometry import checked_dimension


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
