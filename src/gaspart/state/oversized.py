"""Oversized particles, which are too large for the boxes of the partition.

A box may not be narrower than the diameter of any particle that is found by its box alone. So a few large
particles would make the boxes of all the small ones huge. Outside the partition, they cost a look at each of
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
    """Return the number of boxes for each particle.

    Parameters
    ----------
    scene : Scene
        Scene of the particles.

    Returns
    -------
    float
        Number, at least 1 if gravity gathers the particles, or if kicks make most searches find nothing new.

    Notes
    -----
    Eight particles are tested at once. So in a dilute gas of discs, which cross many boxes between contacts,
    wide boxes are best; measured with 10^4 particles at packing fractions of 0.01 to 0.4
    (docs/design-notes.md).
    """
    dilute, by_density, limit = _BOXES[scene.dimension]
    best = min(dilute + by_density * scene.packing_fraction, limit)
    return max(1.0, best) if scene.gravity is not None or scene.thermostat else best


def largest_in_boxes(scene: Scene) -> float:
    """Return the largest radius that the boxes are made for.

    Parameters
    ----------
    scene : Scene
        Scene of the particles.

    Returns
    -------
    float, [length]
        Of the radii that leave at most `MOST` particles outside the boxes, the radius with the least work of
        a search. The largest radius of all, unless the other saves a quarter.
    """
    radii, counts = sizes(scene)
    if len(radii) < 2 or scene.shear_rate is not None:
        return scene.largest_radius
    oversized = counts.sum() - counts.cumsum()
    works = {radius: work(scene, radius) for radius in radii[oversized <= MOST]}
    best = min(works, key=works.__getitem__)
    return float(best if works[best] <= _GAIN * works[radii[-1]] else radii[-1])


def boxes_and_largest(scene: Scene, boxes_per_side: int | tuple[int, ...] | None) -> tuple[Boxes, float]:
    """Return the partition and the largest radius of the particles in it.

    Parameters
    ----------
    scene : Scene
        Scene of the particles.
    boxes_per_side : int or tuple of int or None
        Boxes per side. None: as `largest_in_boxes` chooses.

    Returns
    -------
    boxes : Boxes
        Partition.
    largest : float, [length]
        Largest radius.

    Raises
    ------
    SceneError
        If boxes are narrower than most of the particles.
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
    """Return the different radii and how many particles have each radius.

    Parameters
    ----------
    scene : Scene
        Scene of the particles. All particles of a polydisperse species count as its largest, because boxes
        wide enough for it are faster than a long list.

    Returns
    -------
    radii : ndarray, shape (K,), [length]
        Different radii in ascending order.
    counts : ndarray of int, shape (K,)
        Numbers of particles.
    """
    kinds = [kind for kind in scene.kinds if kind.count]
    largest = np.array([kind.largest_radius for kind in kinds], float)
    different, which = np.unique(largest, return_inverse=True)
    return different, np.bincount(which, [kind.count for kind in kinds], len(different)).astype(np.int64)


def work(scene: Scene, largest: float) -> float:
    """Return the boxes and particles searched while each particle travels a unit of length.

    Parameters
    ----------
    scene : Scene
        Scene, whose particles are taken to be spread evenly and to be equally fast.
    largest : float, [length]
        Largest radius of particles in the boxes.

    Returns
    -------
    float, [1/length]
        Number of boxes and particles: in a search after every contact, and a third of a search at every face
        of a box.
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
