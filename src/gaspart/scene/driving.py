"""Uniform force along a periodic axis, which drives a flow: sinks of its momentum and energy."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gaspart.errors import SceneError

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene
    from gaspart.scene.walls import Plate, Wall

_MOMENTUM = (
    "fixed particles, interior walls across it, rough contacts with walls, or faces or walls at a temperature"
)
_ENERGY = "inelastic contacts, or faces or walls at a temperature"


def check_driven(scene: Scene) -> None:
    """Raise SceneError for a force along a periodic axis without a sink.

    Both the momentum and the energy of the force need a sink.
    """
    for axis in scene.driven_axes:
        for has_sink, quantity, by in (
            (_takes_momentum(scene, axis), "momentum", _MOMENTUM),
            (_takes_energy(scene), "energy", _ENERGY),
        ):
            if not has_sink:
                rule = (
                    f"gives energy without limit along {'xyz'[axis]}, a periodic axis, where nothing takes "
                    f"the {quantity}: {by} would"
                )
                raise SceneError("gravity", scene.gravity, rule)


def _takes_momentum(scene: Scene, axis: int) -> bool:
    """Return True if particles exchange momentum along a periodic axis with other objects.

    Other objects are fixed particles, walls and faces.
    """
    if scene.has_fixed:
        return True
    length = scene.container.lengths[axis]
    if any(wall.temperature or not _spans(wall, axis, length) for wall in scene.walls):
        return True
    surfaces = bool(scene.walls) or not scene.is_periodic
    return (scene.rough and surfaces) or not all(face.smooth for face in scene.faces.values())


def _takes_energy(scene: Scene) -> bool:
    """Return True if contacts lose energy, or faces at a temperature exchange it."""
    return scene.dissipates or bool(scene.face_temperatures)


def _spans(wall: Wall | Plate, axis: int, length: float) -> bool:
    """Return True if a wall spans an axis from end to end.

    No particle then hits it along the axis.
    """
    first, *others = wall.corners.values()
    edges = ([b - a for a, b in zip(first, corner, strict=True)] for corner in others)
    return any(abs(edge[axis]) >= length and not any(edge[:axis] + edge[axis + 1 :]) for edge in edges)
