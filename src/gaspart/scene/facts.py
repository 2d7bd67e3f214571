"""Facts of a scene: properties that follow from the keys of a `Scene`.

Each fact has one definition, and is computed once. Observables, theory, tallies, rejections and advice read
these properties by name, and do not compute them again. All facts are attributes of a `Scene`:

- faces: `numbered_faces`, `faces_of(kind)`, `pistons`, `sliding_faces`, `partial_faces`, `ramps`,
  `thermal_numbers`, `drawing_numbers`, `face_temperatures`;
- container: `dimension`, `is_periodic`, `walled_axes`, `image_axes`;
- matter: `kinds`, `moving_kinds`, `count`, `moving_count`, `capacity`, `has_fixed`, `has_obstacles`, `alike`,
  `has_unequal_areas`, `largest_radius`, `smallest_radius`, `largest_moving_radius`, `number_density`,
  `packing_fraction`, `gas`, `mixture`;
- motion: `is_open`, `open_axes`, `moving_axes`, `moving_wall`, `has_piston`, `load_axis`, `shear_rate`,
  `driven_axes`, `flow_axes`, `flow_changes`, `frame_velocity`, `drags_faces`, `dragged_axes`,
  `conserved_axes`, `has_equilibrium`, `dissipates`, `vibrates`, `rough`;
- `features`, the names of its features.

The accessible volume and areas for particle centres are in `accessible`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, TypeVar

from gaspart.scene.container import Container
from gaspart.scene.driving import Thermostat
from gaspart.scene.face_checks import capacity
from gaspart.scene.faces import (
    FACES,
    GRADIENT,
    LeesEdwards,
    Open,
    Piston,
    Sticky,
    Surface,
    Thermal,
    Vibrating,
)
from gaspart.scene.features import FEATURES
from gaspart.scene.gas import Gas, Mixture, mixture_of
from gaspart.scene.limits import ball_volume
from gaspart.scene.restitution import Restitution
from gaspart.scene.species import Particle, Species
from gaspart.scene.walls import MovingWall, Plate, Wall, moving_wall_among

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene

S = TypeVar("S", bound=Surface)
_CONTACT = 0.01
"""Default duration of a contact, in units of sqrt(d/g)."""


class Facts:
    """Base class of `Scene` with the facts of a scene as attributes; d is the dimension."""

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
    def features(self: Scene) -> frozenset[str]:  # type: ignore[misc]
        """Names of the scene's features, keys of `features.FEATURES`."""
        return frozenset(name for name, feature in FEATURES.items() if feature.value(self) is not None)

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
        """Flags (d,) of the axes whose periodic images are at fixed distances.

        Such images are displaced by exactly the length of the container. All periodic axes have fixed images,
        with one exception: in a sheared gas, the images along the gradient move.
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
        """Temperatures of all thermal faces and interior walls.

        If the temperature of a face varies, both ends count.
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
    def capacity(self: Scene) -> int:  # type: ignore[misc]
        """Maximum number of particles at any time: `count`, unless faces are open."""
        return capacity(self)

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
    def gas(self: Scene) -> Gas | None:  # type: ignore[misc]
        """Plain gas equivalent to the scene, at the temperature of the initial velocities.

        The property has no value (None) if the scene is empty, has particles of several sizes or masses, or
        has any feature except `centres_to_walls`.
        """
        kinds = [kind for kind in self.kinds if kind.count]
        if not kinds or not self.alike or self.features - {"centres_to_walls"}:
            return None
        kind, dimension, count = kinds[0], self.dimension, self.count
        temperature = kind.initial_temperature(dimension)
        if len(kinds) > 1:
            temperature = sum(each.count * each.initial_temperature(dimension) for each in kinds) / count
        fraction = count * ball_volume(dimension, kind.radius) / self.container.volume
        return Gas(dimension, fraction, count, 2.0 * kind.radius, temperature, kind.mass)

    @cached_property
    def mixture(self: Scene) -> Mixture | None:  # type: ignore[misc]
        """Mixture of plain gases that is equivalent to the scene.

        The property has no value (None) if the scene is empty, or has any feature except `polydispersity` and
        `centres_to_walls`.
        """
        if self.features - {"polydispersity", "centres_to_walls"}:
            return None
        return mixture_of(self)

    @cached_property
    def contact_duration(self) -> float:
        """Time after a contact of a particle during which its further contacts are elastic.

        The time is 0 if all contacts dissipate energy (`Restitution`). Under gravity g the default is 0.01
        sqrt(d/g), where d is the smallest diameter.
        """
        law = self.restitution
        if law is None or not law.dissipative:
            return 0.0
        if law.contact_duration is not None:
            return law.contact_duration
        if self.gravity is None:
            return 0.0
        return _CONTACT * math.sqrt(2.0 * self.smallest_radius / math.hypot(*self.gravity))

    @cached_property
    def rough(self) -> bool:
        """True if contacts change spins."""
        return self.restitution is not None and self.restitution.rough

    @cached_property
    def dissipates(self) -> bool:
        """True if contacts lose energy."""
        return self.restitution is not None and self.restitution.dissipative

    @cached_property
    def vibrates(self) -> bool:
        """True if a particle may store energy in a vibration.

        Only fixed particles, and particles that stick to a face, can vibrate.
        """
        return bool(self.faces_of(Sticky)) or any(kind.vibrates for kind in self.kinds)

    @cached_property
    def is_open(self) -> bool:
        """True if the number of particles varies, through open faces."""
        return bool(self.faces_of(Open))

    @cached_property
    def open_axes(self) -> tuple[int, ...]:
        """Axes with an open face."""
        return tuple(sorted({number // 2 for number, _ in self.faces_of(Open)}))

    @cached_property
    def moving_wall(self) -> MovingWall | None:
        """Interior wall that moves, or None."""
        return moving_wall_among(self.walls, self.container.lengths)

    @cached_property
    def has_piston(self) -> bool:
        """True if a face is a piston, or an interior wall can move."""
        return bool(self.pistons) or self.moving_wall is not None

    @cached_property
    def load_axis(self) -> int | None:
        """Axis of the piston with an external pressure; None if there is no such piston."""
        return next((number // 2 for number, face in self.pistons if face.pressure is not None), None)

    @cached_property
    def moving_axes(self) -> tuple[int, ...]:
        """Axes along which a face or an interior wall moves and displaces the gas."""
        faces = {number // 2 for kind in (Piston, Vibrating) for number, _ in self.faces_of(kind)}
        return tuple(sorted(faces | ({self.moving_wall.axis} if self.moving_wall else set())))

    @cached_property
    def shear_rate(self) -> float | None:
        """Gradient du_x / dy between sheared faces (`LeesEdwards`); None if there are no such faces."""
        return next((face.shear_rate for _, face in self.faces_of(LeesEdwards)), None)

    @cached_property
    def driven_axes(self) -> tuple[int, ...]:
        """Periodic axes along which gravity acts on all particles and drives a flow."""
        pulls = zip(self.gravity or (), self.container.periodic, strict=False)
        return tuple(axis for axis, (pull, around) in enumerate(pulls) if pull != 0.0 and around)

    @cached_property
    def drags_faces(self) -> bool:
        """True if runs tally the momentum that particles transfer parallel to faces.

        This momentum is tallied for faces that give particles random tangential velocities. The condition is
        that one of these faces slides, or that a force drives the gas along them.
        """
        rubs = any(not face.smooth for face in self.faces.values())
        return bool(self.sliding_faces) or (rubs and bool(self.driven_axes))

    @cached_property
    def frame_velocity(self) -> tuple[float, ...]:
        """Mean velocity (d,) of the faces that drag particles along; 0 if no face slides."""
        dragging = [face.velocity for _, face in self.faces_of(Thermal) if not face.smooth]
        if not any(any(velocity or ()) for velocity in dragging):
            return (0.0,) * self.dimension
        parts = [velocity or (0.0,) * self.dimension for velocity in dragging]
        return tuple(math.fsum(component) / len(parts) for component in zip(*parts, strict=True))

    @cached_property
    def has_equilibrium(self) -> bool:
        """True if the gas tends to a state at one temperature in which nothing flows.

        Nothing moves or drives the gas, contacts lose no energy, and all faces and reservoirs are equal.
        """
        moved = self.moving_axes or self.sliding_faces or self.driven_axes or self.shear_rate is not None
        reservoirs = {(face.activity, face.temperature) for _, face in self.faces_of(Open)}
        vacuum = any(not activity for activity, _ in reservoirs)
        unequal = len(self.face_temperatures) > 1 or len(reservoirs) > 1 or vacuum
        return not (moved or unequal or self.dissipates or self.thermostat is not None)

    @cached_property
    def flow_changes(self) -> bool:
        """True if the flow of the gas changes with time.

        The flow changes if a face or an interior wall moves along its normal, or if faces are open.
        """
        return bool(self.moving_axes) or self.is_open

    @cached_property
    def flow_axes(self) -> tuple[int, ...]:
        """Axes along which the velocity of the gas may vary.

        If all of the gas moves with one velocity, there are no such axes. The function `analysis.flow` adds
        this common velocity, because it depends on the run and not on a key of the scene.
        """
        if self.flow_changes:
            return self.moving_axes or self.open_axes
        across = tuple(sorted({number // 2 for number, _ in self.sliding_faces}))
        return self.resolved_axes(across) if across or self.driven_axes else ()

    def resolved_axes(self, across: tuple[int, ...] = ()) -> tuple[int, ...]:
        """Return the axes along which a steady flow may vary.

        If there are obstacles, these are all axes. Otherwise they are `across`, the axes of the faces that
        drive the flow. The default of `across` is all axes with walls, or the first axis if there are no
        walls.
        """
        if self.has_obstacles:
            return tuple(range(self.dimension))
        return across or self.walled_axes or (0,)

    @cached_property
    def dragged_axes(self) -> tuple[bool, ...]:
        """Flags (d,) of the axes along which faces across other axes exert forces.

        Such faces draw tangential velocities, or particles are rough.
        """
        drags = {number // 2 for number, face in self.numbered_faces if not face.smooth}
        drags.update(self.walled_axes if self.rough else ())
        return tuple(bool(drags - {axis}) for axis in range(self.dimension))

    @cached_property
    def conserved_axes(self) -> tuple[bool, ...]:
        """Flags (d,) of the axes along which the total momentum is conserved.

        Momentum is conserved along the periodic axes if no particle is fixed, if no face exerts forces along
        itself, and if the only interior wall, if any, is a moving wall. In a sheared gas the momentum is
        relative to the flow.
        """
        free = not (self.has_fixed or (bool(self.walls) and self.moving_wall is None))
        axes = zip(self.container.periodic, self.dragged_axes, strict=True)
        return tuple(free and around and not dragged for around, dragged in axes)
