"""Simulated system: a container and its contents, without any computed result.

A `Scene` is immutable and validated once, when it is created. Units of length and time are free; masses are
relative to the reference species; k_B = 1.
"""

from __future__ import annotations

import html
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, is_dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

import gaspart
from gaspart.errors import SceneError
from gaspart.keys import (
    declare,
    describe,
    documented,
    field_values,
    flag,
    from_mapping,
    instance_of,
    instances_of,
    refuse_unknown,
    set_fields,
    validate,
    vector,
)
from gaspart.keys.values import MOST_PARTICLES, finite_vector
from gaspart.scene.checks import (
    check_driven,
    check_faces,
    check_features,
    check_open_faces,
    check_packing,
    check_region,
    check_room,
    check_walls,
)
from gaspart.scene.container import Container
from gaspart.scene.faces import SCHEMA as FACES_SCHEMA
from gaspart.scene.faces import surface_from_dict, surface_to_dict
from gaspart.scene.facts import Facts
from gaspart.scene.features import FEATURES
from gaspart.scene.restitution import Restitution, Thermostat
from gaspart.scene.sizes import Nearby, rounding
from gaspart.scene.species import SHARED, Particle, Species
from gaspart.scene.surfaces import Surface, key_of
from gaspart.scene.walls import WALL_RULE, Plate, Wall, wall_kind
from gaspart.yaml_text import read_yaml, write_yaml

THUMBNAIL = (480, 360)
"""Size in pixels of the picture of a scene in a notebook."""
DRAWN = 20_000
"""Maximum number of particles for which this picture is drawn, because all particles must first be placed."""
# keys that are written to a file only if they are present
_ABSENT = ("fixed", "exact_temperature", "walls", "faces")


@documented
@dataclass(frozen=True)
class Scene(Facts):
    """The system to simulate: a container, its particles and everything that acts on them.

    A scene is immutable and is validated when it is created. In all arrays the single `particles` come first,
    in their order, followed by the particles of each of the `species`.

    Units of length and time are free; masses are relative to the reference species; k_B = 1.

    Literature: R. Frederickx and P. Meerts (2010), whose spheres stick out of the container.

    Raises
    ------
    SceneError
        If the scene is impossible, for example if particles overlap or two features exclude each other.

    See Also
    --------
    Simulation : Simulate a scene in memory.
    run : Simulate a scene and write a trajectory.

    Examples
    --------
    A disc in a box under gravity, to which fifty small discs are added:

    >>> import gaspart as gp
    >>> disc = gp.Particle(position=(10.0, 10.0), velocity=(1.0, 0.0), radius=1.0)
    >>> scene = gp.Scene(gp.Container((20.0, 20.0)), particles=[disc], gravity=(0.0, -1.0))
    >>> scene.summary
    '1 disc in 20 x 20, packing fraction 0.00785; gravity'
    >>> scene.with_species(gp.Species(count=50, radius=0.2)).count
    51
    """

    container: Container = field(metadata=declare(instance_of(Container, "the simulated volume")))
    species: Sequence[Species] = field(
        default=(),
        metadata=declare(instances_of("particles placed by the program", Species, rule="must be a Species")),
    )
    particles: Sequence[Particle] = field(
        default=(),
        metadata=declare(instances_of("particles at given positions", Particle, rule="must be a Particle")),
    )
    centres_to_walls: bool = field(
        default=False,
        metadata=declare(flag("walls stop centres, not surfaces, of particles")),
    )
    gravity: tuple[float, ...] | None = field(
        default=None,
        metadata=declare(
            vector("(d,) uniform acceleration; along a periodic axis it drives a flow [length/time^2]")
        ),
    )
    restitution: Restitution | None = field(
        default=None,
        metadata=declare(instance_of(Restitution, "the law of all contacts; without it elastic and smooth")),
    )
    walls: Sequence[Wall | Plate] = field(
        default=(), metadata=declare(instances_of("walls inside the container", Wall, Plate, rule=WALL_RULE))
    )
    faces: dict[str, Surface] = field(
        default_factory=dict,
        hash=False,
        metadata=declare(
            describe(
                FACES_SCHEMA,
                "kinds of faces by name, `x_low`, `x_high`, `y_low` ...; others are hard or periodic,"
                " as the container states",
            )
        ),
    )

    thermostat: Thermostat | None = field(
        default=None,
        metadata=declare(instance_of(Thermostat, "random kicks that give energy; without it there are none")),
    )

    def __post_init__(self) -> None:
        validate(self)
        if isinstance(self.faces, dict):
            set_fields(self, faces={key_of(name): face for name, face in self.faces.items()})
        if self.count > MOST_PARTICLES:
            raise SceneError("count", self.count, f"must be at most {MOST_PARTICLES}")
        self._check_gravity()
        check_walls(self)
        check_faces(self)
        check_features(self)
        check_open_faces(self)
        check_driven(self)
        for n, kind in enumerate(self.species):
            if kind.count:
                self._fits(f"species[{n}].radius", kind)
            check_region(self.container, f"species[{n}].region", kind)
        arrangements = {kind.arrangement for kind in self.species}
        for shared in arrangements & set(SHARED):
            beside = {"random"} if shared == "lattice" and not self.particles else set()
            if self.particles or arrangements - beside != {shared}:
                raise SceneError("arrangement", shared, "is shared by all particles of a scene")
        earlier = Nearby(
            self.container, max((2.0 * particle.radius for particle in self.particles), default=0.0)
        )
        for n, particle in enumerate(self.particles):
            self._check_particle(n, particle, earlier)
            earlier.add(n, particle.position)
        check_packing(self)

    def _check_gravity(self) -> None:
        """Check the acceleration; a zero vector means no gravity."""
        if self.gravity is None:
            return
        finite_vector("gravity", self.gravity, self.dimension)
        if not any(self.gravity):  # absent everywhere, so that no other code has to test for this value
            set_fields(self, gravity=None)
            return

    def wall_at(self, position: tuple[float, ...], radius: float) -> str | None:
        """Return the key, such as "walls[0]", of an interior wall that a particle overlaps, or None."""
        shifts = [
            (0.0, -length, length) if periodic else (0.0,)
            for length, periodic in zip(self.container.lengths, self.container.periodic, strict=True)
        ]
        for n, wall in enumerate(self.walls):
            corners = [abs(x) for corner in wall.corners.values() for x in corner]
            for shift in product(*shifts):
                image = tuple(x + distance for x, distance in zip(position, shift, strict=True))
                if wall.distance(image) < radius - rounding(image, *corners, radius):
                    return f"walls[{n}]"
        return None

    def _fits(self, key: str, particle: Particle | Species) -> None:
        """Raise SceneError if a single particle or a species does not fit into the container."""
        check_room(self.container, self.centres_to_walls, key, particle)

    def _check_particle(self, n: int, particle: Particle, earlier: Nearby) -> None:
        """Raise SceneError for a particle that is outside, or overlaps a wall or another particle. The
        particle is compared only with `earlier` particles.
        """
        where = f"particles[{n}]"
        finite_vector(f"{where}.position", particle.position, self.dimension)
        finite_vector(f"{where}.velocity", particle.velocity, self.dimension)
        self._fits(f"{where}.radius", particle)
        lower, upper = self.reach(particle.radius)
        for x, low, high in zip(particle.position, lower, upper, strict=True):
            slack = rounding((x,), high, particle.radius)
            if not low - slack <= x <= high + slack:
                raise SceneError(
                    f"{where}.position", particle.position, "must be completely inside the container"
                )
        if wall := self.wall_at(particle.position, particle.radius):
            raise SceneError(f"{where}.position", particle.position, f"overlaps {wall}")
        for m in earlier.neighbours(particle.position):
            other = self.particles[m]
            contact = particle.radius + other.radius
            slack = rounding((*particle.position, *other.position), contact)
            if self.separation(particle.position, other.position) < contact - slack:
                raise SceneError(f"{where}.position", particle.position, f"overlaps particles[{m}]")

    def separation(self, a: tuple[float, ...], b: tuple[float, ...]) -> float:
        """Return the distance between two points (d,); on periodic axes, to the nearest image."""
        square = 0.0
        for x, y, length, periodic in zip(a, b, self.container.lengths, self.container.periodic, strict=True):
            gap = abs(x - y)
            square += min(gap, length - gap) ** 2 if periodic else gap**2
        return math.sqrt(square)

    def with_particles(self, *particles: Particle) -> Scene:
        """Return a new scene with these particles added; raise SceneError if it is impossible."""
        return replace(self, particles=(*self.particles, *particles))

    def with_species(self, *species: Species) -> Scene:
        """Return a new scene with these species added; raise SceneError if it is impossible."""
        return replace(self, species=(*self.species, *species))

    def with_walls(self, *walls: Wall | Plate) -> Scene:
        """Return a new scene with these interior walls added; raise SceneError if it is impossible."""
        return replace(self, walls=(*self.walls, *walls))

    @property
    def summary(self) -> str:
        """Summary of the scene in one line: number of particles, container, packing fraction, features."""
        kind = {2: "disc", 3: "sphere"}[self.dimension] + ("s" if self.count != 1 else "")
        sides = " x ".join(f"{length:g}" for length in self.container.lengths)
        text = f"{self.count} {kind} in {sides}, packing fraction {self.packing_fraction:.3g}"
        present = sorted(self.features)
        return text + (f"; {', '.join(FEATURES[name].meaning for name in present)}" if present else "")

    def _repr_html_(self) -> str:
        """Return a picture of the scene at time 0, with its `summary` as a caption."""
        if self.count > DRAWN:
            return html.escape(self.summary)
        try:
            return gaspart.render(self, size=THUMBNAIL).figure(self.summary)
        except SceneError as error:  # the particles do not fit
            return html.escape(f"{self.summary}. {error}")

    def to_dict(self) -> dict:
        """Return the scene as plain lists and mappings, as in a scene file."""

        def plain(value: Any) -> Any:
            if is_dataclass(value):
                value = field_values(value)
            if isinstance(value, dict):
                return {k: plain(x) for k, x in value.items() if x is not None and (x or k not in _ABSENT)}
            return [plain(item) for item in value] if isinstance(value, tuple) else value

        faces = {name: surface_to_dict(surface) for name, surface in self.faces.items()}
        return plain({**field_values(self), "faces": faces})

    @classmethod
    def from_dict(cls, mapping: dict, file: str | None = None) -> Scene:
        """Return the scene that a mapping describes, the inverse of `to_dict`.

        Parameters
        ----------
        mapping : dict
            Keys of the scene with their values.
        file : str, optional
            Name of the file in messages.

        Returns
        -------
        Scene
            The scene.

        Raises
        ------
        SceneError
            If the mapping does not describe a scene; the message names `file`.

        Examples
        --------
        >>> import gaspart as gp
        >>> gp.Scene.from_dict({"container": {"lengths": [9.0, 9.0]}}).container.boundary
        ('wall', 'wall')
        """
        try:
            if not isinstance(mapping, dict):
                raise SceneError("scene", mapping, "must be a mapping of keys to values")
            parts = dict(mapping)
            refuse_unknown(cls, parts, "scene")
            if "container" not in parts:
                raise SceneError("container", None, "is required")
            parts["container"] = from_mapping(Container, parts["container"], "container")
            if parts.get("restitution") is not None:
                parts["restitution"] = from_mapping(Restitution, parts["restitution"], "restitution")
            if parts.get("thermostat") is not None:
                parts["thermostat"] = from_mapping(Thermostat, parts["thermostat"], "thermostat")
            if isinstance(parts.get("faces"), dict):
                faces = parts["faces"].items()
                parts["faces"] = {name: surface_from_dict(face, f"faces.{name}") for name, face in faces}
            wall = wall_kind(parts["container"])
            for key, kind in (("species", Species), ("particles", Particle), ("walls", wall)):
                items = parts.get(key, ())
                if not isinstance(items, (list, tuple)):
                    raise SceneError(key, items, "must be a list")
                parts[key] = tuple(from_mapping(kind, item, f"{key}[{n}]") for n, item in enumerate(items))
            return from_mapping(cls, parts, "scene")
        except SceneError as error:
            raise SceneError(error.key.removeprefix("scene."), error.value, error.rule, file) from None

    @classmethod
    def from_file(cls, path: str | Path) -> Scene:
        """Read a YAML scene file, or the scene in a file that a page of `gaspart play` has saved.

        Parameters
        ----------
        path : str or Path
            The file.

        Returns
        -------
        Scene
            The scene.

        Raises
        ------
        SceneError
            If the file cannot be read, or does not describe a scene.

        Examples
        --------
        >>> import gaspart as gp
        >>> gp.Scene(gp.Container((9.0, 9.0))).to_file("empty.yaml")
        >>> gp.Scene.from_file("empty.yaml").container.lengths
        (9.0, 9.0)
        """
        content = read_yaml(path)
        of_page = isinstance(content, dict) and {"scene", "state"} <= content.keys()
        return cls.from_dict(content["scene"] if of_page else content, file=str(path))

    def to_file(self, path: str | Path) -> None:
        """Write the scene as YAML.

        Parameters
        ----------
        path : str or Path
            The file.

        Raises
        ------
        SceneError
            If the file cannot be written.
        """
        write_yaml(path, self.to_dict())


def require_scene(value: object) -> None:
    """Raise SceneError for a value that is not a `Scene`, such as a file's path."""
    if not isinstance(value, Scene):
        raise SceneError("scene", value, "must be a Scene, such as Scene.from_file(path)")
