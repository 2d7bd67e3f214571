"""What is simulated: a container, the bodies in it, and nothing that is computed.

A `Scene` is immutable and validated once, when it is made. Lengths and times are in the scene's own
units; masses are relative to the reference species; k_B = 1.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from itertools import product
from pathlib import Path
from typing import Any

from gaspart.errors import SceneError
from gaspart.matter import SHARED, Body, Plate, Restitution, Species, Wall
from gaspart.room import Nearby, check_room
from gaspart.surfaces import Sticky, Thermal, Well, check_faces, surface_from_dict, surface_to_dict
from gaspart.validation import (
    MOST_BODIES,
    choice,
    count_of,
    flag,
    from_mapping,
    instances,
    number,
    positive,
    settle,
    size,
    vector,
)
from gaspart.yaml_text import read_yaml, write_yaml

__all__ = ["Body", "Container", "Restitution", "Scene", "Species", "Wall"]
__all__ += ["count_of", "from_mapping", "number"]

BOUNDARIES = ("wall", "periodic")
_TOUCH = 1e-12  # of a radius: by which a body that touches a wall may seem to overlap it
_ABSENT = ("fixed", "walls", "faces")  # not written into a file unless there


@dataclass(frozen=True)
class Container:
    """The simulated volume [0, L] on each axis.

    lengths: (d,) side lengths, d = 2 or 3; boundary: "wall" or "periodic", or one of them per axis.
    """

    lengths: tuple[float, ...]
    boundary: str | tuple[str, ...] = "wall"

    def __post_init__(self) -> None:
        lengths = vector("lengths", self.lengths)
        for length in lengths:
            positive("lengths", length)
        given = self.boundary
        boundary = (given,) * len(lengths) if isinstance(given, str) else given
        if not isinstance(boundary, (tuple, list)) or len(boundary) != len(lengths):
            raise SceneError("boundary", given, f"must be one of {BOUNDARIES}, or a list of one per axis")
        for kind in boundary:
            choice("boundary", kind, BOUNDARIES)
        settle(self, lengths=lengths, boundary=tuple(boundary))

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return len(self.lengths)

    @property
    def volume(self) -> float:
        """The container's volume, in two dimensions its area."""
        return math.prod(self.lengths)

    @property
    def periodic(self) -> tuple[bool, ...]:
        """(d,) whether each axis is periodic."""
        return tuple(kind == "periodic" for kind in self.boundary)


def _wall_kind(container: Container) -> type[Wall] | type[Plate]:
    """What stands in such a container as an interior wall."""
    return Wall if container.dimension == 2 else Plate


@dataclass(frozen=True)
class Scene:
    """A container and its bodies: first `bodies` in their order, then each of `species` in turn.

    With `centres_to_walls` the walls stop the bodies' centres instead of their surfaces (the rule of
    Frederickx & Meerts 2010, whose spheres stick out of the container). gravity: (d,) a uniform acceleration.
    restitution: the law of all contacts; without it they are elastic and smooth. walls: inside the
    container, each a Wall in two dimensions, a Plate in three. faces: kinds of the container's faces, by name
    (x_low, ...).

    Raises SceneError for a scene that cannot be.
    """

    container: Container
    species: Sequence[Species] = ()
    bodies: Sequence[Body] = ()
    centres_to_walls: bool = False
    gravity: tuple[float, ...] | None = None
    restitution: Restitution | None = None
    walls: Sequence[Wall | Plate] = ()
    faces: dict[str, Thermal | Well | Sticky] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        self._check_parts()
        if self.gravity is not None:
            self._check_gravity()
        if self.centres_to_walls and self.rough:
            rule = "rough bodies (tangential above -1) touch walls with their surfaces"
            raise SceneError("centres_to_walls", True, rule)
        self._check_walls()
        check_faces(self)
        if self.vibrates and self.restitution is not None and self.restitution.normal != 1.0:
            rule = "must be 1 where bodies vibrate, lest energy be lost twice"
            raise SceneError("restitution.normal", self.restitution.normal, rule)
        for n, kind in enumerate(self.species):
            if kind.count:
                self._fits(f"species[{n}].radius", kind)
        arrangements = {kind.arrangement for kind in self.species}
        for shared in arrangements & set(SHARED):
            if self.bodies or arrangements != {shared}:
                raise SceneError("arrangement", shared, "is shared by all bodies of a scene")
        earlier = Nearby(self.container, max((2.0 * body.radius for body in self.bodies), default=0.0))
        for n, body in enumerate(self.bodies):
            self._check_body(n, body, earlier)
            earlier.add(n, body.position)
        if self.packing_fraction > math.pi / math.sqrt(12 if self.dimension == 2 else 18):
            if not self.centres_to_walls:
                raise SceneError("packing_fraction", self.packing_fraction, "exceeds close packing")

    def _check_parts(self) -> None:
        """Every part is of its class; no part is compared with another one."""
        if not isinstance(self.container, Container):
            raise SceneError("container", self.container, "must be a Container")
        rule = "a Wall needs a container of two dimensions, a Plate one of three"
        settle(
            self,
            species=instances("species", self.species, Species, "must be a Species"),
            bodies=instances("bodies", self.bodies, Body, "must be a Body"),
            walls=instances("walls", self.walls, _wall_kind(self.container), rule),
        )
        if self.count > MOST_BODIES:
            raise SceneError("count", self.count, f"there may be {MOST_BODIES} bodies")
        if self.restitution is not None and not isinstance(self.restitution, Restitution):
            raise SceneError("restitution", self.restitution, "must be a Restitution")
        flag("centres_to_walls", self.centres_to_walls)

    def _check_gravity(self) -> None:
        pull = vector("gravity", self.gravity, self.dimension)
        size("gravity", pull)
        for component, periodic in zip(pull, self.container.periodic, strict=True):
            if component != 0.0 and periodic:
                rule = "must not point along a periodic axis, where bodies would gain energy for ever"
                raise SceneError("gravity", self.gravity, rule)
        settle(self, gravity=pull)

    def _check_walls(self) -> None:
        for n, wall in enumerate(self.walls):
            if self.centres_to_walls:
                raise SceneError("centres_to_walls", True, "interior walls stop the bodies' surfaces")
            for key, point in wall.corners.items():
                if not all(
                    0.0 <= x <= length for x, length in zip(point, self.container.lengths, strict=True)
                ):
                    raise SceneError(f"walls[{n}].{key}", point, "must lie inside the container")

    def wall_at(self, position: tuple[float, ...], radius: float) -> str | None:
        """The key of an interior wall that a body at this place overlaps, if any."""
        laps = [(0, -1, 1) if periodic else (0,) for periodic in self.container.periodic]
        for n, wall in enumerate(self.walls):
            for lap in product(*laps):
                image = tuple(
                    x + k * length for x, k, length in zip(position, lap, self.container.lengths, strict=True)
                )
                if wall.distance(image) < radius * (1.0 - _TOUCH):
                    return f"walls[{n}]"
        return None

    def _fits(self, key: str, thing: Body | Species) -> None:
        check_room(self.container, self.centres_to_walls, key, thing.radius, thing.fixed)

    def _check_body(self, n: int, body: Body, earlier: Nearby) -> None:
        where = f"bodies[{n}]"
        vector(f"{where}.position", body.position, self.dimension)
        vector(f"{where}.velocity", body.velocity, self.dimension)
        self._fits(f"{where}.radius", body)
        lower, upper = self.reach(body.radius)
        for x, low, high in zip(body.position, lower, upper, strict=True):
            if not low <= x <= high:
                raise SceneError(f"{where}.position", body.position, "must lie wholly inside the container")
        if wall := self.wall_at(body.position, body.radius):
            raise SceneError(f"{where}.position", body.position, f"overlaps {wall}")
        for m in earlier.around(body.position):
            other = self.bodies[m]
            if self.separation(body.position, other.position) < body.radius + other.radius:
                raise SceneError(f"{where}.position", body.position, f"overlaps bodies[{m}]")

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.container.dimension

    @property
    def kinds(self) -> tuple[Species | Body, ...]:
        """Whatever has a radius and a mass: all species, and all single bodies."""
        return (*self.species, *self.bodies)

    @property
    def rough(self) -> bool:
        """Whether contacts change spins."""
        return self.restitution is not None and self.restitution.rough

    @property
    def count(self) -> int:
        """The number of bodies."""
        return len(self.bodies) + sum(kind.count for kind in self.species)

    @property
    def vibrates(self) -> bool:
        """Whether any body may keep energy in a vibration: a fixed one, or one that sticks to a face."""
        sticky = any(isinstance(face, Sticky) for face in self.faces.values())
        return sticky or any(thing.vibrates for thing in self.kinds)

    @property
    def number_density(self) -> float:
        """Bodies per volume (area) of the container."""
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
        return replace(self, bodies=(*self.bodies, *bodies))

    def with_species(self, *species: Species) -> Scene:
        """A new scene with these species added."""
        return replace(self, species=(*self.species, *species))

    def with_walls(self, *walls: Wall | Plate) -> Scene:
        """A new scene with these walls added."""
        return replace(self, walls=(*self.walls, *walls))

    def to_dict(self) -> dict:
        """Plain lists and mappings, as they stand in a scene file."""

        def plain(value: Any) -> Any:
            if isinstance(value, dict):
                return {k: plain(x) for k, x in value.items() if x is not None and (x or k not in _ABSENT)}
            return [plain(item) for item in value] if isinstance(value, tuple) else value

        faces = {name: surface_to_dict(surface) for name, surface in self.faces.items()}
        return plain({**asdict(self), "faces": faces})

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
            if parts.get("restitution") is not None:
                parts["restitution"] = from_mapping(Restitution, parts["restitution"], "restitution")
            if isinstance(parts.get("faces"), dict):
                faces = parts["faces"].items()
                parts["faces"] = {name: surface_from_dict(face, f"faces.{name}") for name, face in faces}
            wall = _wall_kind(parts["container"])
            for key, kind in (("species", Species), ("bodies", Body), ("walls", wall)):
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
