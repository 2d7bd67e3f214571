"""Bond order of particles, computed by freud, and Fourier modes of the density of discs.

Ramasubramani and others, Comput. Phys. Commun. 254, 107275 (2020). In all functions, positions (N, d) are in
[0, L] of a periodic container with side lengths (d,). freud works in single precision. freud is limited to
one thread, because a job of the workflow has one thread. freud is an optional dependency: `pip install
'gaspart[order]'`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np

from gaspart.errors import optional

NEIGHBOURS = 12
"""Number of neighbours of a sphere in a face-centred cubic crystal."""
_WIDEST = 10
"""Logarithm to base 2 of the longest side that freud gets. Its Voronoi diagram of a few discs needs much
memory for a side of 1e5, and ends the process for a side of 1e7.
"""


@cache
def _freud() -> ModuleType:
    freud = optional("freud", "order", "bond order")
    freud.parallel.set_num_threads(1)
    return freud


def _system(positions: np.ndarray, lengths: Sequence[float] | np.ndarray) -> tuple[Any, np.ndarray]:
    """Return a freud box and the positions in freud's coordinates. Units of length that do not suit freud's
    Voronoi diagram are changed by a power of two, which changes no other bit.
    """
    longest = math.frexp(max(map(float, lengths)))[1]  # a power of two
    scale = 2.0 ** (min(max(longest, 0), _WIDEST) - longest)
    box = _freud().box.Box(*(scale * float(length) for length in lengths), is2D=len(lengths) == 2)
    points = np.zeros((len(positions), 3), dtype=np.float32)
    points[:, : len(lengths)] = scale * (np.asarray(positions) - 0.5 * np.asarray(lengths))
    return box, box.wrap(points)


def hexatic(positions: np.ndarray, lengths: Sequence[float] | np.ndarray) -> np.ndarray:
    """Compute the complex hexatic order parameter psi_6 of each disc, shape (N,). The order parameter is the
    mean of exp(6 i theta) over the bonds of a disc to its Voronoi neighbours. |psi_6| is 1 in a triangular
    lattice. Halperin and Nelson, Phys. Rev. Lett. 41, 121 (1978).
    """
    system = _system(positions, lengths)
    neighbours = _freud().locality.Voronoi().compute(system).nlist  # not freud's default of 6
    order = _freud().order.Hexatic(k=6, weighted=False)
    order.compute(system, neighbors=neighbours)
    return order.particle_order


def global_steinhardt(positions: np.ndarray, lengths: Sequence[float] | np.ndarray) -> float:
    """Compute the order parameter Q_6 of all bonds between spheres and their 12 nearest neighbours. Q_6 is
    0.5745 in a face-centred cubic lattice and about 1 / sqrt(12 N) in a fluid. Steinhardt, Nelson and
    Ronchetti, Phys. Rev. B 28, 784 (1983).
    """
    order = _freud().order.Steinhardt(l=6, average=False, wl=False, weighted=False, wl_normalize=False)
    order.compute(_system(positions, lengths), neighbors={"num_neighbors": NEIGHBOURS})
    return float(order.order)


def local_steinhardt(positions: np.ndarray, lengths: Sequence[float] | np.ndarray) -> np.ndarray:
    """Compute the averaged bond order q_6 of each sphere, shape (N,). The complex order parameters q_6m are
    averaged over the sphere and its 12 nearest neighbours. The resulting q_6 is about 0.48 in a crystal near
    melting and about 0.15 in a fluid. Lechner and Dellago, J. Chem. Phys. 129, 114707 (2008).
    """
    order = _freud().order.Steinhardt(l=6, average=True, wl=False, weighted=False, wl_normalize=False)
    order.compute(_system(positions, lengths), neighbors={"num_neighbors": NEIGHBOURS})
    return order.particle_order


def structure_factor(
    frames: np.ndarray, lengths: Sequence[float] | np.ndarray, highest: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Compute S(k) = |sum exp(i k.r)|^2 / N of discs on a grid of wave vectors. Returns the wave numbers
    along x (K,) and along y (L,) up to `highest`, and S(k), shape (K, L). `frames` are positions (T, N, 2).
    S(k) is averaged over the frames and computed at the wave vectors that are compatible with the periodic
    container. S(0) is NaN. freud is not used, because its structure factors reject two dimensions, and its
    diffraction pattern rejects boxes that are not square.
    """
    unit = 2.0 * np.pi / np.asarray(lengths)
    waves = [step * np.arange(-int(highest / step), int(highest / step) + 1) for step in unit]
    total = np.zeros((waves[0].size, waves[1].size))
    for positions in frames:
        x, y = (
            np.exp(1j * np.outer(k, r)) for k, r in zip(waves, np.asarray(positions, float).T, strict=True)
        )
        total += np.abs(x @ y.T) ** 2
    total[waves[0].size // 2, waves[1].size // 2] = np.nan
    return waves[0], waves[1], total / (len(frames) * len(frames[0]))
