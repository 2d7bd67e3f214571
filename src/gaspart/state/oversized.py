"""Oversized particles: those that are too large for the boxes of the partition.

A box may not be narrower than the diameter of any particle that is found by its box alone. So a few large
particles would make the boxes of all the small ones huge; outside the partition, they cost a look at each of
them in every search, and a look at all the boxes around one in a search of its own.
"""

from __future__ import annotations

import math

import numpy as np

from gaspart.scene.scene import Scene
from gaspart.state.boxes import Boxes, make_boxes, sides_for

MOST = 256  # oversized particles, at most, where the program chooses
_GAIN = 0.75  # largest share of the work that may remain if particles are taken out of the partition
_BOXES = {2: (0.53, 0.5, 0.8), 3: (1.0, 3.0, 1.5)}  # per particle: in a dilute gas, more by density, at most


def boxes_per_particle(scene: Scene) -> float:
    """How many boxes there are for each particle. Eight particles are tested at once, so in a dilute gas of
    discs, which cross many boxes between contacts, wide ones are best; measured with 10^4 particles at
    packing fractions of 0.01 to 0.4 (docs/design-notes.md). Not where gravity gathers the particles, or where
    kicks make most searches find nothing new: there is one each at least."""
    dilute, by_density, limit = _BOXES[scene.dimension]
    best = min(dilute + by_density * scene.packing_fraction, limit)
    return max(1.0, best) if scene.gravity is not None or scene.thermostat else best


def largest_in_boxes(scene: Scene) -> float:
    """The largest radius that the boxes are made for: of the radii that leave at most `MOST` particles
    outside them, that with which a search looks at least, but the largest of all unless that saves a quarter.
    """
    radii, counts = sizes(scene)
    if len(radii) < 2 or scene.shear_rate is not None:
        return scene.largest_radius
    oversized = counts.sum() - counts.cumsum()
    works = {radius: work(scene, radius) for radius in radii[oversized <= MOST]}
    best = min(works, key=works.__getitem__)
    return float(best if works[best] <= _GAIN * works[radii[-1]] else radii[-1])


def boxes_and_largest(scene: Scene, boxes_per_side: int | tuple[int, ...] | None) -> tuple[Boxes, float]:
    """The partition, and the largest radius of the particles in it: of so many boxes, or as
    `largest_in_boxes` chooses.

    Raises SceneError for boxes that are narrower than most of the particles.
    """
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
    """The different radii (K,) in rising order, and (K,) how many particles have each; all of a polydisperse
    species count as the largest of it, because boxes wide enough for it are faster than a long list."""
    kinds = [kind for kind in scene.kinds if kind.count]
    largest = np.array([kind.largest_radius for kind in kinds], float)
    different, which = np.unique(largest, return_inverse=True)
    return different, np.bincount(which, [kind.count for kind in kinds], len(different)).astype(np.int64)


def work(scene: Scene, largest: float) -> float:
    """Boxes and particles looked at while each particle goes a unit of length, if the boxes are for radii up
    to `largest`: in a search after every contact, and a third of one at every face of a box.

    Particles are taken to be spread evenly and to be equally fast.
    """
    dimension, volume = scene.dimension, scene.container.volume
    radii, counts = sizes(scene)
    listed = radii <= largest
    per_side = np.array(sides_for(scene, 2 * largest, boxes_per_particle(scene)))
    widths = np.array(scene.container.lengths) / per_side
    crowd = counts[listed].sum() / per_side.prod()
    reach = np.where(listed, 0.0, radii + largest)
    boxes = np.minimum(2 * np.ceil(reach[:, None] / widths) + 3, per_side).prod(axis=1)
    looked_at = boxes * (1.0 + crowd) + counts[~listed].sum()
    # the section that a particle and any other show one another, summed over the others
    total, first, second = counts.sum(), counts @ radii, counts @ radii**2
    if dimension == 2:
        sections = 2.0 * (total * radii + first)
    else:
        sections = math.pi * (total * radii**2 + 2.0 * radii * first + second)
    contacts = sections / volume
    faces = 0.5 * (1.0 / widths).sum()
    return float(counts @ (looked_at * (contacts + faces / 3.0)))
