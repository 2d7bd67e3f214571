"""Interior walls of a scene, as the kernels know them, and what a run changes of those at a temperature."""

from __future__ import annotations

import numpy as np

from gaspart.engines.features.faces import face_energy
from gaspart.engines.features.part import Part
from gaspart.kernels.model import InteriorWalls, MovingWall, WarmWalls
from gaspart.scene.scene import Scene
from gaspart.state.boxes import Boxes
from gaspart.state.interior_walls import wall_rows, walls_near
from gaspart.state.random import key_of
from gaspart.state.state import State

_INTERIOR_DRAWS = 6  # the purpose of their random numbers, after those of the engines


def interior_walls(
    scene: Scene, boxes: Boxes, largest_radius: float, warm: WarmWalls | None, moving: MovingWall | None
) -> InteriorWalls:
    """The interior walls, with those near each box for radii up to `largest_radius`: one that moves is near
    none."""
    rows, wall = wall_rows(scene)
    if moving:
        rows, wall = rows[:0], wall[:0]
    return InteriorWalls(rows, wall, *walls_near(rows, boxes, largest_radius), largest_radius, warm, moving)


def warm_walls(scene: Scene, state: State, seed: int | tuple[int, ...], unit_mass: float) -> WarmWalls | None:
    """Those at a temperature, in units of `unit_mass`; None if all are hard."""
    level = np.array([wall.temperature or 0.0 for wall in scene.walls])
    if not level.any():
        return None
    draws = np.zeros(state.count, dtype=np.int64)
    return WarmWalls(level / unit_mass, draws, key_of(seed, _INTERIOR_DRAWS))


class WarmWallsPart(Part):
    """How often random numbers were drawn for each particle at interior walls. lightest: the least mass of a
    particle."""

    def __init__(self, scene: Scene, warm: WarmWalls, lightest: float) -> None:
        super().__init__({"wall_draws": warm.draws})
        self.gained = face_energy(scene) / lightest
