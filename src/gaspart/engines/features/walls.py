"""Interior walls of a scene, as the kernels know them. A run changes nothing of them."""

from __future__ import annotations

from gaspart.kernels.model import InteriorWalls
from gaspart.scene.scene import Scene
from gaspart.state.boxes import Boxes
from gaspart.state.interior_walls import wall_rows, walls_near


def interior_walls(scene: Scene, boxes: Boxes, largest_radius: float) -> InteriorWalls:
    """The interior walls, with those near each box for radii up to `largest_radius`."""
    rows, wall = wall_rows(scene)
    return InteriorWalls(rows, wall, *walls_near(rows, boxes, largest_radius), largest_radius)
