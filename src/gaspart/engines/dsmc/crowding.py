"""How much denser a gas is where its particles are than on average, which its cells must fit.

It is the mean over particles of the density around them, over the density of the container: the number of
pairs in cells over that of a uniform gas. It is found at the start and after every `EPOCH` steps, counted
from time 0, so that it does not depend on where a run is split or sampled.
"""

from __future__ import annotations

import math

import numpy as np

from gaspart.engines.dsmc.dense import spreads
from gaspart.engines.dsmc.rates import accessible
from gaspart.scene.scene import Scene

EPOCH = 64
"""Steps from one look to the next."""
HIGHEST = 6
"""Of the level of a density, 2^level times the mean: more cells would be too many for the particles."""
_CHANGED = 0.75
"""Of a level: by so much a density is off the present one before it is another."""


def may_crowd(scene: Scene) -> bool:
    """Whether the density can come to be other than uniform."""
    return scene.count > 1 and (
        bool(scene.gravity and any(scene.gravity)) or bool(scene.faces) or not spreads(scene)
    )


def crowding(positions: np.ndarray, cells: tuple[int, ...], scene: Scene) -> float:
    """The crowding of particles at these positions (N, d), by the pairs in each of some cells; 1 in
    a uniform gas."""
    lower, upper = accessible(scene)
    places = (positions - lower) / (upper - lower) * cells
    at = np.clip(places.astype(np.int64), 0, np.array(cells) - 1)
    found = np.bincount(np.ravel_multi_index(tuple(at.T), cells)).astype(float)
    number = len(positions)
    return float((found * (found - 1.0)).sum()) * math.prod(cells) / (number * (number - 1.0))


def next_level(level: int, times: float) -> int:
    """The level of a gas so many times as dense, which was at a level."""
    exact = math.log2(max(times, 1.0))
    return level if abs(exact - level) <= _CHANGED else min(round(exact), HIGHEST)
