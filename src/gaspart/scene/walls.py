"""Walls inside a container, fixed or moving."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from gaspart.errors import SceneError
from gaspart.keys import declare, documented, positive, two_vectors, validate, vector
from gaspart.keys.values import finite_vector, positive_number

if TYPE_CHECKING:
    from gaspart.scene.container import Container


# Moving wall across the container: a piston between two gases.


class MovingWall(NamedTuple):
    """Moving wall: axis of motion, coordinate on this axis at time 0, and mass."""

    axis: int
    position: float
    mass: float


MOVING_WALL = "walls[0]"
"""Key of a moving wall; it is the only interior wall."""


def moving_wall_among(walls: Sequence[Wall | Plate], lengths: tuple[float, ...]) -> MovingWall | None:
    """Return the interior wall that moves; None if there is no such wall."""
    for wall in walls:
        if wall.mass is not None:
            axis = crossed_axis(wall, lengths)
            return MovingWall(axis, next(iter(wall.corners.values()))[axis], wall.mass)
    return None


def crossed_axis(wall: Wall | Plate, lengths: tuple[float, ...]) -> int:
    """Return the axis perpendicular to a wall across the whole container, or -1 for other walls."""
    for axis, _ in enumerate(lengths):
        coordinates = [{corner[k] for corner in wall.corners.values()} for k in range(len(lengths))]
        is_spanning = all(coordinates[k] == {0.0, length} for k, length in enumerate(lengths) if k != axis)
        if is_spanning and len(coordinates[axis]) == 1:
            return axis
    return -1


_TEMPERATURE = positive(
    "temperature of the wall [energy], from which velocities are drawn; without it it is hard"
)
_MASS = positive("mass of a wall across the container that particles move [mass]; without it it is at rest")
WALL_RULE = "a Wall needs a container of two dimensions, a Plate one of three"


@documented
@dataclass(frozen=True)
class Wall:
    """A straight wall inside a container of two dimensions, which particles hit from both sides.

    The ends of the wall are solid: particles hit them too.

    Raises
    ------
    SceneError
        If a value is invalid, or the wall has no length.

    See Also
    --------
    Plate : A wall inside a container of three dimensions.

    Examples
    --------
    >>> import gaspart as gp
    >>> wall = gp.Wall(start=(2.0, 0.0), end=(2.0, 6.0))
    >>> scene = gp.Scene(gp.Container((10.0, 10.0)), walls=[wall])
    >>> scene.walls[0].distance((5.0, 10.0))
    5.0
    """

    start: tuple[float, ...] = field(metadata=declare(vector("one end [length]", 2, sized=False)))
    end: tuple[float, ...] = field(metadata=declare(vector("the other end [length]", 2, sized=False)))
    temperature: float | None = field(default=None, metadata=declare(_TEMPERATURE))
    mass: float | None = field(default=None, metadata=declare(_MASS))

    def __post_init__(self) -> None:
        validate(self)
        if self.start == self.end:
            raise SceneError("end", self.end, "a wall must have a length; for a post use a fixed particle")
        positive_number("length", math.dist(self.start, self.end))

    @property
    def corners(self) -> dict[str, tuple[float, ...]]:
        """Coordinates of both ends of the wall, by their keys."""
        return {"start": self.start, "end": self.end}

    def distance(self, point: tuple[float, ...]) -> float:
        """Return the distance of a point from the wall, its ends included.

        Parameters
        ----------
        point : tuple of float, shape (2,), [length]
            Coordinates of the point.

        Returns
        -------
        float
            The distance, in [length].
        """
        (ax, ay), (bx, by), (x, y) = self.start, self.end, point
        s = ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / ((bx - ax) ** 2 + (by - ay) ** 2)
        s = min(max(s, 0.0), 1.0)
        return math.hypot(x - ax - s * (bx - ax), y - ay - s * (by - ay))


@documented
@dataclass(frozen=True)
class Plate:
    """A flat rectangular wall inside a container of three dimensions, which particles hit from both sides.

    The edges and the corners of the plate are solid: particles hit them too.

    A plate with a `mass` must extend across the whole container, perpendicular to an axis. It starts at rest.
    Only hits of particles change the velocity of the plate, which is along this axis. In each hit the plate
    and the particle exchange momentum without loss of energy (E. H. Lieb, Physica A 263, 491 (1999)). The
    plate conducts heat only by its motion. There must be no other interior wall. There must be particles on
    both sides, and all particles must be smooth and elastic.

    Raises
    ------
    SceneError
        If a value is invalid, an edge has no length, or the edges are not at right angles.

    See Also
    --------
    Wall : A wall inside a container of two dimensions.

    Examples
    --------
    >>> import gaspart as gp
    >>> plate = gp.Plate(corner=(2.0, 0.0, 0.0), edges=((0.0, 4.0, 0.0), (0.0, 0.0, 4.0)))
    >>> plate.distance((5.0, 2.0, 2.0))
    3.0
    """

    corner: tuple[float, ...] = field(metadata=declare(vector("one corner [length]", 3, sized=False)))
    edges: tuple[tuple[float, ...], ...] = field(
        metadata=declare(
            two_vectors(
                "vectors from this corner to the two neighbouring corners [length], at right angles", 3
            )
        )
    )
    temperature: float | None = field(default=None, metadata=declare(_TEMPERATURE))
    mass: float | None = field(default=None, metadata=declare(_MASS))

    def __post_init__(self) -> None:
        validate(self)
        first, second = self.edges
        sizes = math.hypot(*first), math.hypot(*second)
        if not min(sizes) > 0.0:
            raise SceneError("edges", self.edges, "a plate must have a length and a width")
        for length in sizes:
            positive_number("edges", length)
        if abs(sum(x * y for x, y in zip(first, second, strict=True))) > 1e-9 * sizes[0] * sizes[1]:
            raise SceneError("edges", self.edges, "must be at right angles")

    @property
    def corners(self) -> dict[str, tuple[float, ...]]:
        """Coordinates of the four corners, by the keys that determine them."""
        first, second = self.edges
        ends = {"edges[0]": (first,), "edges[1]": (second,), "edges": (first, second)}
        far = {key: tuple(map(sum, zip(self.corner, *edges, strict=True))) for key, edges in ends.items()}
        return {"corner": self.corner, **far}

    def distance(self, point: tuple[float, ...]) -> float:
        """Return the distance of a point from the plate, its rim included.

        Parameters
        ----------
        point : tuple of float, shape (3,), [length]
            Coordinates of the point.

        Returns
        -------
        float
            The distance, in [length].
        """
        away = [x - y for x, y in zip(point, self.corner, strict=True)]
        for edge in self.edges:
            along = sum(x * y for x, y in zip(away, edge, strict=True)) / sum(x * x for x in edge)
            share = min(max(along, 0.0), 1.0)
            away = [x - share * y for x, y in zip(away, edge, strict=True)]
        return math.hypot(*away)


def box_of_walls(lower: tuple[float, ...], upper: tuple[float, ...]) -> tuple[Wall | Plate, ...]:
    """Return the four walls of a rectangle, or the six walls of a cuboid."""
    low = finite_vector("lower", lower)
    high = finite_vector("upper", upper, len(low))
    if len(low) == 2:
        (x, y), (u, v) = low, high
        corners = ((x, y), (u, y), (u, v), (x, v))
        return tuple(Wall(corners[n], corners[(n + 1) % 4]) for n in range(4))
    plates = []
    for corner, opposite in ((low, high), (high, low)):
        edges = [tuple(opposite[k] - corner[k] if k == n else 0.0 for k in range(3)) for n in range(3)]
        plates += [Plate(corner, (edges[n], edges[(n + 1) % 3])) for n in range(3)]
    return tuple(plates)


def wall_kind(container: Container) -> type[Wall] | type[Plate]:
    """Return the class of interior walls for the dimension of a container."""
    return Wall if container.dimension == 2 else Plate
