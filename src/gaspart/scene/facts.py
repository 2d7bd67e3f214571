"""Facts of a scene: properties that follow from the keys of a `Scene`.

Each fact has one definition, and is computed once. Observables, theory, tallies, rejections and advice read
these properties by name, and do not compute them again. All facts are attributes of a `Scene`: container,
faces and particles in `composition`, motion, flow and conservation in `Facts`. The accessible volume and
areas for particle centres are in `accessible`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from gaspart.errors import SceneError
from gaspart.scene.boundaries import capacity
from gaspart.scene.composition import Composition
from gaspart.scene.faces import Open, Piston, Vibrating
from gaspart.scene.features import FEATURES
from gaspart.scene.sizes import ball_volume
from gaspart.scene.surfaces import Thermal
from gaspart.scene.walls import MovingWall, moving_wall_among


@dataclass(frozen=True)
class Gas:
    """Identical, smooth and elastic particles that collide only with each other and with hard faces."""

    dimension: int
    packing_fraction: float
    count: int
    diameter: float
    temperature: float
    mass: float = 1.0

    @property
    def thermal_speed(self) -> float:
        """Thermal speed sqrt(k_B T / m)."""
        return math.sqrt(self.temperature / self.mass)

    @property
    def particle(self) -> dict[str, float]:
        """Diameter, temperature and mass, as keyword arguments for functions of `gaspart.theory`."""
        return {"diameter": self.diameter, "temperature": self.temperature, "mass": self.mass}

    @property
    def parameters(self) -> dict[str, Any]:
        """Entries of `particle`, with packing_fraction and dimension."""
        return {"packing_fraction": self.packing_fraction, "dimension": self.dimension, **self.particle}


@dataclass(frozen=True)
class Mixture:
    """Smooth, elastic particles of any sizes and masses that hit each other and hard faces only."""

    dimension: int
    packing_fraction: float
    counts: tuple[int, ...]
    diameters: tuple[float, ...]
    masses: tuple[float, ...]
    temperature: float

    @property
    def sizes(self) -> tuple[float, int, tuple[float, ...], tuple[int, ...]]:
        """Packing fraction, dimension, diameters and counts as arguments of `gaspart.theory`."""
        return self.packing_fraction, self.dimension, self.diameters, self.counts

    def thin(self, most: int) -> Mixture:
        """Return a mixture with every k-th size only, so that at most `most` sizes remain. This approximation
        is valid for the sizes of one species.
        """
        step = -(-len(self.counts) // most)
        kept = slice(step // 2, None, step)
        sizes = self.counts[kept], self.diameters[kept], self.masses[kept]
        return Mixture(self.dimension, self.packing_fraction, *sizes, self.temperature)


def mixture_of(scene: Composition) -> Mixture | None:
    """Return the mixture of a scene; see `Scene.mixture`."""
    counts, diameters, masses = [], [], []
    kinds = [kind for kind in scene.kinds if kind.count]
    for kind in kinds:
        sizes = [kind.radius] if kind.alike else kind.radii.tolist()
        counts += [kind.count // len(sizes)] * len(sizes)
        diameters += [2.0 * radius for radius in sizes]
        masses += [kind.mass] * len(sizes)
    if not kinds:
        return None
    energies = (kind.count * kind.initial_temperature(scene.dimension) for kind in kinds)
    parts = tuple(counts), tuple(diameters), tuple(masses)
    return Mixture(scene.dimension, scene.packing_fraction, *parts, sum(energies) / scene.count)


_CONTACT = 0.01
"""Default duration of a contact, in units of sqrt(d/g)."""
_STEADY = frozenset(("walls", "polydispersity", "centres_to_walls"))
"""Features that leave the total kinetic energy of flight at its initial value."""


class Facts(Composition):
    """Base class of `Scene` with the facts of a scene as attributes; d is the dimension."""

    @cached_property
    def features(self) -> frozenset[str]:
        """Names of the scene's features, keys of `features.FEATURES`."""
        return frozenset(name for name, feature in FEATURES.items() if feature.value(self) is not None)

    @cached_property
    def capacity(self) -> int:
        """Maximum number of particles at any time: `count`, unless faces are open."""
        return capacity(self)

    @cached_property
    def gas(self) -> Gas | None:
        """Plain gas equivalent to the scene, at the temperature of the initial velocities. The property has
        no value (None) if the scene is empty, has particles of several sizes or masses, or has any feature
        except `centres_to_walls`.
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
    def mixture(self) -> Mixture | None:
        """Mixture of plain gases that is equivalent to the scene. The property has no value (None) if the
        scene is empty, or has any feature except `polydispersity` and `centres_to_walls`.
        """
        if self.features - {"polydispersity", "centres_to_walls"}:
            return None
        return mixture_of(self)

    @cached_property
    def contact_duration(self) -> float:
        """Time after a contact of a particle during which its further contacts are elastic. The time is 0 if
        all contacts dissipate energy (`Restitution`). Under gravity g the default is 0.01 sqrt(d/g), where d
        is the smallest diameter.
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
    def driven_axes(self) -> tuple[int, ...]:
        """Periodic axes along which gravity acts on all particles and drives a flow."""
        pulls = zip(self.gravity or (), self.container.periodic, strict=False)
        return tuple(axis for axis, (pull, around) in enumerate(pulls) if pull != 0.0 and around)

    @cached_property
    def drags_faces(self) -> bool:
        """True if runs tally the momentum that particles transfer parallel to faces. This momentum is tallied
        for faces that give particles random tangential velocities. The condition is that one of these faces
        slides, or that a force drives the gas along them.
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
        """True if the gas tends to a state at one temperature in which nothing flows. Nothing moves or drives
        the gas, contacts lose no energy, and all faces and reservoirs are equal.
        """
        moved = self.moving_axes or self.sliding_faces or self.driven_axes or self.shear_rate is not None
        reservoirs = {(face.activity, face.temperature) for _, face in self.faces_of(Open)}
        vacuum = any(not activity for activity, _ in reservoirs)
        unequal = len(self.face_temperatures) > 1 or len(reservoirs) > 1 or vacuum
        return not (moved or unequal or self.dissipates or self.thermostat is not None)

    @cached_property
    def flow_changes(self) -> bool:
        """True if the flow of the gas changes with time. The flow changes if a face or an interior wall moves
        along its normal, or if faces are open.
        """
        return bool(self.moving_axes) or self.is_open

    @cached_property
    def flow_axes(self) -> tuple[int, ...]:
        """Axes along which the velocity of the gas may vary. If all of the gas moves with one velocity, there
        are no such axes. The function `analysis.flow` adds this common velocity, because it depends on the
        run and not on a key of the scene.
        """
        if self.flow_changes:
            return self.moving_axes or self.open_axes
        across = tuple(sorted({number // 2 for number, _ in self.sliding_faces}))
        return self.resolved_axes(across) if across or self.driven_axes else ()

    def resolved_axes(self, across: tuple[int, ...] = ()) -> tuple[int, ...]:
        """Return the axes along which a steady flow may vary. If there are obstacles, these are all axes.
        Otherwise they are `across`, the axes of the faces that drive the flow. The default of `across` is all
        axes with walls, or the first axis if there are no walls.
        """
        if self.has_obstacles:
            return tuple(range(self.dimension))
        return across or self.walled_axes or (0,)

    @cached_property
    def dragged_axes(self) -> tuple[bool, ...]:
        """Flags (d,) of the axes along which faces across other axes exert forces. Such faces draw tangential
        velocities, or particles are rough.
        """
        drags = {number // 2 for number, face in self.numbered_faces if not face.smooth}
        drags.update(self.walled_axes if self.rough else ())
        return tuple(bool(drags - {axis}) for axis in range(self.dimension))

    @cached_property
    def conserved_axes(self) -> tuple[bool, ...]:
        """Flags (d,) of the axes along which the total momentum is conserved. Momentum is conserved along the
        periodic axes if no particle is fixed, if no face exerts forces along itself, and if the only interior
        wall, if any, is a moving wall. In a sheared gas the momentum is relative to the flow.
        """
        free = not (self.has_fixed or (bool(self.walls) and self.moving_wall is None))
        axes = zip(self.container.periodic, self.dragged_axes, strict=True)
        return tuple(free and around and not dragged for around, dragged in axes)

    @cached_property
    def shares_energy_evenly(self) -> bool:
        """True if the kinetic energy of flight is constant, with equal parts in all directions. This holds in
        equilibrium for smooth, elastic particles without a potential or a source of heat.
        """
        return self.features <= _STEADY


def plain_gas(scene: Facts) -> Gas:
    """Return `Scene.gas`; raise SceneError, with the reason, if the scene is not a plain gas."""
    if scene.gas is not None:
        return scene.gas
    rule = "a gas of equal, smooth and elastic particles alone is needed"
    _refuse_others(scene, rule, {"centres_to_walls"})
    raise SceneError("species", len(scene.kinds), f"{rule}: their radii or masses differ")


def plain_mixture(scene: Facts) -> Mixture:
    """Return `Scene.mixture`; raise SceneError, with the reason, if the scene is not a plain mixture."""
    if scene.mixture is None:
        rule = "smooth and elastic particles alone are needed"
        _refuse_others(scene, rule, {"polydispersity", "centres_to_walls"})
    assert scene.mixture is not None
    return scene.mixture


def _refuse_others(scene: Facts, rule: str, allowed: set[str]) -> None:
    """Raise SceneError if a scene is empty, or has a feature that is not allowed."""
    if not scene.count:
        raise SceneError("count", 0, f"{rule}: the scene is empty")
    present = scene.features - allowed
    for name in FEATURES:
        if name in present:
            raise FEATURES[name].refuse(scene, f"{rule}, without {FEATURES[name].meaning}")
