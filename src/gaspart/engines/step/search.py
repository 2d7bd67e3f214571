"""The search of the time-stepped engine: boxes, or the cells and the skin of a neighbour list."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaspart.engines.features.faces import face_energy
from gaspart.kernels.step.box_search import StepBoxes
from gaspart.kernels.step.cells import Cells
from gaspart.kernels.step.model import Search
from gaspart.scene.geometry import ball_volume
from gaspart.scene.scene import Scene
from gaspart.state.boxes import cube_side, make_boxes
from gaspart.state.state import State

if TYPE_CHECKING:
    from gaspart.engines.step.settings import TimeStepped

_CELLS_PER_PARTICLE = 6.0
_REBUILD, _TEST, _PAIR = 25.0, 2.0, 6.0  # ns per particle, candidate and pair listed: their ratios matter
_LEAST = 1.6  # times the distance by which the fastest two approach in a step, at least


def search_for(engine: TimeStepped, scene: Scene, state: State, radii: np.ndarray) -> Search:
    """The boxes, or the cells and room for the pairs of a neighbour list, for particles of these radii."""
    pairs = np.empty((engine.threads, state.count // engine.threads + 16), np.uint64)
    if engine.boxes_per_side is None:
        return Search(None, cells_for(engine, scene, state, radii), pairs)
    reach = 2.0 * radii.max(initial=0.0)
    grid = make_boxes(scene, engine.boxes_per_side, images=False, narrowest=reach)
    real = np.dtype(engine.precision).type
    boxes = StepBoxes(
        grid.per_side, grid.widths.astype(real), grid.strides, grid.neighbour,
        at=np.zeros((state.count, 3), dtype=np.int64),
        head=np.empty(grid.count, dtype=np.int32),
        following=np.empty(state.count, dtype=np.int32),
        near=engine.near_boxes,
        reach=real(reach * (1.0 + 1e-5)),
    )  # fmt: skip
    return Search(boxes, None, pairs)


def cells_for(engine: TimeStepped, scene: Scene, state: State, radii: np.ndarray) -> Cells:
    """The cells of the neighbour list."""
    real = np.dtype(engine.precision).type
    lengths, periodic = scene.container.lengths, scene.container.periodic
    contact = 2.0 * radii.max(initial=0.0)
    skin = engine.skin or _skin(engine, scene, state, contact)
    width = max((contact + skin) * (1.0 + 1e-4), _width(scene, state.count))
    sides = [max(1, int(length / width)) for length in lengths]
    # of two cells each would be the other's neighbour twice; one cell does too, by nearest images
    sides = [1 if p and side < 3 else side for side, p in zip(sides, periodic, strict=True)]
    rest = [1] * (3 - scene.dimension)
    per_side = np.array(sides + rest, dtype=np.int64)
    inverse = per_side / np.array([*lengths, *rest])
    rows = int(per_side[0]) + 3
    strides = np.array([1, rows, rows * (per_side[1] + 2)], dtype=np.int64)
    layers = int(strides[2]) * (int(per_side[2]) + 2 if scene.dimension == 3 else 1)
    return Cells(
        per_side,
        inverse.astype(real),
        strides,
        wraps=np.array(
            [p and side > 1 for side, p in zip(sides, periodic, strict=True)] + [False] * len(rest)
        ),
        ends=np.empty(layers, np.uint32),
        cell=np.zeros(state.count, np.uint32),
        order=np.empty(len(radii), np.uint32),
        skin=real(skin),
        origin=np.empty((scene.dimension, state.count), real),
        held=np.zeros(state.count if engine.threads > 1 else 0, bool),
        listed=np.zeros(engine.threads, int),
    )


def _width(scene: Scene, count: int) -> float:
    return cube_side(scene.container.lengths, _CELLS_PER_PARTICLE * count)


def _skin(engine: TimeStepped, scene: Scene, state: State, contact: float) -> float:
    """The skin that costs least: a thin one is used up soon, a thick one lists many pairs."""
    dimension, density = scene.dimension, state.count / scene.container.volume
    squares = (state.velocities**2).sum(axis=1)
    fastest = np.sqrt(squares.max(initial=0.0))
    if state.count > 1:  # in the end, whatever the speeds are now
        square = max(squares.mean(), face_energy(scene) / float(state.masses.min())) / dimension
        fastest = max(fastest, np.sqrt(square * (2.0 * np.log(state.count) + 2.0)))
    gravity = 0.0 if scene.gravity is None else float(np.abs(scene.gravity).max())
    way = 2.0 * (fastest * engine.time_step + gravity * engine.time_step**2)
    skins = contact * np.geomspace(0.02, 30.0, 60)
    steps = np.maximum(skins / way, 1.0) if way > 0.0 else np.full(60, np.inf)
    pairs = 0.5 * ball_volume(dimension) * density * (contact + skins) ** dimension
    stretches = 4.5 if dimension == 2 else 13.5  # cells in which partners are looked for
    tests = stretches * density * np.maximum(contact + skins, _width(scene, state.count)) ** dimension
    cost = (_REBUILD + _TEST * tests) / steps + _PAIR * pairs
    cost[skins < _LEAST * way] = np.inf  # contacts would use it up in one step
    return float(skins[np.argmin(cost)]) if np.isfinite(cost).any() else _LEAST * way
