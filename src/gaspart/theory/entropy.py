"""Entropy of a gas of spheres that relaxes from equal speeds, by the homogeneous Boltzmann equation.

The equation is solved on a grid of energies v^2 in units of the mean square speed. Hard spheres scatter
isotropically. So for isotropic velocities the rate of collisions of energies a + b -> c + d is proportional
to the root of the smallest of the four. On the grid, number and energy are conserved to rounding, and the
entropy rises in each step.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from gaspart.theory.speeds import maxwell_cdf

_PER_UNIT = 20.5  # cells per unit of energy; half-integer, so that energy 1 is the middle of a cell
_CELLS = 164  # up to energy 8, above which Maxwell's distribution has 1.6e-5 of the particles
_STEP = 0.05  # collisions per particle in a step
ENTROPY_UNCERTAINTY = 1e-3
"""Uncertainty of `Energies.deficit` due to the grid, for bins as wide as a cell or wider."""


@dataclass(frozen=True)
class Energies:
    """Solution at S times: collisions per particle (S,), fraction never hit (S,), shares of cells (S, K)."""

    collisions: np.ndarray
    never_hit: np.ndarray
    shares: np.ndarray

    @property
    def kurtosis(self) -> np.ndarray:
        """Kurtosis of the speeds at each time."""
        return self.shares @ _middles() ** 2

    def deficit(self, edges: np.ndarray) -> np.ndarray:
        """Compute the entropy deficit of a histogram of speeds at each time; see `entropy_deficit`."""
        cells = np.arange(_CELLS + 1) / _PER_UNIT
        maxwell = np.diff(maxwell_cdf(np.sqrt(cells), 3, 1.0 / 3.0))
        expected = _histogram(edges, maxwell, 0.0)
        rows = zip(self.shares, self.never_hit, strict=True)
        return np.array([entropy_deficit(_histogram(edges, *row), expected) for row in rows])


def entropy_deficit(shares: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """It is the sum of p ln(p/q) over classes of the speed with shares p (..., K) and equilibrium shares q
    (K,).
    """
    ratio = np.where(shares > 0.0, shares, expected) / expected
    return (shares * np.log(ratio)).sum(axis=-1)


def _middles() -> np.ndarray:
    return (np.arange(_CELLS) + 0.5) / _PER_UNIT


def _histogram(edges: np.ndarray, shares: np.ndarray, never_hit: float) -> np.ndarray:
    """Return shares of bins of the speed and of all above; particles never hit have exactly speed 1."""
    spread = shares.copy()
    spread[int(_PER_UNIT)] -= never_hit
    below = np.concatenate([[0.0], np.cumsum(spread)])
    found = np.interp(np.asarray(edges) ** 2, np.arange(_CELLS + 1) / _PER_UNIT, below)
    histogram = np.diff(np.append(found, below[-1]))
    histogram[np.searchsorted(edges, 1.0, side="right") - 1] += never_hit
    return histogram


@cache
def equal_speeds(longest: float) -> Energies:
    """Solve the Boltzmann equation of spheres from equal speeds, up to some collisions per particle."""
    cells, total = np.arange(_CELLS), np.arange(2 * _CELLS - 1)[:, None]  # pairs: a cell and total - cell
    other = total - cells
    exists = (other >= 0) & (other < _CELLS)
    other = np.where(exists, other, 0)
    lower = np.minimum(cells, other)
    once = exists * (2.0 * (2 * cells < total) + 1.0 * (2 * cells == total))  # each pair and its reverse
    root = np.diff(np.arange(_CELLS + 1) ** 1.5)  # states in a cell, and mean root of its energy

    def meeting(pairs: np.ndarray) -> np.ndarray:
        """Sum pairs (total, cell) of equal total, times the smallest root of these two and two others."""
        sums = np.cumsum(once * pairs, axis=1)
        within = np.cumsum(root * once * pairs, axis=1) + root * (sums[:, -1:] - sums)
        return np.where(exists, np.take_along_axis(within, lower, axis=1), 0.0)

    lost = meeting(np.ones_like(once))

    def rates(shares: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        pairs = np.where(exists, (shares / root)[cells] * (shares / root)[other], 0.0)
        return meeting(pairs).sum(axis=0), (pairs * lost).sum(axis=0)

    start = int(_PER_UNIT)
    shares, never, progress = np.eye(_CELLS)[start], 1.0, 0.0
    rows = [(progress, never, shares)]
    while progress < longest:  # midpoint rule
        gain, loss = rates(shares)
        time = _STEP / loss.sum()
        middle = shares + 0.5 * time * (gain - loss)
        never_middle = never * (1.0 - 0.5 * time * loss[start] / shares[start])
        gain, loss = rates(middle)
        never -= time * never_middle * loss[start] / middle[start]
        shares = shares + time * (gain - loss)
        progress += time * loss.sum()
        rows.append((progress, never, shares))
    return Energies(*(np.array(column) for column in zip(*rows, strict=True)))
