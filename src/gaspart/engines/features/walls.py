"""Interior walls as arrays of the kernels, and the state of thermal or moving walls."""

from __future__ import annotations

import numpy as np

from gaspart.engines.features.faces import face_energy
from gaspart.engines.features.part import Part
from gaspart.errors import SceneError
from gaspart.kernels import model as kernels
from gaspart.kernels.model import InteriorWalls, MovingWall, WarmWalls
from gaspart.kernels.obstacles.moving import advance_wall
from gaspart.scene.scene import Scene
from gaspart.scene.walls import MOVING_WALL
from gaspart.state.boxes import Boxes
from gaspart.state.insertion import wall_rows, walls_near
from gaspart.state.random import key_of
from gaspart.state.state import State

_INTERIOR_DRAWS = 6  # stream number of these random numbers, after those of the engines


def interior_walls(
    scene: Scene, boxes: Boxes, largest_radius: float, warm: WarmWalls | None, moving: MovingWall | None
) -> InteriorWalls:
    """Return the interior walls, with a list of the walls near each box. The list can be used for particles
    with radii up to `largest_radius`. A moving wall is not in the list of any box.
    """
    rows, wall = wall_rows(scene)
    if moving:
        rows, wall = rows[:0], wall[:0]
    return InteriorWalls(rows, wall, *walls_near(rows, boxes, largest_radius), largest_radius, warm, moving)


def warm_walls(scene: Scene, state: State, seed: int | tuple[int, ...], unit_mass: float) -> WarmWalls | None:
    """Return the thermal walls, with masses in units of `unit_mass`; None if all are hard."""
    level = np.array([wall.temperature or 0.0 for wall in scene.walls])
    if not level.any():
        return None
    draws = np.zeros(state.count, dtype=np.int64)
    return WarmWalls(level / unit_mass, draws, key_of(seed, _INTERIOR_DRAWS))


class WarmWallsPart(Part):
    """State of thermal interior walls: the number of random draws of each particle.

    lightest : mass of the lightest particle
    """

    def __init__(self, scene: Scene, warm: WarmWalls, lightest: float) -> None:
        super().__init__({"wall_draws": warm.draws})
        self.gained = face_energy(scene) / lightest


# Moving wall across the container, between two gases.


def moving_wall_of(scene: Scene, state: State, unit_mass: float) -> kernels.MovingWall | None:
    """Return the kernels' moving wall; None if the scene has no moving wall. The mass of the wall is in units
    of `unit_mass`. Raises SceneError unless there are particles on both sides, because otherwise the wall
    would leave the container.
    """
    wall = scene.moving_wall
    if wall is None or state.piston is None:
        return None
    position, velocity = state.piston
    side = np.where(state.positions[:, wall.axis] > position, 1.0, -1.0)
    if len(np.unique(side)) < 2:
        raise SceneError(f"{MOVING_WALL}.mass", wall.mass, "a wall that moves needs particles on both sides")
    return kernels.MovingWall(wall.axis, wall.mass / unit_mass, side, np.array([position, velocity, 0.0]))


class MovingWallPart(Part):
    """Motion and energy of the moving wall; masses are in units of `unit_mass`."""

    def __init__(self, wall: kernels.MovingWall, unit_mass: float) -> None:
        super().__init__({"piston": wall.motion})
        self._motion, self._mass = wall.motion, wall.mass * unit_mass

    @property
    def stored(self) -> float:
        return 0.5 * self._mass * float(self._motion[kernels.PISTON_VELOCITY]) ** 2

    def set_clock(self, clock: float) -> None:
        self._motion[kernels.PISTON_CLOCK] = clock

    def end_epoch(self, length: float, start: float) -> None:
        advance_wall(self._motion, length)
        self.set_clock(0.0)

    def write(self, state: State, clock: float) -> None:
        motion = self._motion.copy()
        advance_wall(motion, clock)
        state.piston = motion[[kernels.PISTON_PLACE, kernels.PISTON_VELOCITY]]
