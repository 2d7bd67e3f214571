"""Accessible volume and areas: the positions that particle centres can reach.

A point is accessible to the centre of a particle if the particle would overlap no wall of the container, no
interior wall and no fixed particle there. Other moving particles are ignored. An accessible point counts even
if no path of accessible points connects it to the rest.

Obstacles are represented by bodies. A body is the set of points within one radius of the particle from a
ball, a segment or a rectangle. Every body is convex, so that a line intersects it in at most one interval. On
a face of a two-dimensional container, the accessible length is the length of the face outside these
intervals, which is exact. In other cases the volume is exact in regions without bodies, and in regions where
bodies overlap neither each other nor the border. In all other regions the volume is a mean over `SETS` sets
of `LINES` parallel lines. Each set is shifted at random, and the error is computed from the scatter of the
sets.
"""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gaspart.errors import SceneError
from gaspart.scene.sizes import ball_volume

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene
    from gaspart.scene.walls import Plate, Wall

LINES, SETS = 8192, 8
"""Number of lines in a set, and number of sets, for the numerical integration."""
SPREADING = {1: 1.61803398874989484820, 2: 1.32471795724474602596}
"""Numbers whose powers spread points evenly along one or two axes: x^(d + 1) = x + 1 (Roberts 2018)."""


class Measure(NamedTuple):
    """Volume or area, and the estimated error of its numerical integration (0 for an exact value)."""

    value: float
    error: float


class Ball(NamedTuple):
    """Ball with centre (d,) and radius."""

    centre: np.ndarray
    radius: float

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest coordinates, (d,) each."""
        return self.centre - self.radius, self.centre + self.radius

    def translate(self, shift: np.ndarray) -> Ball:
        """Return a copy at another position."""
        return Ball(self.centre + shift, self.radius)

    def interval(self, points: np.ndarray, axis: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the ends of the interval inside the ball on each line through points (M, d). The lines are
        parallel to an axis. If a line misses the ball, its ends are inf and -inf.
        """
        away = np.delete(points - self.centre, axis, axis=1)
        square = self.radius**2 - (away**2).sum(axis=1)
        half = np.sqrt(np.maximum(square, 0.0))
        hit = square > 0.0
        return (
            np.where(hit, self.centre[axis] - half, np.inf),
            np.where(hit, self.centre[axis] + half, -np.inf),
        )


class Slab(NamedTuple):
    """Segment or rectangle, thickened by `distance` in the directions perpendicular to it. The segment or
    rectangle has the corner `start` (d,) and the orthogonal `edges` (K, d) from this corner. It is not
    extended beyond its ends or edges.
    """

    start: np.ndarray
    edges: np.ndarray
    distance: float

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper bounds of the coordinates, (d,) each, close to the extreme values."""
        sums = np.array(
            [np.sum(part, axis=0) for part in product(*((0.0 * edge, edge) for edge in self.edges))]
        )
        return self.start + sums.min(axis=0) - self.distance, self.start + sums.max(axis=0) + self.distance

    def translate(self, shift: np.ndarray) -> Slab:
        """Return a copy at another position."""
        return Slab(self.start + shift, self.edges, self.distance)

    def interval(self, points: np.ndarray, axis: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the ends of the interval inside the slab on each line, like `Ball.interval`. A point p + t e
        of the line is inside if two conditions hold. Relative to `start`, its component along each edge, in
        units of the edge, is between 0 and 1. Its distance from the line or plane of the edges, whose square
        is a quadratic function of t, is less than `distance`.
        """
        from_start = np.array(points)
        from_start[:, axis] = 0.0
        from_start -= self.start
        lower, upper = np.full(len(points), -np.inf), np.full(len(points), np.inf)
        along = np.zeros(len(self.start))
        along[axis] = 1.0
        for edge in self.edges:
            square = edge @ edge
            part, slope = from_start @ edge / square, edge[axis] / square
            low, high = _interval(part, slope, 0.0, 1.0)
            lower, upper = np.maximum(lower, low), np.minimum(upper, high)
            from_start = from_start - np.multiply.outer(part, edge)
            along = along - slope * edge
        square = along @ along
        if square < 1e-24:  # the line is parallel to the span
            inside = (from_start**2).sum(axis=1) < self.distance**2
            return np.where(inside, lower, np.inf), np.where(inside, upper, -np.inf)
        middle = -(from_start @ along) / square
        discriminant = self.distance**2 - (from_start**2).sum(axis=1) + square * middle**2
        half = np.sqrt(np.maximum(discriminant, 0.0) / square)
        lower, upper = np.maximum(lower, middle - half), np.minimum(upper, middle + half)
        hit = (discriminant > 0.0) & (lower < upper)
        return np.where(hit, lower, np.inf), np.where(hit, upper, -np.inf)


def _interval(part: np.ndarray, slope: float, low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the interval of t in which low <= part + slope t <= high."""
    if slope == 0.0:
        inside = (part >= low) & (part <= high)
        return np.where(inside, -np.inf, np.inf), np.where(inside, np.inf, -np.inf)
    first, second = (low - part) / slope, (high - part) / slope
    return np.minimum(first, second), np.maximum(first, second)


class Body(NamedTuple):
    """Fixed particle or interior wall, grown by a radius: its parts and its volume."""

    parts: list[Ball | Slab]
    volume: float

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest coordinates, (d,) each."""
        lower, upper = zip(*(part.bounds for part in self.parts), strict=True)
        return np.min(lower, axis=0), np.max(upper, axis=0)

    def is_apart(self, other: Body) -> bool:
        """Return True only if the body certainly has no point in common with another body."""
        first, second = self.parts[0], other.parts[0]
        if isinstance(first, Ball) and isinstance(second, Ball):
            return bool(((first.centre - second.centre) ** 2).sum() >= (first.radius + second.radius) ** 2)
        (low, high), (least, most) = self.bounds, other.bounds
        return bool(((low >= most) | (high <= least)).any())


def grown_wall(wall: Wall | Plate, radius: float) -> Body:
    """Return the body of a wall grown by a radius, with its volume from Steiner's formula."""
    corners = [np.array(corner, float) for corner in wall.corners.values()]
    edges = np.array([corner - corners[0] for corner in corners[1:3]])
    sides, d = np.sqrt((edges**2).sum(axis=1)), len(corners[0])
    slabs = [Slab(corners[0], edges, radius)]
    volume = ball_volume(d, radius) + 2.0 * radius * float(sides.prod())
    if d == 3:
        first, second = edges
        rim = (corners[0], first), (corners[0], second), (corners[2], first), (corners[1], second)
        slabs += [Slab(start, edge[None], radius) for start, edge in rim]
        volume += ball_volume(2, radius) * float(sides.sum())
    return Body([*slabs, *(Ball(corner, radius) for corner in corners)], volume)


class Accessible:
    """Accessible volume and areas of a scene, computed once for each radius. A scene with fixed species
    requires `fixed`, because positions of a species are known only in a run. Without `fixed` SceneError is
    raised.

    fixed : positions (F, d) and radii (F,) of all fixed particles. Default: the fixed single particles of the
        scene.
    """

    def __init__(self, scene: Scene, fixed: tuple[np.ndarray, np.ndarray] | None = None) -> None:
        self._scene = scene
        if fixed is None and any(kind.fixed and kind.count for kind in scene.species):
            rule = "has positions in a run only: the accessible volume of the scene alone is not known"
            raise SceneError("species.fixed", True, rule)
        if fixed is None:
            single = [particle for particle in scene.particles if particle.fixed]
            fixed = (
                np.array([particle.position for particle in single]),
                np.array([particle.radius for particle in single]),
            )
        self._fixed = list(zip(*fixed, strict=True))
        self._found: dict[tuple[float, int | None], Measure] = {}

    def volume(self, radius: float) -> Measure:
        """Return the volume (2D: area) that is accessible to centres of particles of this radius."""
        return self._measure(radius, None)

    def areas(self, radii: np.ndarray) -> np.ndarray:
        """Return the areas (2D: lengths) of faces that are accessible to particle centres. `radii`: radii of
        particles, shape (K,). The result has the shape (K, 2d).
        """
        scene, faces = self._scene, range(2 * self._scene.dimension)
        if self._fixed or scene.walls:
            return np.array([[self._measure(r, face).value for face in faces] for r in radii.tolist()])
        margins = 2.0 * radii[:, None] * (not scene.centres_to_walls) * ~np.array(scene.container.periodic)
        sides = np.array(scene.container.lengths) - margins
        across = [np.delete(sides, axis, axis=1).prod(axis=1) for axis in range(scene.dimension)]
        return np.repeat(np.stack(across, axis=1), 2, axis=1)

    def _bodies(self, radius: float) -> list[Body]:
        """Return all bodies grown by a radius, and their periodic images."""
        bodies = [
            Body([Ball(centre, size + radius)], ball_volume(len(centre), size + radius))
            for centre, size in self._fixed
        ]
        bodies += [grown_wall(wall, radius) for wall in self._scene.walls]
        lengths, periodic = np.array(self._scene.container.lengths), self._scene.container.periodic
        shifts = [
            np.array(image) * lengths
            for image in product(*((-1.0, 0.0, 1.0) if around else (0.0,) for around in periodic))
        ]
        return [
            Body([part.translate(shift) for part in body.parts], body.volume)
            for body in bodies
            for shift in shifts
        ]

    def _measure(self, radius: float, face: int | None) -> Measure:
        if (radius, face) not in self._found:
            self._found[radius, face] = self._compute(radius, face)
        return self._found[radius, face]

    def _compute(self, radius: float, face: int | None) -> Measure:
        """Compute the accessible volume, or the accessible area of a face."""
        lower, upper = (np.array(ends) for ends in self._scene.reach(radius))
        axes = [axis for axis in range(len(lower)) if face is None or axis != face // 2]
        if face is not None:  # the plane in which centres lie when particles touch the face
            lower[face // 2] = upper[face // 2] = (lower, upper)[face % 2][face // 2]
        full = float((upper - lower)[axes].prod())
        near = [body for body in self._bodies(radius) if _meets(body, lower, upper)]
        if not near or not full > 0.0:
            return Measure(full, 0.0)
        if face is None and (covered := _apart(near, lower, upper, self._scene)) is not None:
            return Measure(full - covered, 0.0)
        parts = [part for body in near for part in body.parts]
        if len(axes) == 1:
            return Measure(float(free_lengths(parts, lower[None], axes[0], (lower, upper))[0]), 0.0)
        means = [free_fraction(parts, axes, (lower, upper), shift) for shift in range(SETS)]
        return Measure(full * float(np.mean(means)), full * float(np.std(means, ddof=1)) / SETS**0.5)


def _meets(body: Body, lower: np.ndarray, upper: np.ndarray) -> bool:
    """Return True if the bounding box of a body overlaps a given box."""
    low, high = body.bounds
    return bool((high > lower).all() and (low < upper).all())


def _apart(bodies: list[Body], lower: np.ndarray, upper: np.ndarray, scene: Scene) -> float | None:
    """Return the total volume of bodies, or None if bodies overlap or leave the box. A body may extend beyond
    a periodic face. Each set of periodic images contributes one volume.
    """
    periodic, lengths = np.array(scene.container.periodic), np.array(scene.container.lengths)
    total = 0.0
    for n, body in enumerate(bodies):
        low, high = body.bounds
        if not (periodic | ((low >= lower) & (high <= upper))).all() or (high - low > lengths).any():
            return None
        if not all(body.is_apart(other) for other in bodies[:n]):
            return None
        middle = 0.5 * (low + high)
        total += body.volume * bool((~periodic | ((middle >= 0.0) & (middle < lengths))).all())
    return total


def free_fraction(
    parts: list[Ball | Slab], axes: list[int], ends: tuple[np.ndarray, np.ndarray], shift: int
) -> float:
    """Return the mean fraction of the length of `LINES` lines that is outside all bodies. The lines are
    parallel to the first of the `axes`. They are evenly spread over the other axes, and shifted at random.
    `shift`: index of the random shift.
    """
    (lower, upper), across = ends, axes[1:]
    steps = SPREADING[len(across)] ** -np.arange(1.0, len(across) + 1)
    random = np.random.default_rng(shift).random(len(across))
    points = np.tile(lower, (LINES, 1))
    coordinates = (np.multiply.outer(np.arange(LINES), steps) + random) % 1.0
    points[:, across] += coordinates * (upper - lower)[across]
    return float(free_lengths(parts, points, axes[0], ends).mean() / (upper - lower)[axes[0]])


def free_lengths(
    parts: list[Ball | Slab], points: np.ndarray, axis: int, ends: tuple[np.ndarray, np.ndarray]
) -> np.ndarray:
    """Return the length outside all bodies of each line through points (M, d). The lines are parallel to an
    axis, and extend between the coordinates `ends`, (d,) each.
    """
    low, high = (float(end[axis]) for end in ends)
    lines, starts, stops = [], [], []
    across = [k for k in range(points.shape[1]) if k != axis]
    for body in parts:
        least, most = body.bounds
        near = np.flatnonzero(((points >= least) & (points <= most))[:, across].all(axis=1))
        start, stop = (np.clip(end, low, high) for end in body.interval(points[near], axis))
        hit = start < stop
        lines.append(near[hit])
        starts.append(start[hit])
        stops.append(stop[hit])
    line, start, stop = (np.concatenate(each) for each in (lines, starts, stops))
    # A single coordinate for all lines: each line is a separate interval, after the intervals of the lines
    # before.
    stretch = 2.0 * (high - low)
    order = np.lexsort((start, line))
    line, start, stop = line[order], (start + line * stretch)[order], (stop + line * stretch)[order]
    reached = np.maximum.accumulate(stop) if len(stop) else stop
    before = np.concatenate([[-np.inf], reached[:-1]])
    covered = np.maximum(stop - np.maximum(start, before), 0.0)
    return np.maximum((high - low) - np.bincount(line, covered, len(points)), 0.0)
