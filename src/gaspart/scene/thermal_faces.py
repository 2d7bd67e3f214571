"""What the temperatures of a scene's surfaces are, and how its thermal faces give them to particles."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gaspart.scene.faces import Thermal, faces_of

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene


def face_temperatures(scene: Scene) -> set[float]:
    """The temperatures of all faces and interior walls that have one, of faces that vary both ends."""
    warm = {wall.temperature for wall in scene.walls if wall.temperature is not None}
    return warm.union(*(face.temperatures for face in scene.faces.values()))


def partial_faces(scene: Scene) -> list[tuple[int, Thermal]]:
    """The faces that do not draw velocities after every hit, with their number."""
    return [(n, face) for n, face in faces_of(scene, Thermal) if face.accommodation is not None]


def ramps(scene: Scene) -> list[tuple[int, Thermal]]:
    """The faces whose temperature varies along them, with their number."""
    return [(n, face) for n, face in faces_of(scene, Thermal) if face.varies_along is not None]
