"""What stands in a container: species and single bodies, and the law of their contacts."""

from __future__ import annotations

import math
from dataclasses import dataclass

from gaspart.errors import SceneError
from gaspart.validation import (
    LARGEST,
    MOST_BODIES,
    SMALLEST,
    choice,
    count_of,
    flag,
    not_negative,
    number,
    positive,
    settle,
    size,
    vector,
)

LATTICES = ("lattice", "slab")
SHARED = (*LATTICES, "compressed")
"""Arrangements that all bodies of a scene share."""
ARRANGEMENTS = ("random", *SHARED)


def _check_matter(thing: Species | Body) -> None:
    """What species and bodies have in common: radius, mass, moment of inertia, fixed, vibration."""
    settle(thing, radius=positive("radius", thing.radius), mass=positive("mass", thing.mass))
    if thing.moment_of_inertia is not None:
        value = number("moment_of_inertia", thing.moment_of_inertia, "must be positive", above=0.0)
        if not SMALLEST <= value / thing.mass / thing.radius**2 <= LARGEST:
            rule = f"must be from {SMALLEST:g} to {LARGEST:g} times the mass times the radius squared"
            raise SceneError("moment_of_inertia", value, rule)
        settle(thing, moment_of_inertia=value)
    flag("fixed", thing.fixed)
    if thing.vibration is not None:
        settle(thing, vibration=not_negative("vibration", thing.vibration))
        if not thing.fixed:
            raise SceneError("vibration", thing.vibration, "only a fixed body vibrates")


@dataclass(frozen=True)
class Species:
    """`count` like bodies, placed by the program.

    Velocities are isotropic: of one fixed `speed`, or Maxwellian at `temperature`; with neither the bodies
    start at rest. `arrangement` is "random" (sequential insertion), "lattice", "slab": a
    lattice whose empty sites all lie in one half, so that this half melts, or "compressed": grown among one
    another to a density beyond that of insertion (see `compression`). moment_of_inertia: by
    default that of a uniform disc or sphere. A `fixed` body never moves: it has infinite mass. With a
    `vibration`, the energy at the start, or a `temperature`, it has one mode of vibration: a contact swaps
    that energy with the normal energy of the other body.
    """

    count: int
    radius: float
    mass: float = 1.0
    speed: float | None = None
    temperature: float | None = None
    arrangement: str = "random"
    moment_of_inertia: float | None = None
    fixed: bool = False
    vibration: float | None = None

    def __post_init__(self) -> None:
        settle(self, count=count_of("count", self.count, most=MOST_BODIES))
        _check_matter(self)
        for key in ("speed", "temperature"):
            if getattr(self, key) is not None:
                settle(self, **{key: not_negative(key, getattr(self, key))})
        if self.speed is not None and self.temperature is not None:
            raise SceneError("temperature", self.temperature, "give speed or temperature, not both")
        if self.fixed and self.speed:
            raise SceneError("speed", self.speed, "a fixed species has none")
        if self.vibration is not None and self.temperature is not None:
            raise SceneError("temperature", self.temperature, "give vibration or temperature, not both")
        choice("arrangement", self.arrangement, ARRANGEMENTS)

    @property
    def vibrates(self) -> bool:
        """Whether its bodies have a mode of vibration."""
        return self.fixed and (self.vibration is not None or self.temperature is not None)


@dataclass(frozen=True)
class Body:
    """One body at a stated place: position (d,), velocity (d,), radius, mass; spin, its angular velocity (a
    number in 2D, (3,) in 3D); moment_of_inertia, fixed and vibration as in `Species`."""

    position: tuple[float, ...]
    velocity: tuple[float, ...]
    radius: float
    mass: float = 1.0
    spin: float | tuple[float, ...] | None = None
    moment_of_inertia: float | None = None
    fixed: bool = False
    vibration: float | None = None

    def __post_init__(self) -> None:
        settle(
            self,
            position=vector("position", self.position),
            velocity=vector("velocity", self.velocity),
        )
        size("velocity", self.velocity)
        _check_matter(self)
        if self.spin is not None:
            flat = len(self.position) == 2
            spin = number("spin", self.spin, "must be a number") if flat else vector("spin", self.spin, 3)
            size("spin", spin)
            settle(self, spin=spin)
        for key, value in (("velocity", self.velocity), ("spin", self.spin_vector)):
            if self.fixed and any(value):
                raise SceneError(key, value, "a fixed body has none")

    @property
    def vibrates(self) -> bool:
        """Whether it has a mode of vibration."""
        return self.vibration is not None

    @property
    def spin_vector(self) -> tuple[float, ...]:
        """(3,) the spin as a vector, which in 2D stands on the plane."""
        if self.spin is None:
            return 0.0, 0.0, 0.0
        return self.spin if isinstance(self.spin, tuple) else (0.0, 0.0, self.spin)


@dataclass(frozen=True)
class Restitution:
    """What a contact does to the relative velocity of the two surfaces: its normal part is multiplied by
    -`normal`, from 0 (they stick) to 1 (elastic), its tangential part by -`tangential`, from -1 (perfectly
    smooth) to 1 (perfectly rough). Spencer 2022, Eq. 22."""

    normal: float = 1.0
    tangential: float = -1.0

    def __post_init__(self) -> None:
        for key, least in (("normal", 0.0), ("tangential", -1.0)):
            rule = f"must be from {least:g} to 1"
            settle(self, **{key: number(key, getattr(self, key), rule, least=least, most=1.0)})

    @property
    def smooth_and_elastic(self) -> bool:
        """Whether contacts are those of a scene without a Restitution."""
        return self.normal == 1.0 and self.tangential == -1.0

    @property
    def rough(self) -> bool:
        """Whether contacts change spins."""
        return self.tangential > -1.0


@dataclass(frozen=True)
class Wall:
    """A straight wall inside a container of two dimensions, from `start` (2,) to `end` (2,): hit from both
    sides, and at its ends, which are solid."""

    start: tuple[float, ...]
    end: tuple[float, ...]

    def __post_init__(self) -> None:
        settle(self, start=vector("start", self.start, 2), end=vector("end", self.end, 2))
        if self.start == self.end:
            raise SceneError("end", self.end, "a wall must have a length; for a post take a fixed body")
        positive("length", math.dist(self.start, self.end))

    @property
    def corners(self) -> dict[str, tuple[float, ...]]:
        """Both ends, by their keys."""
        return {"start": self.start, "end": self.end}

    def distance(self, point: tuple[float, ...]) -> float:
        """How far a point is from the wall, its ends included."""
        (ax, ay), (bx, by), (x, y) = self.start, self.end, point
        s = ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / ((bx - ax) ** 2 + (by - ay) ** 2)
        s = min(max(s, 0.0), 1.0)
        return math.hypot(x - ax - s * (bx - ax), y - ay - s * (by - ay))


@dataclass(frozen=True)
class Plate:
    """A flat rectangular wall inside a container of three dimensions: a `corner` (3,), and the `edges` (2, 3)
    that lead from it, at right angles. Hit from both sides, at its edges and its corners, which are solid."""

    corner: tuple[float, ...]
    edges: tuple[tuple[float, ...], ...]

    def __post_init__(self) -> None:
        rule = "must be two lists of 3 numbers"
        if not isinstance(self.edges, (tuple, list)) or len(self.edges) != 2:
            raise SceneError("edges", self.edges, rule)
        one, other = (vector(f"edges[{n}]", edge, 3) for n, edge in enumerate(self.edges))
        settle(self, corner=vector("corner", self.corner, 3), edges=(one, other))
        sizes = math.hypot(*one), math.hypot(*other)
        if not min(sizes) > 0.0:
            raise SceneError("edges", self.edges, "a plate must have a length and a width")
        for length in sizes:
            positive("edges", length)
        if abs(sum(x * y for x, y in zip(one, other, strict=True))) > 1e-9 * sizes[0] * sizes[1]:
            raise SceneError("edges", self.edges, "must be at right angles")

    @property
    def corners(self) -> dict[str, tuple[float, ...]]:
        """The four corners, by the key that places each."""
        one, other = self.edges
        ends = {"edges[0]": (one,), "edges[1]": (other,), "edges": (one, other)}
        far = {key: tuple(map(sum, zip(self.corner, *edges, strict=True))) for key, edges in ends.items()}
        return {"corner": self.corner, **far}

    def distance(self, point: tuple[float, ...]) -> float:
        """How far a point is from the plate, its rim included."""
        away = [x - y for x, y in zip(point, self.corner, strict=True)]
        for edge in self.edges:
            along = sum(x * y for x, y in zip(away, edge, strict=True)) / sum(x * x for x in edge)
            share = min(max(along, 0.0), 1.0)
            away = [x - share * y for x, y in zip(away, edge, strict=True)]
        return math.hypot(*away)


def box_of_walls(lower: tuple[float, ...], upper: tuple[float, ...]) -> tuple[Wall | Plate, ...]:
    """The four walls of a rectangle, or the six of a cuboid, given two opposite corners."""
    low = vector("lower", lower)
    high = vector("upper", upper, len(low))
    if len(low) == 2:
        (x, y), (u, v) = low, high
        corners = ((x, y), (u, y), (u, v), (x, v))
        return tuple(Wall(corners[n], corners[(n + 1) % 4]) for n in range(4))
    plates = []
    for corner, opposite in ((low, high), (high, low)):
        edges = [tuple(opposite[k] - corner[k] if k == n else 0.0 for k in range(3)) for n in range(3)]
        plates += [Plate(corner, (edges[n], edges[(n + 1) % 3])) for n in range(3)]
    return tuple(plates)
