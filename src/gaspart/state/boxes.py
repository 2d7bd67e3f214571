"""Partition of space into equal boxes on a grid.

Each axis is divided separately, and may have a single box. Box coordinates have three components even in two
dimensions; the third axis then has one box and no neighbours. For each axis a table contains the neighbours
of each box coordinate. Therefore walls, periodic faces and axes of one or two boxes need no special code.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import chain, combinations_with_replacement
from typing import TYPE_CHECKING

import numpy as np

from gaspart.errors import SceneError
from gaspart.keys.values import partition
from gaspart.scene.scene import Scene

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

NOWHERE = -1


@dataclass(frozen=True)
class Boxes:
    """Grid of boxes."""

    per_side: np.ndarray
    widths: np.ndarray
    strides: np.ndarray
    neighbour: np.ndarray
    shift: np.ndarray

    @property
    def count(self) -> int:
        """Number of boxes."""
        return int(self.per_side.prod())

    def coordinates(self, positions: np.ndarray) -> np.ndarray:
        """Return the box coordinates of positions."""
        boxes, positions = np.zeros((len(positions), 3), dtype=np.int64), np.nan_to_num(positions)
        for k in range(positions.shape[1]):
            along = (positions[:, k] / self.widths[k]).astype(np.int64)
            boxes[:, k] = np.clip(along, 0, self.per_side[k] - 1)
        return boxes

    def cut(self, axis: int) -> Boxes:
        """Return a grid whose first and last boxes along an axis are not neighbours."""
        neighbour, last = self.neighbour.copy(), self.per_side[axis] - 1
        neighbour[axis, 0, 0] = neighbour[axis, last, 2] = NOWHERE
        return replace(self, neighbour=neighbour)

    def index_of(self, position: np.ndarray) -> int:
        """Return the linear index of the box that contains a position."""
        return int(self.coordinates(position[None])[0] @ self.strides)


def narrowest_box(scene: Scene) -> float:
    """Return the smallest allowed side of a box: the largest particle diameter. With narrower boxes, contacts
    would be missed.
    """
    return 2.0 * scene.largest_radius


def sides_for(scene: Scene, narrowest: float | None = None, per_particle: float = 1.0) -> tuple[int, ...]:
    """Return the numbers of boxes per side for a number of boxes per particle."""
    lengths = scene.container.lengths
    narrowest = narrowest_box(scene) if narrowest is None else narrowest
    width = max(cube_side(lengths, per_particle * scene.capacity), narrowest)
    return tuple(max(1, int(length / width)) for length in lengths)


def cube_side(lengths: tuple[float, ...], number: float) -> float:
    """Return the side of a cube such that about `number` cubes fill a container."""
    sides = lengths
    while True:
        width = (math.prod(sides) / max(1.0, number)) ** (1.0 / len(sides))
        longer = tuple(side for side in sides if side >= width)
        if not longer or len(longer) == len(sides):
            return width
        sides = longer


def make_boxes(
    scene: Scene, boxes_per_side: int | tuple[int, ...], images: bool, narrowest: float | None = None
) -> Boxes:
    """Return the grid of boxes for a scene."""
    lengths = scene.container.lengths
    partition("boxes_per_side", boxes_per_side)
    numbers = boxes_per_side
    if not isinstance(numbers, (tuple, list)):
        numbers = (numbers,) * len(lengths)
    if len(numbers) != len(lengths):
        raise SceneError("boxes_per_side", boxes_per_side, "must be one number, or one per axis")
    sides = [int(n) for n in numbers]
    narrowest = narrowest_box(scene) if narrowest is None else narrowest
    for length, n in zip(lengths, sides, strict=True):
        if n > 1 and length / n < narrowest:
            rule = f"boxes must not be narrower than the largest diameter, {narrowest:g}"
            raise SceneError("boxes_per_side", boxes_per_side, rule)
    periodic = scene.container.periodic + (False,) * (3 - len(lengths))
    per_side = np.array(sides + [1] * (3 - len(sides)), dtype=np.int64)
    widths = np.array(
        [length / n for length, n in zip(lengths, sides, strict=True)] + [1.0] * (3 - len(sides))
    )
    strides = np.array([1, per_side[0], per_side[0] * per_side[1]], dtype=np.int64)
    largest = int(per_side.max())
    neighbour = np.full((3, largest, 3), NOWHERE, dtype=np.int64)
    shift = np.zeros((3, largest, 3), dtype=np.int64)
    for axis in range(3):
        n = int(per_side[axis])
        for step in (0, 1, -1)[: n if periodic[axis] and not images else 3]:
            images_crossed, target = np.divmod(np.arange(n) + step, n)
            there = (images_crossed == 0) | periodic[axis]
            neighbour[axis, :n, step + 1][there] = target[there] * strides[axis]
            shift[axis, :n, step + 1][there] = images_crossed[there]
    return Boxes(per_side, widths, strides, neighbour, shift)


# Oversized particles, which are too large for the boxes of the partition. A box must not be narrower than the
# diameter of any particle that is found by its box. A few large particles would therefore make the boxes of
# all small particles huge. Outside the partition, each large particle is tested in every search. A search for
# its own contacts tests all boxes around it.


MOST = 256  # maximum number of oversized particles that the program chooses
_GAIN = 0.75  # largest fraction of the work that may remain, if particles are removed from the partition
# boxes per particle; in a dilute gas more, depending on density, up to the maximum
_BOXES = {2: (0.53, 0.5, 0.8), 3: (1.0, 3.0, 1.5)}


def boxes_per_particle(scene: Scene) -> float:
    """Return the number of boxes per particle for which searches are fastest."""
    dilute, by_density, limit = _BOXES[scene.dimension]
    best = min(dilute + by_density * scene.packing_fraction, limit)
    return max(1.0, best) if scene.gravity is not None or scene.thermostat else best


def largest_in_boxes(scene: Scene) -> float:
    """Return the largest radius of particles that are put into boxes."""
    radii, counts = sizes(scene)
    if len(radii) < 2 or scene.shear_rate is not None:
        return scene.largest_radius
    oversized = counts.sum() - counts.cumsum()
    works = {radius: work(scene, radius) for radius in radii[oversized <= MOST]}
    best = min(works, key=works.__getitem__)
    return float(best if works[best] <= _GAIN * works[radii[-1]] else radii[-1])


def boxes_and_largest(scene: Scene, boxes_per_side: int | tuple[int, ...] | None) -> tuple[Boxes, float]:
    """Return the partition into boxes and the largest radius of the particles in boxes."""
    if boxes_per_side is None:
        largest = largest_in_boxes(scene)
        per_side = sides_for(scene, 2 * largest, boxes_per_particle(scene))
        return make_boxes(scene, per_side, images=True, narrowest=2 * largest), largest
    boxes = make_boxes(scene, boxes_per_side, images=True, narrowest=0.0)
    narrowest = min(boxes.widths[boxes.per_side > 1], default=np.inf)
    radii, counts = sizes(scene)
    listed = 2.0 * radii <= narrowest
    if scene.shear_rate is not None or counts[listed].sum() <= counts[~listed].sum():
        return make_boxes(scene, boxes_per_side, images=True), scene.largest_radius
    return boxes, float(radii[listed][-1])


def sizes(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Return the distinct radii, and the number of particles with each radius."""
    kinds = [kind for kind in scene.kinds if kind.count]
    largest = np.array([kind.largest_radius for kind in kinds], float)
    different, which = np.unique(largest, return_inverse=True)
    return different, np.bincount(which, [kind.count for kind in kinds], len(different)).astype(np.int64)


def work(scene: Scene, largest: float) -> float:
    """Return the number of boxes and particles visited per unit of path length of a particle."""
    dimension, volume = scene.dimension, scene.container.volume
    radii, counts = sizes(scene)
    listed = radii <= largest
    per_side = np.array(sides_for(scene, 2 * largest, boxes_per_particle(scene)))
    widths = np.array(scene.container.lengths) / per_side
    crowd = counts[listed].sum() / per_side.prod()
    reach = np.where(listed, 0.0, radii + largest)
    boxes = np.minimum(2 * np.ceil(reach[:, None] / widths) + 3, per_side).prod(axis=1)
    looked_at = boxes * (1.0 + crowd) + counts[~listed].sum()
    # cross-section of a particle and each other particle, summed over the others
    total, first, second = counts.sum(), counts @ radii, counts @ radii**2
    if dimension == 2:
        sections = 2.0 * (total * radii + first)
    else:
        sections = math.pi * (total * radii**2 + 2.0 * radii * first + second)
    contacts = sections / volume
    faces = 0.5 * (1.0 / widths).sum()
    return float(counts @ (looked_at * (contacts + faces / 3.0)))


# Deepest overlap of particles of any sizes. Time and memory are proportional to the number of particles.


_CROWD, _SAMPLE = 32.0, 256
"""Mean number of neighbours above which the search is limited; number of sampled particles."""


def _reach_of_deepest(tree: cKDTree, other: cKDTree, reach: float) -> float:
    """Return a distance within which the deepest overlap of two size classes is found. In usual states this
    distance is `reach`. If many particles lie on top of each other, memory cannot hold all pairs within
    `reach`. The distance is then smaller: contact distances in the classes differ by less than a factor of
    two, so that the pair of deepest overlap has at most twice the distance q of the nearest pair. The result
    is 0 if two centres coincide.
    """
    itself = tree is other
    sample = tree.data[:: max(1, tree.n // _SAMPLE)]
    if other.query_ball_point(sample, reach, return_length=True).mean() <= _CROWD:
        return reach
    if tree.count_neighbors(other, 0.0) > (tree.n if itself else 0):
        return 0.0
    distances, _ = other.query(tree.data, k=[2] if itself else [1])
    return min(reach, 2.0 * float(distances.min()))


def deepest_overlap(
    positions: np.ndarray, radii: np.ndarray, lengths: np.ndarray, periodic: tuple[bool, ...]
) -> float:
    """Return the largest relative overlap of two particles; on periodic axes, of their nearest images."""
    from scipy.spatial import cKDTree  # few runs need this import

    if not len(positions):
        return 0.0
    sides = np.where(periodic, lengths, 0.0)
    on_itself = 1.0 - np.where(periodic, lengths, np.inf) / (2.0 * radii.max())
    deepest = max(0.0, float(on_itself.max()))
    octave = np.floor(np.log2(radii / radii.min())).astype(int)
    members = [np.flatnonzero(octave == k) for k in np.unique(octave)]
    trees = [cKDTree(positions[indices], boxsize=sides) for indices in members]
    for a, b in combinations_with_replacement(range(len(members)), 2):
        reach = float(radii[members[a]].max() + radii[members[b]].max())
        reach = _reach_of_deepest(trees[a], trees[b], reach)
        if reach == 0.0:
            return 1.0
        if a == b:
            pairs = trees[a].query_pairs(reach, output_type="ndarray")
        else:  # the larger particles search, because they are fewer if sizes differ strongly
            near = trees[b].query_ball_tree(trees[a], reach)
            larger = np.repeat(np.arange(len(near)), [len(neighbours) for neighbours in near])
            pairs = np.stack([np.fromiter(chain.from_iterable(near), dtype=int), larger], axis=1)
        if len(pairs):
            first, second = members[a][pairs[:, 0]], members[b][pairs[:, 1]]
            gap = positions[first] - positions[second]
            gap -= np.where(sides > 0.0, lengths * np.round(gap / lengths), 0.0)
            depth = 1.0 - np.sqrt((gap**2).sum(axis=1)) / (radii[first] + radii[second])
            deepest = max(deepest, float(depth.max()))
    return deepest
