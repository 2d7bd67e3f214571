"""Faces and interior walls: their arrays, energies, and events of those that move."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from gaspart.engines.features.part import Part
from gaspart.errors import SceneError, SimulationError
from gaspart.kernels import model as kernels
from gaspart.kernels.model import (
    NONE,
    STICKY,
    Faces,
    InteriorWalls,
    Model,
    Motion,
    MovingWall,
    Ramp,
    Sliding,
    WarmWalls,
)
from gaspart.kernels.obstacles.face import RULES
from gaspart.kernels.obstacles.moving import advance_piston, advance_wall
from gaspart.kernels.obstacles.opening import NUMBERS, schedule_first
from gaspart.kernels.physics.running_sum import values
from gaspart.scene.boundaries import attempt_rate
from gaspart.scene.faces import Open, Vibrating
from gaspart.scene.scene import Scene
from gaspart.scene.surfaces import FACES
from gaspart.scene.walls import MOVING_WALL
from gaspart.state.boxes import Boxes
from gaspart.state.initial import places_in_wells, well_energies, wells_of
from gaspart.state.insertion import wall_rows, walls_near
from gaspart.state.random import key_of
from gaspart.state.state import State

# Open faces: the particles in the container, and the reservoirs from which particles enter.


_ENTRY_DRAWS = 7  # stream number of these random numbers, after those of interior walls
_ARRAYS = "positions", "velocities", "images", "radii", "masses", "species", "spins", "moments_of_inertia"
"""Arrays of a `State` with one row per particle."""


def with_room(scene: Scene, state: State) -> State:
    """Return a state with entries for every possible particle, unused ones at NaN and at rest."""
    free = scene.capacity - state.count
    if free == 0:
        return state
    padded: dict[str, Any] = {}
    for key in _ARRAYS:
        values = getattr(state, key)
        padded[key] = np.concatenate([values, np.repeat(values[:1], free, axis=0)])
    padded["positions"][state.count :], padded["velocities"][state.count :] = np.nan, 0.0
    return replace(state, **padded)


def open_of(scene: Scene, state: State) -> kernels.Open | None:
    """Return the kernels' `Open` for a state with all numbers; None if no face is open."""
    if not scene.is_open:
        return None
    present = np.isfinite(state.positions[:, 0]).astype(np.uint8)
    blocks = -(-len(present) // NUMBERS)
    return kernels.Open(present, np.zeros(blocks, np.int64), np.zeros(2 * scene.dimension, np.int64))


def reservoirs_of(
    scene: Scene, seed: int | tuple[int, ...], inside: kernels.Open
) -> kernels.Reservoirs | None:
    """Return the reservoirs behind open faces; None if there is a vacuum behind all of them."""
    rates, widths = np.zeros((2, 2 * scene.dimension))
    for number, face in scene.faces_of(Open):
        if face.temperature is not None:
            widths[number] = math.sqrt(face.temperature / scene.species[0].mass)
            rates[number] = attempt_rate(scene, number, face)
    if not rates.any():
        return None
    up_to = np.cumsum(rates) / rates.sum()
    up_to[np.flatnonzero(rates)[-1] :] = 1.0  # safe for any rounding
    next_one = np.zeros(1, dtype=np.int64), np.full(1, np.inf), np.zeros(3)
    return kernels.Reservoirs(
        key_of(seed, _ENTRY_DRAWS), float(rates.sum()), up_to, widths, *next_one, inside
    )


def crowded_error(time: float, most: int) -> SimulationError:
    """Return the error for a run in which the container has more than `most` particles."""
    return SimulationError(f"at time {time:g} there is no room for more than {most} particles")


class OpenPart(Part):
    """Open faces of a scene. The arrays contain the particles in the container, the number of entries since
    the counters were reset, and the number and the time of the next attempted entry.
    """

    def __init__(self, scene: Scene, inside: kernels.Open, reservoirs: kernels.Reservoirs | None) -> None:
        self._scene, self._inside, self._reservoirs = scene, inside, reservoirs
        arrays, times = {"present": inside.present, "entries": inside.entries}, ()
        if reservoirs:
            arrays |= {"entry_number": reservoirs.number, "entry_next": reservoirs.time}
            times = (reservoirs.time,)
        super().__init__(arrays, times=times)

    def set_clock(self, clock: float) -> None:
        if self._reservoirs:
            schedule_first(self._reservoirs, clock)

    def begin_epoch(self, length: float, start: float, model: kernels.Model) -> kernels.Model:
        """Count the unused numbers, which a checkpoint does not contain."""
        absent = np.flatnonzero(self._inside.present == 0)
        self._inside.vacant[:] = np.bincount(absent // NUMBERS, minlength=len(self._inside.vacant))
        return model

    def write(self, state: State, clock: float) -> None:
        state.numbers = np.flatnonzero(self._inside.present)
        for key in _ARRAYS:
            setattr(state, key, getattr(state, key)[state.numbers])

    def reset(self, clock: float) -> None:
        self._inside.entries[:] = 0

    def counts(self, clock: float) -> dict[str, Any]:
        return {"entries": np.pad(self._inside.entries, (0, len(self._scene.walls)))}


# A face that is a piston.


_UNMOVED = 2.0**1000  # mass of a piston of prescribed speed: its velocity never changes
_OF_EPOCH = 2.0**-24  # time to the next collision with a resting particle, in epochs


def piston_of(scene: Scene, state: State, unit_mass: float) -> kernels.Piston | None:
    """Return the piston of a state, its mass in units of `unit_mass`; None without a piston."""
    if not scene.pistons or state.piston is None:
        return None
    ((n, face),) = scene.pistons
    x, velocity = state.piston
    inwards = (scene.container.lengths[n // 2] - x, -velocity) if n % 2 else (x, velocity)
    push = face.acceleration(scene, n // 2)
    mass = _UNMOVED if face.mass is None else face.mass / unit_mass
    return kernels.Piston(n, mass, push, np.array([*inwards, 0.0]), np.zeros(1))


class PistonPart(Part):
    """Piston of a scene; a hit adds at most twice its speed, prescribed or by its pressure, to a
    particle's.
    """

    def __init__(self, piston: kernels.Piston, scene: Scene) -> None:
        super().__init__({"piston": piston.motion})
        self._piston, self._lengths = piston, scene.container.lengths
        ((number, face),) = scene.pistons
        fallen = 2.0 * face.acceleration(scene, number // 2) * self._lengths[number // 2]
        self.gained = 4.0 * (fallen if face.speed is None else face.speed**2)

    def set_clock(self, clock: float) -> None:
        self._piston.motion[kernels.PISTON_CLOCK] = clock

    def begin_epoch(self, length: float, start: float, model: kernels.Model) -> kernels.Model:
        """Set the minimum speed at which particles separate from the piston."""
        self._piston.slowest[0] = 0.5 * self._piston.push * _OF_EPOCH * length
        return model

    def end_epoch(self, length: float, start: float) -> None:
        advance_piston(self._piston.motion, self._piston.push, length)
        self.set_clock(0.0)

    def write(self, state: State, clock: float) -> None:
        piston, motion = self._piston, self._piston.motion.copy()
        advance_piston(motion, piston.push, clock)
        position, velocity = motion[kernels.PISTON_PLACE], motion[kernels.PISTON_VELOCITY]
        upper = piston.face % 2 == 1
        state.piston = np.array(
            [self._lengths[piston.face // 2] - position, -velocity] if upper else [position, velocity]
        )


# Faces that vibrate.


# A particle that is pressed against the face collides with it again after a fraction of an epoch, or of the
# contact duration if this is longer. If the acceleration of the face presses the particle, a fraction of the
# period is used if it is shorter.
_HOP_OF_EPOCH, _OF_DURATION, _OF_PERIOD = 2.0**-24, 2.0**-3, 2.0**-15
_OF_SPEED = 2.0**-48  # minimum separation speed divided by the speed of the face


def motion_of(scene: Scene) -> Motion | None:
    """Return the motion of vibrating faces before the first epoch; None if no face vibrates."""
    moving = scene.faces_of(Vibrating)
    if not moving:
        return None
    shape = (2 * scene.dimension,)
    motion = Motion(
        stroke=np.zeros(shape),
        period=np.zeros(shape),
        sine=np.zeros(shape, dtype=bool),
        begun=np.zeros(shape),
        slowest=np.zeros(shape),
        epoch=np.zeros(1),
    )
    for n, face in moving:
        motion.stroke[n], motion.period[n] = 2.0 * face.amplitude, face.period
        motion.sine[n] = face.waveform == "sine"
    return motion


class VibratingPart(Part):
    """Faces with a prescribed vibration; a hit adds at most twice their speed to a particle's."""

    def __init__(self, scene: Scene, motion: Motion) -> None:
        super().__init__({})
        self._scene, self._motion, self._faces = scene, motion, scene.faces_of(Vibrating)
        self.gained = (2.0 * max(face.greatest_speed for _, face in self._faces)) ** 2

    def begin_epoch(self, length: float, start: float, model: Model) -> Model:
        """Continue the oscillation at time 0 of the clocks, by an exact remainder that does not drift."""
        scene, motion = self._scene, self._motion
        motion.epoch[0] = length
        for n, face in self._faces:
            pull = abs(scene.gravity[n // 2]) if scene.gravity is not None else 0.0
            hop = max(_HOP_OF_EPOCH * length, _OF_DURATION * scene.contact_duration)
            motion.begun[n] = np.fmod(start, face.period)
            motion.slowest[n] = (
                0.5 * pull * hop
                + 0.5 * face.greatest_acceleration * min(hop, _OF_PERIOD * face.period)
                + face.greatest_speed * _OF_SPEED
            )
        return model


WALL_DRAWS = 2
"""Stream number of the random numbers of thermal walls; the initial state uses lower numbers."""


def kinds_and_levels(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Return kinds (2d,) and levels (2d,) of faces: temperature of a thermal, momentum of a sticky one."""
    surfaces = (scene.faces.get(name) for name in FACES[: 2 * scene.dimension])
    names, levels = zip(*(surface.rule if surface else ("hard", 0.0) for surface in surfaces), strict=True)
    return np.array([RULES[name] for name in names], dtype=np.int64), np.array(levels, dtype=float)


def sliding_velocities(scene: Scene) -> np.ndarray | None:
    """Return the velocities (2d, d) of the faces; None if there are no tangential forces."""
    if not scene.drags_faces:
        return None
    velocities = np.zeros((2 * scene.dimension, scene.dimension))
    for n, face in scene.sliding_faces:
        velocities[n] = face.velocity
    return velocities


def accommodations(scene: Scene) -> np.ndarray | None:
    """Return the fractions (2d,) of hits that draw velocities; None if all hits do."""
    if not scene.partial_faces:
        return None
    fractions = np.ones(2 * scene.dimension)
    for n, face in scene.partial_faces:
        fractions[n] = face.accommodation
    return fractions


def ramp_of(scene: Scene) -> Ramp | None:
    """Return the temperatures that vary along faces; None if no temperature varies."""
    if not scene.ramps:
        return None
    axes, high = np.full(2 * scene.dimension, NONE), np.zeros(2 * scene.dimension)
    for n, face in scene.ramps:
        axes[n], high[n] = face.varies_along, face.temperatures[1]
    return Ramp(axes, high)


def has_special_faces(scene: Scene) -> bool:
    """Return True if a face that particles hit has a kind; sheared faces do not count."""
    return bool(scene.faces) and scene.shear_rate is None


def special_faces(scene: Scene, state: State, seed: int | tuple[int, ...], unit_mass: float) -> Faces:
    """Return the special faces as the kernels' `Faces`, in units that contain `unit_mass`."""
    kind, level = kinds_and_levels(scene)
    depths, widths = wells_of(scene)
    velocities, ramp = sliding_velocities(scene), ramp_of(scene)
    return Faces(
        kind=kind,
        level=level / unit_mass,
        depth=depths / unit_mass,
        width=widths,
        well_side=places_in_wells(scene, state.positions, state.radii),
        held=np.zeros(state.positions.shape),
        draws=np.zeros(state.count, dtype=np.int64),
        key=key_of(seed, WALL_DRAWS),
        sticky=kind == STICKY if (kind == STICKY).any() else None,
        motion=motion_of(scene),
        piston=piston_of(scene, state, unit_mass),
        sliding=None if velocities is None else Sliding(velocities, np.zeros((velocities.size, 2))),
        accommodation=accommodations(scene),
        ramp=ramp._replace(high=ramp.high / unit_mass) if ramp else None,
        open=open_of(scene, state),
    )


def face_energy(scene: Scene) -> float:
    """Return the largest energy that a particle gains from a thermal face or wall, or a well."""
    hottest = max(scene.face_temperatures, default=0.0)
    deepest = max((getattr(face, "depth", 0.0) for face in scene.faces.values()), default=0.0)
    fastest = max((math.hypot(*(face.velocity or ())) for _, face in scene.sliding_faces), default=0.0)
    heaviest = max((kind.mass for kind in scene.kinds), default=0.0) if fastest else 0.0
    return scene.dimension * hottest + 2.0 * deepest + heaviest * fastest**2


class FacesPart(Part):
    """Special faces of a scene; masses are in units of `unit_mass`. The arrays contain which particles are in
    a well or stuck to a face, their energies, the numbers of random draws, and the tangential momentum given
    to faces.

    lightest : mass of the lightest particle
    """

    def __init__(self, scene: Scene, faces: Faces, unit_mass: float, lightest: float = np.inf) -> None:
        self._shear = faces.sliding.shear if faces.sliding else None
        arrays = {"place": faces.well_side, "held": faces.held, "draws": faces.draws}
        super().__init__(arrays if self._shear is None else {**arrays, "shear": self._shear})
        self._scene, self._unit_mass = scene, unit_mass
        self.gained = face_energy(scene) / lightest

    @property
    def stored(self) -> float:
        return float(self.arrays["held"].sum()) * self._unit_mass

    def write(self, state: State, clock: float) -> None:
        state.well_energies = well_energies(self._scene, self.arrays["place"])
        if state.vibrations is not None:
            state.vibrations += self.arrays["held"].sum(axis=1) * self._unit_mass

    def reset(self, clock: float) -> None:
        if self._shear is not None:
            self._shear[...] = 0.0

    def counts(self, clock: float) -> dict[str, Any]:
        if self._shear is None:
            return {}
        shear = values(self._shear).reshape(-1, self._scene.dimension) * self._unit_mass
        return {"wall_shear": np.pad(shear, ((0, len(self._scene.walls)), (0, 0)))}


# Interior walls.


_INTERIOR_DRAWS = 6  # stream number of these random numbers, after those of the engines


def interior_walls(
    scene: Scene, boxes: Boxes, largest_radius: float, warm: WarmWalls | None, moving: MovingWall | None
) -> InteriorWalls:
    """Return the interior walls and a list of those at rest near each box, for radii up to
    `largest_radius`.
    """
    rows, wall = wall_rows(scene)
    if moving:
        rows, wall = rows[:0], wall[:0]
    return InteriorWalls(rows, wall, *walls_near(rows, boxes, largest_radius), largest_radius, warm, moving)


def warm_walls(scene: Scene, state: State, seed: int | tuple[int, ...], unit_mass: float) -> WarmWalls | None:
    """Return the thermal walls, with masses in units of `unit_mass`; None if all are hard."""
    level = np.array([wall.temperature or 0.0 for wall in scene.walls])
    if not level.any():
        return None
    draws = np.zeros(state.count, dtype=np.int64)
    return WarmWalls(level / unit_mass, draws, key_of(seed, _INTERIOR_DRAWS))


class WarmWallsPart(Part):
    """State of thermal interior walls: the number of random draws of each particle.

    lightest : mass of the lightest particle
    """

    def __init__(self, scene: Scene, warm: WarmWalls, lightest: float) -> None:
        super().__init__({"wall_draws": warm.draws})
        self.gained = face_energy(scene) / lightest


# Moving wall across the container, between two gases.


def moving_wall_of(scene: Scene, state: State, unit_mass: float) -> kernels.MovingWall | None:
    """Return the kernels' moving wall; None if the scene has no moving wall. The mass of the wall is in units
    of `unit_mass`. Raises SceneError unless there are particles on both sides, because otherwise the wall
    would leave the container.
    """
    wall = scene.moving_wall
    if wall is None or state.piston is None:
        return None
    position, velocity = state.piston
    side = np.where(state.positions[:, wall.axis] > position, 1.0, -1.0)
    if len(np.unique(side)) < 2:
        raise SceneError(f"{MOVING_WALL}.mass", wall.mass, "a wall that moves needs particles on both sides")
    return kernels.MovingWall(wall.axis, wall.mass / unit_mass, side, np.array([position, velocity, 0.0]))


class MovingWallPart(Part):
    """Motion and energy of the moving wall; masses are in units of `unit_mass`."""

    def __init__(self, wall: kernels.MovingWall, unit_mass: float) -> None:
        super().__init__({"piston": wall.motion})
        self._motion, self._mass = wall.motion, wall.mass * unit_mass

    @property
    def stored(self) -> float:
        return 0.5 * self._mass * float(self._motion[kernels.PISTON_VELOCITY]) ** 2

    def set_clock(self, clock: float) -> None:
        self._motion[kernels.PISTON_CLOCK] = clock

    def end_epoch(self, length: float, start: float) -> None:
        advance_wall(self._motion, length)
        self.set_clock(0.0)

    def write(self, state: State, clock: float) -> None:
        motion = self._motion.copy()
        advance_wall(motion, clock)
        state.piston = motion[[kernels.PISTON_PLACE, kernels.PISTON_VELOCITY]]
