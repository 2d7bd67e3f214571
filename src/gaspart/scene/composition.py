"""Keys of a scene, and the facts about its container, its faces and its particles."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TypeVar

from gaspart.scene.container import Container
from gaspart.scene.faces import GRADIENT, LeesEdwards, Piston
from gaspart.scene.restitution import Restitution, Thermostat
from gaspart.scene.sizes import CLOSE_PACKING, ball_volume
from gaspart.scene.species import Particle, Species
from gaspart.scene.surfaces import FACES, Sticky, Surface, Thermal
from gaspart.scene.walls import Plate, Wall

S = TypeVar("S", bound=Surface)


class Composition:
    """Container, faces and particles of a scene, without its motion; d is the dimension."""

    container: Container
    species: Sequence[Species]
    particles: Sequence[Particle]
    centres_to_walls: bool
    gravity: tuple[float, ...] | None
    restitution: Restitution | None
    walls: Sequence[Wall | Plate]
    faces: dict[str, Surface]
    thermostat: Thermostat | None

    @cached_property
    def dimension(self) -> int:
        """Number of dimensions, 2 or 3."""
        return self.container.dimension

    @cached_property
    def is_periodic(self) -> bool:
        """True if all axes are periodic."""
        return all(self.container.periodic)

    @cached_property
    def walled_axes(self) -> tuple[int, ...]:
        """Axes that are not periodic, and therefore have a face at each end."""
        return tuple(axis for axis, around in enumerate(self.container.periodic) if not around)

    @cached_property
    def image_axes(self) -> tuple[bool, ...]:
        """Flags (d,) of the axes whose periodic images are at fixed distances. Such images are displaced by
        exactly the length of the container. All periodic axes have fixed images, with one exception: in a
        sheared gas, the images along the gradient move.
        """
        sheared = self.shear_rate is not None
        return tuple(
            around and not (sheared and axis == GRADIENT)
            for axis, around in enumerate(self.container.periodic)
        )

    @cached_property
    def numbered_faces(self) -> tuple[tuple[int, Surface], ...]:
        """Faces that have a kind, with their indices, in ascending order."""
        names = enumerate(FACES[: 2 * self.dimension])
        return tuple((n, self.faces[name]) for n, name in names if name in self.faces)

    @cached_property
    def _faces_by_kind(self) -> dict[type[Surface], list[tuple[int, Surface]]]:
        """Faces of each kind, with their indices."""
        faces: dict[type[Surface], list[tuple[int, Surface]]] = {}
        for number, face in self.numbered_faces:
            faces.setdefault(type(face), []).append((number, face))
        return faces

    def faces_of(self, kind: type[S]) -> list[tuple[int, S]]:
        """Return the faces of a kind, with their indices."""
        return self._faces_by_kind.get(kind, [])  # type: ignore[return-value]

    @cached_property
    def pistons(self) -> list[tuple[int, Piston]]:
        """Faces that are pistons, with their indices; at most one face."""
        return self.faces_of(Piston)

    @cached_property
    def sliding_faces(self) -> list[tuple[int, Thermal]]:
        """Faces that slide parallel to themselves, with their indices."""
        return [(n, face) for n, face in self.faces_of(Thermal) if face.slides]

    @cached_property
    def partial_faces(self) -> list[tuple[int, Thermal]]:
        """Faces that do not draw velocities after every hit, with their indices."""
        return [(n, face) for n, face in self.faces_of(Thermal) if face.accommodation is not None]

    @cached_property
    def ramps(self) -> list[tuple[int, Thermal]]:
        """Faces whose temperature varies along them, with their indices."""
        return [(n, face) for n, face in self.faces_of(Thermal) if face.varies_along is not None]

    @cached_property
    def thermal_numbers(self) -> list[int]:
        """Indices of the faces at a temperature, including wells whose wall has a temperature."""
        return [n for n, face in self.numbered_faces if face.rule[0] in ("thermal", "thermal_normal")]

    @cached_property
    def drawing_numbers(self) -> list[int]:
        """Indices of faces that draw all velocity components, and therefore exert tangential forces."""
        return [n for n, face in self.numbered_faces if face.rule[0] == "thermal"]

    @cached_property
    def face_temperatures(self) -> frozenset[float]:
        """Temperatures of all thermal faces and interior walls. If the temperature of a face varies, both
        ends count.
        """
        warm = {wall.temperature for wall in self.walls if wall.temperature is not None}
        return frozenset(warm.union(*(face.temperatures for face in self.faces.values())))

    @cached_property
    def kinds(self) -> tuple[Species | Particle, ...]:
        """Species, then single particles: all objects with a radius and a mass."""
        return (*self.species, *self.particles)

    @cached_property
    def moving_kinds(self) -> tuple[Species | Particle, ...]:
        """Elements of `kinds` that have at least one particle and are not fixed."""
        return tuple(kind for kind in self.kinds if kind.count and not kind.fixed)

    @cached_property
    def count(self) -> int:
        """Number of particles; with open faces, the initial number."""
        return sum(kind.count for kind in self.kinds)

    @cached_property
    def moving_count(self) -> int:
        """Number of particles that are not fixed."""
        return sum(kind.count for kind in self.moving_kinds)

    @cached_property
    def has_fixed(self) -> bool:
        """True if any particle is fixed."""
        return any(kind.fixed and kind.count for kind in self.kinds)

    @cached_property
    def has_obstacles(self) -> bool:
        """True if fixed particles or interior walls are inside the container."""
        return self.has_fixed or bool(self.walls)

    @cached_property
    def number_density(self) -> float:
        """Number of particles divided by the volume (2D: area) of the container."""
        return self.count / self.container.volume

    @cached_property
    def packing_fraction(self) -> float:
        """Volume (3D) or area (2D) of all particles divided by the volume of the container."""
        particles = sum(particle.radius**self.dimension for particle in self.particles)
        species = sum(kind.total_power(self.dimension) for kind in self.species)
        return ball_volume(self.dimension) * (particles + species) / self.container.volume

    @cached_property
    def largest_radius(self) -> float:
        """Largest radius of a particle; 0 in an empty scene."""
        return max((kind.largest_radius for kind in self.kinds if kind.count), default=0.0)

    @cached_property
    def smallest_radius(self) -> float:
        """Smallest radius of a particle; 0 in an empty scene."""
        return min((kind.smallest_radius for kind in self.kinds if kind.count), default=0.0)

    @cached_property
    def largest_moving_radius(self) -> float:
        """Largest radius of a particle that is not fixed; 0 if all particles are fixed."""
        return max((kind.largest_radius for kind in self.moving_kinds), default=0.0)

    @cached_property
    def has_unequal_areas(self) -> bool:
        """True if moving particles of different sizes can reach different areas of faces."""
        many = len({kind.radius for kind in self.moving_kinds}) > 1
        sizes = many or not all(kind.alike for kind in self.moving_kinds)
        beside = len(self.walled_axes) > 1 and not self.centres_to_walls
        return sizes and (beside or (bool(self.walled_axes) and self.has_obstacles))

    @cached_property
    def alike(self) -> bool:
        """True if all particles have the same radius and the same mass."""
        kinds = [kind for kind in self.kinds if kind.count]
        return len({(kind.radius, kind.mass) for kind in kinds}) < 2 and all(kind.alike for kind in kinds)

    @cached_property
    def shear_rate(self) -> float | None:
        """Gradient du_x / dy between sheared faces (`LeesEdwards`); None if there are no such faces."""
        return next((face.shear_rate for _, face in self.faces_of(LeesEdwards)), None)

    @cached_property
    def vibrates(self) -> bool:
        """True if a particle may store energy in a vibration. Only fixed particles, and particles that stick
        to a face, can vibrate.
        """
        return bool(self.faces_of(Sticky)) or any(kind.vibrates for kind in self.kinds)

    @cached_property
    def closest_packing(self) -> float:
        """Largest possible packing fraction: exact for particles of one size, otherwise the upper bound 1."""
        kinds = [kind for kind in self.kinds if kind.count]
        alike = len({kind.radius for kind in kinds}) < 2 and all(kind.alike for kind in kinds)
        return CLOSE_PACKING[self.dimension] if alike else 1.0

    def reach(self, radius: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Return the lowest and the highest coordinates (d,) that the centre of a particle can have."""
        lower, upper = [], []
        for length, periodic in zip(self.container.lengths, self.container.periodic, strict=True):
            margin = 0.0 if periodic or self.centres_to_walls else radius
            lower.append(margin)
            upper.append(length - margin)
        return tuple(lower), tuple(upper)
