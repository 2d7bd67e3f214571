"""Arrays of the Enskog collision scheme."""

from __future__ import annotations

import math

import numpy as np

from gaspart.engines.dsmc.defaults import BEND, SLOPE
from gaspart.errors import SceneError
from gaspart.kernels.dsmc.enskog import Dense
from gaspart.kernels.dsmc.model import Grid
from gaspart.scene.geometry import ball_volume
from gaspart.scene.scene import Scene
from gaspart.state.state import State

_SAMPLES = 4000.0
"""Number of particles for the average of the density of a cell; fewer in a cell need more steps."""
MOST_KINDS = 16
"""Maximum number of kinds of particles in a dense gas: a trial draws the partner's kind, mostly in vain."""

_FEWEST_CELLS = 64
"""Minimum number of cells that threads share: fewer cells are in a single slab, one after another."""


def is_uniform(scene: Scene) -> bool:
    """Return True if the density is the same everywhere and stays so, and hence is known."""
    return scene.is_periodic and spreads(scene)


def spreads(scene: Scene) -> bool:
    """Return True if nothing in a scene brings particles together."""
    spread = all(kind.arrangement != "slab" and kind.region is None for kind in scene.species)
    elastic = scene.restitution is None or not scene.restitution.dissipative
    return spread and elastic


def moved_fields(fields: np.ndarray, before: Grid, after: Grid) -> np.ndarray:
    """Return the fields (2, cells) of one grid on another, by the cells at its centres."""
    per_side = tuple(after.per_side)
    centres = np.stack(np.unravel_index(np.arange(len(after.starts) - 1), per_side)) + 0.5
    ratio = (before.per_side / after.per_side)[:, None]
    indices = np.minimum((centres * ratio).astype(np.int64), before.per_side[:, None] - 1)
    return fields[:, np.ravel_multi_index(tuple(indices), tuple(before.per_side))]


def slabs_of(per_side: np.ndarray, reach: np.ndarray) -> tuple[int, np.ndarray]:
    """Return the axis along which cells are in slabs, and the first cell of each slab.

    The end of the last slab is included. There is an even number of slabs, each at least two reaches wide, or
    one slab.
    """
    numbers = 2 * (per_side // (4 * reach))
    axis = int(numbers.argmax())
    number = int(numbers[axis]) if per_side.prod() >= _FEWEST_CELLS and numbers[axis] > 2 else 1
    return axis, np.arange(number + 1) * per_side[axis] // number


def dense_for(scene: Scene, state: State, grid: Grid, kinds: int) -> Dense:
    """Return the arrays of a state, for a number of kinds of particles.

    Raises SceneError for a scene for which the model is not made.
    """
    d, cells, sigma = scene.dimension, len(grid.starts) - 1, 2.0 * scene.largest_radius
    if kinds > MOST_KINDS:
        rule = (
            f'takes {MOST_KINDS} kinds of particles at most; the "event" and "step" engines take any number'
        )
        raise SceneError("model", "enskog", rule)
    if min(scene.container.lengths) < sigma:
        raise SceneError("lengths", scene.container.lengths, 'model = "enskog" needs sides of a diameter')
    volume = grid.volume * cells
    sums = [float((state.radii**power).sum()) for power in (d, d - 1)]
    fields = np.repeat(np.array(sums)[:, None] * ball_volume(d) / volume, cells, axis=1)
    steps = max(1.0, _SAMPLES * cells / max(1, state.count))
    around = scene.is_periodic
    reach = np.array([math.ceil(sigma * inverse) for inverse in grid.inverse], dtype=np.int64)
    axis, slabs = slabs_of(grid.per_side, reach)
    drift = state.momentum / state.masses.sum() if around and state.count else np.zeros(d)
    return Dense(
        fields=fields,
        speed=np.zeros(cells),
        near_speed=np.zeros(cells),
        near_count=np.zeros(cells),
        room=np.zeros(cells),
        reach=reach,
        wraps=np.array(scene.container.periodic),
        axis=axis,
        slabs=slabs,
        drift=drift,
        ball=ball_volume(d),
        weight=0.0 if is_uniform(scene) else 1.0 / steps,
        slope=SLOPE[d],
        bend=BEND[d],
        highest=np.ones(1),
    )
