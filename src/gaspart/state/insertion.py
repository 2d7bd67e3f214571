"""Random sequential insertion: particles are placed in sequence at random free positions."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from gaspart.errors import SceneError
from gaspart.kernels.memory import aligned_zeros
from gaspart.scene.scene import Scene
from gaspart.scene.species import Species
from gaspart.scene.walls import Plate, Wall
from gaspart.state.boxes import Boxes, largest_in_boxes, make_boxes, sides_for

if TYPE_CHECKING:
    from gaspart.kernels.insertion import Block, PeriodicBoxes, Placed

PATIENCE = 2_000_000
"""Number of failed attempts to place one particle after which the container is considered full."""


def per_particle(scene: Scene, attribute: str) -> np.ndarray:
    """Return the values of an attribute for all particles."""
    alone = [getattr(particle, attribute) for particle in scene.particles]
    if attribute == "radius":
        return np.concatenate([alone, *(kind.radii for kind in scene.species)])
    return np.concatenate([alone, *(np.full(kind.count, getattr(kind, attribute)) for kind in scene.species)])


def range_of_centres(scene: Scene, kind: Species) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the lowest and highest coordinates for centres of a species."""
    radius = kind.largest_radius
    if kind.region is None:
        return scene.reach(radius)
    lower, upper = kind.region
    return tuple(x + radius for x in lower), tuple(x - radius for x in upper)


def empty_arrays(scene: Scene, boxes: Boxes, radii: np.ndarray) -> tuple[Placed, PeriodicBoxes, Block]:
    """Return the arrays of an empty container for the insertion of particles."""
    from gaspart.kernels.insertion import BLOCK, PLACES, Block, PeriodicBoxes, Placed

    near = aligned_zeros((boxes.count, 4, PLACES), float)
    near[:] = np.inf
    filled = np.zeros(boxes.count, dtype=np.uint8)
    lists = np.full(boxes.count, -1), np.full(len(radii), -1)
    failures = np.full(len(radii), -1)
    placed = Placed(np.empty((len(radii), scene.dimension)), radii, failures, near, filled, *lists)
    sides = zip(scene.container.lengths, scene.container.periodic, strict=True)
    periods = tuple(length if periodic else 4.0 * length for length, periodic in sides)
    grid = PeriodicBoxes(periods, boxes.per_side, boxes.widths, boxes.strides, boxes.neighbour)
    at, own, beside = np.zeros((3, BLOCK, 3), dtype=np.int64)
    remaining, box = np.zeros((2, BLOCK), dtype=np.int64)
    return placed, grid, Block(np.zeros((BLOCK, 3)), at, own, beside, remaining, box)


def random_insertion(
    scene: Scene,
    rng: np.random.Generator,
    patience: int = PATIENCE,
    given: Mapping[int, np.ndarray] | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Place the species in sequence at random free positions, larger radii first."""
    from gaspart.kernels.insertion import Task, place, put

    dimension, explicit, given = scene.dimension, len(scene.particles), given or {}
    radius = [kind.largest_radius for kind in scene.species]
    species = sorted(range(len(radius)), key=lambda n: (n not in given, -radius[n]))
    order = [np.arange(explicit)]  # particles in the order of placement
    first = explicit + np.cumsum([0, *(kind.count for kind in scene.species)])
    order += [np.arange(first[n], first[n + 1]) for n in species]
    radii = np.concatenate(
        [[particle.radius for particle in scene.particles]] + [scene.species[n].radii for n in species]
    ).astype(float)
    largest = largest_in_boxes(scene)
    boxes = make_boxes(scene, sides_for(scene, 2 * largest), images=False, narrowest=2 * largest)
    walls = None
    if scene.walls:
        walls, _ = wall_rows(scene)
    placed, grid, block = empty_arrays(scene, boxes, radii)
    placed.failures[:explicit] = 0
    larger = np.flatnonzero(radii > largest)

    # positions of single particles are prescribed, and the scene has checked them
    for n, particle in enumerate(scene.particles):
        position = np.clip(
            particle.position, *scene.reach(particle.radius)
        )  # exactly at a wall that it touches
        placed.positions[n] = position
        put(placed, boxes.index_of(position), n)
    done = explicit
    for n in species:
        kind = scene.species[n]
        stop = done + kind.count
        for position in given.get(n, ()):
            placed.positions[done], placed.failures[done] = position, 0
            put(placed, boxes.index_of(position), done)
            done += 1
        lower, upper = range_of_centres(scene, kind)
        failures = 0
        numbers = np.empty((max(256, min(1_000_000, 2 * kind.count)), dimension))
        while done < stop:
            draws = rng.random(out=numbers[: max(256, min(1_000_000, 2 * (stop - done)))])
            alone = radii[done] > largest  # the boxes: it is tested against all that are placed already
            oversized = np.arange(done) if alone else larger[: np.searchsorted(larger, done)]
            task = Task(done, done + 1 if alone else stop, failures, patience, lower, upper)
            done, failures, _ = place(draws, placed, grid, block, task, oversized, walls)
            if failures >= patience:
                eta = scene.packing_fraction * done / scene.count
                raise SceneError(
                    f"species[{n}].count",
                    kind.count,
                    f"does not fit by random insertion: full after {done} particles, packing fraction "
                    f"about {eta:.4f}, {patience} failed attempts",
                )
    back = np.argsort(np.concatenate(order), kind="stable") if scene.count else np.empty(0, dtype=int)
    return placed.positions[back], placed.failures[back]


# Interior walls as arrays, with images of walls near periodic faces.


_SLACK = 1e-9  # relative extension of neighbourhoods, so that rounding removes no wall from a box's list


def wall_rows(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Return interior walls and their images near periodic faces as rows of an array."""
    from gaspart.kernels.obstacles.distance import PLATE, SEGMENT

    lengths, reach = np.array(scene.container.lengths), scene.largest_radius * (1 + _SLACK)
    rows, walls = [], []
    for n, wall in enumerate(scene.walls):
        row = _segment(wall) if isinstance(wall, Wall) else _plate(wall)
        for image in product(*((0, -1, 1) if periodic else (0,) for periodic in scene.container.periodic)):
            moved = row.copy()
            moved[: scene.dimension] += np.array(image) * lengths
            corners = _corners(moved)
            if (
                any(image)
                and ((corners.max(axis=0) < -reach) | (corners.min(axis=0) > lengths + reach)).any()
            ):
                continue
            rows.append(moved)
            walls.append(n)
    row = SEGMENT if scene.dimension == 2 else PLATE
    return np.array(rows).reshape(-1).view(row), np.array(walls, dtype=np.int64)


def _segment(wall: Wall) -> np.ndarray:
    """Return the row of a segment."""
    start, end = np.array(wall.start), np.array(wall.end)
    length = float(np.hypot(*(end - start)))
    return np.array([*start, *((end - start) / length), length])


def _plate(wall: Plate) -> np.ndarray:
    """Return the row of a plate."""
    edges = np.array(wall.edges)
    sizes = np.sqrt((edges**2).sum(axis=1, keepdims=True))
    return np.concatenate([np.array(wall.corner), np.hstack([edges / sizes, sizes]).ravel()])


def _corners(row: np.ndarray) -> np.ndarray:
    """Return the ends (2, 2) of a segment, or the corners (4, 3) of a plate."""
    if len(row) == 5:
        return np.array([row[:2], row[:2] + row[2:4] * row[4]])
    along, across = row[3:6] * row[6], row[7:10] * row[10]
    return row[:3] + np.array([0 * along, along, across, along + across])


def _normal(row: np.ndarray) -> np.ndarray:
    """Return the unit normal (d,) of a segment or plate."""
    return np.array([-row[3], row[2]]) if len(row) == 5 else np.cross(row[3:6], row[7:10])


def walls_near(rows: np.ndarray, boxes: Boxes, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the walls within a distance of each box."""
    reach *= 1 + _SLACK
    numbers = rows.view(float).reshape(len(rows), rows.itemsize // 8)
    d = 2 if numbers.shape[1] == 5 else 3
    widths, per_side, strides = boxes.widths[:d], boxes.per_side[:d], boxes.strides[:d]
    pairs = []
    for m, row in enumerate(numbers):
        corners = _corners(row)
        low = np.floor((corners.min(axis=0) - reach) / widths - _SLACK).astype(int)
        high = np.floor((corners.max(axis=0) + reach) / widths + _SLACK).astype(int)
        low, high = (np.clip(c, 0, per_side - 1) for c in (low, high))
        at = np.stack(np.meshgrid(*map(np.arange, low, high + 1), indexing="ij"), axis=-1).reshape(-1, d)
        # the line or plane of the wall is near if its distance from the centre of the box is at most reach
        # plus half of the box's extent along the wall's normal
        normal = _normal(row)
        off = abs((((at + 0.5) * widths - row[:d]) * normal).sum(axis=1))
        near = off <= (reach + (0.5 * widths * abs(normal)).sum()) * (1 + _SLACK)
        pairs += [(box, m) for box in (at * strides).sum(axis=1)[near]]
    listed = np.array(sorted(pairs), dtype=np.int64).reshape(-1, 2)
    first = np.searchsorted(listed[:, 0], np.arange(boxes.count + 1))
    walls = np.concatenate([listed[:, 1], np.arange(len(rows))])
    return np.append(first, len(walls)).astype(np.int64), walls
