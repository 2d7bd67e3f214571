"""Search of the event-driven engine: its automatic choice, and neighbour lists for a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaspart.errors import SceneError
from gaspart.kernels.model import NUMBER_BITS
from gaspart.scene.sizes import ball_volume
from gaspart.state.boxes import make_boxes

if TYPE_CHECKING:
    from gaspart.kernels.event.neighbour_lists import NeighbourLists
    from gaspart.scene.scene import Scene

_LISTED = {2: 8.0, 3: 15.0}  # mean number of particles in a list: they fill one or two vectors of eight
_MARGINS = 0.1, 0.65  # limits of the margin of a list, in largest diameters
_MANY = 1 << 15  # number of particles above which neighbour lists exceed the processor's private cache
_DENSE = {2: (0.45, 0.55), 3: (0.28, 0.4)}  # lists are faster above: few and many particles
_ALIKE = 1.5  # maximum ratio of radii, because lists of small particles reach as far as lists of large ones
_ROOM = {2: 16, 3: 32}  # initial capacity of a list
_SMALLEST, _LARGEST = 1e-12, 1e12  # radii whose squares are float32 numbers


def distances(scene: Scene) -> tuple[float, float]:
    """Return the displacement of a particle at which its list is renewed, and the list's reach. The reach
    includes a margin for the rounding of list centres to single precision, so that no contact is missed.
    """
    d, diameter, lengths = scene.dimension, 2.0 * scene.largest_radius, scene.container.lengths
    rounding = 16.0 * float(np.finfo(np.float32).eps) * max(lengths)
    holding = (_LISTED[d] + 1.0) * scene.container.volume / (scene.count * ball_volume(d))
    least, most = (share * diameter for share in _MARGINS)
    # the images of a particle must remain distinguishable after both particles have moved
    axes = [length for length, periodic in zip(lengths, scene.container.periodic, strict=True) if periodic]
    for length in axes:
        most = min(
            most, (length / 3.0 - diameter - rounding) / 2.0, (length - 2.0 * (diameter + rounding)) / 8.0
        )
    margin = min(max(0.5 * (holding ** (1.0 / d) - diameter), least), most)
    return margin, diameter + 2.0 * margin + rounding


def obstacle_to_lists(scene: Scene) -> str | None:
    """Return the reason why a scene excludes neighbour lists; None if there is no reason."""
    if scene.gravity is not None:
        return "gravity"
    if scene.walls:
        return "interior walls"
    if scene.shear_rate is not None:
        return "sheared faces"
    if scene.is_open:
        return "open faces"
    if not _SMALLEST < scene.largest_radius < _LARGEST:
        return "particles of so extreme a size"
    if scene.count == 0:
        return "so few particles"
    if distances(scene)[0] < _MARGINS[0] * 2.0 * scene.largest_radius * (1.0 - 1e-9):
        return "so short a periodic axis"
    return None


def chosen_search(scene: Scene, search: str, boxes_given: bool) -> str:
    """Return the search for a scene; replace "automatic" by "boxes" or "lists". Raises SceneError if lists
    are requested but a feature of the scene does not support them, and if there are more particles than a
    search can number.
    """
    if scene.capacity > 1 << NUMBER_BITS:
        raise SceneError(
            "species", scene.capacity, f"the event-driven engine has at most {1 << NUMBER_BITS} particles"
        )
    if search not in ("automatic", "lists"):
        return search
    obstacle = obstacle_to_lists(scene)
    if search == "lists":
        if obstacle:
            raise SceneError("search", search, f"neighbour lists do not support {obstacle}; use boxes")
        return search
    dense = scene.packing_fraction >= _DENSE[scene.dimension][scene.count > _MANY]
    alike = 0.0 < scene.largest_radius <= _ALIKE * scene.smallest_radius
    return "lists" if dense and alike and not obstacle and not boxes_given else "boxes"


def neighbour_lists(scene: Scene, room: int = 0, per_cell: int = 1) -> NeighbourLists:
    """Return empty lists, of `room` words and `per_cell` pages of 8 particles per cell."""
    from gaspart.kernels.event.neighbour_lists import empty_neighbour_lists

    margin, reach = distances(scene)
    sides = tuple(max(1, int(length / reach)) for length in scene.container.lengths)
    cells = make_boxes(scene, sides, images=True, narrowest=reach)
    d = scene.dimension
    walls = np.array([0.0 if periodic else scene.largest_radius for periodic in scene.container.periodic])
    clearance = walls + margin * (1.0 + 1e-6)
    return empty_neighbour_lists(
        cells, scene.count, d, (margin, reach, clearance), room or _ROOM[d], per_cell
    )


def make_lists(lists: NeighbourLists, scene: Scene) -> NeighbourLists:
    """Make the neighbour lists of a scene; return them, or larger lists if needed."""
    from gaspart.kernels.event import neighbour_lists as kernels

    kernels.make_lists(lists, scene.container.lengths)
    while lists.full.any():
        larger = neighbour_lists(
            scene, lists.room << int(lists.full[0]), lists.per_cell << int(lists.full[1])
        )
        larger.listed["centre"] = lists.listed["centre"]
        lists = larger
        kernels.make_lists(lists, scene.container.lengths)
    return lists
