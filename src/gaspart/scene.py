"""What is simulated: a container, the bodies in it, and nothing that is computed.

A `Scene` is immutable and validated once, when it is made. Lengths and times are in the scene's own
units; masses are relative to the reference species; k_B = 1.
"""

from __future__ import annotations

import math
import numbers
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path

from gaspart.errors import SceneError
from gaspart.files import read_yaml, write_yaml

BOUNDARIES = ("wall", "periodic")
ARRANGEMENTS = ("random", "lattice")


def number(
    key: str, value: object, rule: str, *, above: float = -math.inf, least: float = -math.inf
) -> float:
    """`value` as a finite float greater than `above` and at least `least`, or a SceneError with `rule`."""
    if isinstance(value, bool) or not isinstance(value, numbers.Real) or not math.isfinite(value):
        raise SceneError(key, value, rule)
    if not (value > above and value >= least):
        raise SceneError(key, value, rule)
    return float(value)


def count_of(key: str, value: object, least: int = 0) -> int:
    """`value` as an integer of at least `least`."""
    rule = f"must be a whole number of at least {least}"
    if number(key, value, rule, least=least) != int(value):
        raise SceneError(key, value, rule)
    return int(value)


def vector(key: str, value: object, dimension: int | None = None) -> tuple[float, ...]:
    """`value` as a tuple of finite floats, of length `dimension` where that is known."""
    size = f"{dimension} " if dimension else ""
    rule = f"must be a list of {size}finite numbers"
    if isinstance(value, str) or not hasattr(value, "__iter__"):
        raise SceneError(key, value, rule)
    numbers_ = tuple(number(key, x, rule) for x in value)
    if dimension is not None and len(numbers_) != dimension:
        raise SceneError(key, value, rule)
    return numbers_


def settle(instance, **values) -> None:
    """Write the validated `values` into a frozen dataclass that is being made."""
    for name, value in values.items():
        object.__setattr__(instance, name, value)


def from_mapping(cls, mapping: object, where: str):
    """Make the dataclass `cls` from a mapping whose keys must all be fields of it."""
    if not isinstance(mapping, dict):
        raise SceneError(where, mapping, "must be a mapping of keys to values")
    known = {f.name: f for f in fields(cls)}
    for key in mapping:
        if key not in known:
            raise SceneError(f"{where}.{key}", mapping[key], f"unknown key; known are {', '.join(known)}")
    for name, field in known.items():
        if name not in mapping and field.default is field.default_factory:  # both MISSING: no default
            raise SceneError(f"{where}.{name}", None, "is required")
    try:
        return cls(**mapping)
    except SceneError as error:
        raise error.inside(where) from None


@dataclass(frozen=True)
class Container:
    """The simulated volume [0, L] on each axis.

    lengths: (d,) side lengths, d = 2 or 3; boundary: "wall" or "periodic", or one of them per axis.
    """

    lengths: tuple[float, ...]
    boundary: str | tuple[str, ...] = "wall"

    def __post_init__(self):
        lengths = vector("lengths", self.lengths)
        if len(lengths) not in (2, 3):
            raise SceneError("lengths", self.lengths, "a container has 2 or 3 sides")
        for length in lengths:
            number("lengths", length, "every side must be positive", above=0.0)
        given = self.boundary
        boundary = (given,) * len(lengths) if isinstance(given, str) else given
        if not isinstance(boundary, (tuple, list)) or len(boundary) != len(lengths):
            raise SceneError("boundary", given, f"must be one of {BOUNDARIES}, or a list of one per axis")
        for kind in boundary:
            if kind not in BOUNDARIES:
                raise SceneError("boundary", given, f"must be one of {BOUNDARIES}, or a list of one per axis")
        settle(self, lengths=lengths, boundary=tuple(boundary))

    @property
    def dimension(self) -> int:
        return len(self.lengths)

    @property
    def volume(self) -> float:
        return math.prod(self.lengths)

    @property
    def periodic(self) -> tuple[bool, ...]:
        """(d,) whether each axis is periodic."""
        return tuple(kind == "periodic" for kind in self.boundary)


@dataclass(frozen=True)
class Species:
    """`count` like bodies, placed by the program.

    Velocities are isotropic: of one fixed `speed`, or Maxwellian at `temperature`; with neither the bodies
    start at rest. `arrangement` is "random" (sequential insertion) or "lattice".
    """

    count: int
    radius: float
    mass: float = 1.0
    speed: float | None = None
    temperature: float | None = None
    arrangement: str = "random"

    def __post_init__(self):
        settle(
            self,
            count=count_of("count", self.count),
            radius=number("radius", self.radius, "must be positive", above=0.0),
            mass=number("mass", self.mass, "must be positive", above=0.0),
        )
        for key in ("speed", "temperature"):
            if getattr(self, key) is not None:
                value = number(key, getattr(self, key), "must not be negative", least=0.0)
                settle(self, **{key: value})
        if self.speed is not None and self.temperature is not None:
            raise SceneError("temperature", self.temperature, "give speed or temperature, not both")
        if self.arrangement not in ARRANGEMENTS:
            raise SceneError("arrangement", self.arrangement, f"must be one of {ARRANGEMENTS}")


@dataclass(frozen=True)
class Body:
    """One body at a stated place: position (d,), velocity (d,), radius, mass."""

    position: tuple[float, ...]
    velocity: tuple[float, ...]
    radius: float
    mass: float = 1.0

    def __post_init__(self):
        settle(
            self,
            position=vector("position", self.position),
            velocity=vector("velocity", self.velocity),
            radius=number("radius", self.radius, "must be positive", above=0.0),
            mass=number("mass", self.mass, "must be positive", above=0.0),
        )


@dataclass(frozen=True)
class Scene:
    """A container and its bodies: first `bodies` in their order, then each of `species` in turn.

    With `centres_to_walls` the walls stop the bodies' centres instead of their surfaces (the rule of
    Frederickx & Meerts 2010, whose spheres stick out of the container).

    Raises SceneError for a scene that cannot be.
    """

    container: Container
    species: tuple[Species, ...] = ()
    bodies: tuple[Body, ...] = ()
    centres_to_walls: bool = False

    def __post_init__(self):
        settle(self, species=tuple(self.species), bodies=tuple(self.bodies))
        if not isinstance(self.centres_to_walls, bool):
            raise SceneError("centres_to_walls", self.centres_to_walls, "must be true or false")
        for n, kind in enumerate(self.species):
            if kind.count:
                self._fits(f"species[{n}].radius", kind.radius)
        if any(kind.arrangement == "lattice" for kind in self.species):
            if self.bodies or any(kind.arrangement != "lattice" for kind in self.species):
                raise SceneError("arrangement", "lattice", "a lattice is shared by all bodies of a scene")
        for n, body in enumerate(self.bodies):
            self._check_body(n, body)
        if self.packing_fraction > math.pi / math.sqrt(12 if self.dimension == 2 else 18):
            if not self.centres_to_walls:
                raise SceneError("packing_fraction", self.packing_fraction, "exceeds close packing")

    def _fits(self, key: str, radius: float) -> None:
        shortest = min(self.container.lengths)
        if not self.centres_to_walls and 2 * radius > shortest:
            rule = f"a body must fit into the container, whose shortest side is {shortest:g}"
            raise SceneError(key, radius, rule)

    def _check_body(self, n: int, body: Body) -> None:
        where = f"bodies[{n}]"
        vector(f"{where}.position", body.position, self.dimension)
        vector(f"{where}.velocity", body.velocity, self.dimension)
        self._fits(f"{where}.radius", body.radius)
        lower, upper = self.reach(body.radius)
        for x, low, high in zip(body.position, lower, upper, strict=True):
            if not low <= x <= high:
                raise SceneError(f"{where}.position", body.position, "must lie wholly inside the container")
        for m, other in enumerate(self.bodies[:n]):
            if self.separation(body.position, other.position) < body.radius + other.radius:
                raise SceneError(f"{where}.position", body.position, f"overlaps bodies[{m}]")

    @property
    def dimension(self) -> int:
        return self.container.dimension

    @property
    def count(self) -> int:
        """The number of bodies."""
        return len(self.bodies) + sum(kind.count for kind in self.species)

    @property
    def number_density(self) -> float:
        return self.count / self.container.volume

    @property
    def packing_fraction(self) -> float:
        """Volume (3D) or area (2D) of all bodies over that of the container."""
        unit = math.pi if self.dimension == 2 else 4 / 3 * math.pi
        bodies = sum(body.radius**self.dimension for body in self.bodies)
        species = sum(kind.count * kind.radius**self.dimension for kind in self.species)
        return unit * (bodies + species) / self.container.volume

    @property
    def largest_radius(self) -> float:
        """The largest radius of any body (0 in an empty scene)."""
        sizes = [body.radius for body in self.bodies] + [kind.radius for kind in self.species if kind.count]
        return max(sizes, default=0.0)

    @property
    def smallest_radius(self) -> float:
        """The smallest radius of any body (0 in an empty scene)."""
        sizes = [body.radius for body in self.bodies] + [kind.radius for kind in self.species if kind.count]
        return min(sizes, default=0.0)

    def reach(self, radius: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """(d,), (d,): the lowest and highest coordinates of the centre of a body of this radius."""
        lower, upper = [], []
        for length, periodic in zip(self.container.lengths, self.container.periodic, strict=True):
            margin = 0.0 if periodic or self.centres_to_walls else radius
            lower.append(margin)
            upper.append(length - margin)
        return tuple(lower), tuple(upper)

    def separation(self, a: tuple[float, ...], b: tuple[float, ...]) -> float:
        """Distance of two points, by the nearest image on periodic axes."""
        square = 0.0
        for x, y, length, periodic in zip(a, b, self.container.lengths, self.container.periodic, strict=True):
            gap = abs(x - y)
            square += min(gap, length - gap) ** 2 if periodic else gap**2
        return math.sqrt(square)

    def with_bodies(self, *bodies: Body) -> Scene:
        """A new scene with these bodies added."""
        return replace(self, bodies=self.bodies + bodies)

    def with_species(self, *species: Species) -> Scene:
        """A new scene with these species added."""
        return replace(self, species=self.species + species)

    def to_dict(self) -> dict:
        """Plain lists and mappings, as they stand in a scene file."""

        def plain(value):
            if isinstance(value, dict):
                return {key: plain(item) for key, item in value.items() if item is not None}
            return [plain(item) for item in value] if isinstance(value, tuple) else value

        return plain(asdict(self))

    @classmethod
    def from_dict(cls, mapping: dict, file: str | None = None) -> Scene:
        """The scene that `to_dict` describes. Raises SceneError, naming `file`, for anything else."""
        try:
            if not isinstance(mapping, dict):
                raise SceneError("scene", mapping, "must be a mapping of keys to values")
            parts = dict(mapping)
            if "container" not in parts:
                raise SceneError("container", None, "is required")
            parts["container"] = from_mapping(Container, parts["container"], "container")
            for key, kind in (("species", Species), ("bodies", Body)):
                items = parts.get(key, ())
                if not isinstance(items, (list, tuple)):
                    raise SceneError(key, items, "must be a list")
                parts[key] = tuple(from_mapping(kind, item, f"{key}[{n}]") for n, item in enumerate(items))
            return from_mapping(cls, parts, "scene")
        except SceneError as error:
            raise SceneError(error.key.removeprefix("scene."), error.value, error.rule, file) from None

    @classmethod
    def from_file(cls, path: str | Path) -> Scene:
        """Read a YAML scene file."""
        return cls.from_dict(read_yaml(path), file=str(path))

    def to_file(self, path: str | Path) -> None:
        """Write the scene as YAML."""
        write_yaml(path, self.to_dict())
