"""Faces of the container with a kind, for all engines, and what particles keep at them."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from gaspart.engines.features.part import Part
from gaspart.errors import SimulationError
from gaspart.kernels import model as kernels
from gaspart.kernels.event.entry import schedule_first
from gaspart.kernels.model import NONE, STICKY, Faces, Model, Motion, Ramp, Sliding
from gaspart.kernels.obstacles.face import NUMBERS, RULES
from gaspart.kernels.obstacles.moving import advance_piston
from gaspart.kernels.physics.running_sum import values
from gaspart.scene.faces import FACES, Open, Vibrating
from gaspart.scene.open_faces import attempt_rate
from gaspart.scene.scene import Scene
from gaspart.state.initial import places_in_wells, well_energies, wells_of
from gaspart.state.random import key_of
from gaspart.state.state import State

# Open faces: which particles are inside, and the reservoirs from which they come.


_ENTRY_DRAWS = 7  # the purpose of their random numbers, after those of interior walls
_ARRAYS = "positions", "velocities", "images", "radii", "masses", "species", "spins", "moments_of_inertia"
"""Those of a `State` that have a row for each particle."""


def with_room(scene: Scene, state: State) -> State:
    """A state with all numbers that particles may have: those that no particle has are at no place (NaN) and
    at rest. The same one without open faces."""
    free = scene.capacity - state.count
    if free == 0:
        return state
    padded: dict[str, Any] = {}
    for key in _ARRAYS:
        values = getattr(state, key)
        padded[key] = np.concatenate([values, np.repeat(values[:1], free, axis=0)])
    padded["positions"][state.count :], padded["velocities"][state.count :] = np.nan, 0.0
    return replace(state, **padded)


def opened(scene: Scene, state: State) -> kernels.Open | None:
    """The kernels' `Open` of a state with all numbers; None without open faces."""
    if not scene.is_open:
        return None
    present = np.isfinite(state.positions[:, 0]).astype(np.uint8)
    blocks = -(-len(present) // NUMBERS)
    return kernels.Open(present, np.zeros(blocks, np.int64), np.zeros(2 * scene.dimension, np.int64))


def reservoirs_of(
    scene: Scene, seed: int | tuple[int, ...], inside: kernels.Open
) -> kernels.Reservoirs | None:
    """The gases behind open faces; None if there is a vacuum behind all of them."""
    rates, widths = np.zeros((2, 2 * scene.dimension))
    for number, face in scene.faces_of(Open):
        if face.temperature is not None:
            widths[number] = math.sqrt(face.temperature / scene.species[0].mass)
            rates[number] = attempt_rate(scene, number, face)
    if not rates.any():
        return None
    up_to = np.cumsum(rates) / rates.sum()
    up_to[np.flatnonzero(rates)[-1] :] = 1.0  # whatever rounding makes of it
    next_one = np.zeros(1, dtype=np.int64), np.full(1, np.inf), np.zeros(3)
    return kernels.Reservoirs(
        key_of(seed, _ENTRY_DRAWS), float(rates.sum()), up_to, widths, *next_one, inside
    )


def crowded_error(time: float, most: int) -> SimulationError:
    """The error of a run in which more than `most` particles would be inside."""
    return SimulationError(f"at time {time:g} there is no room for more than {most} particles")


class OpenPart(Part):
    """The open faces of a scene: which particles are inside, how many have entered since the tally began, and
    the number and the time, on the clocks of the epoch, of the next attempt to enter."""

    def __init__(self, scene: Scene, inside: kernels.Open, reservoirs: kernels.Reservoirs | None) -> None:
        self._scene, self._inside, self._reservoirs = scene, inside, reservoirs
        arrays, times = {"present": inside.present, "entries": inside.entries}, ()
        if reservoirs:
            arrays |= {"entry_number": reservoirs.number, "entry_next": reservoirs.time}
            times = (reservoirs.time,)
        super().__init__(arrays, times=times)

    def set_clock(self, clock: float) -> None:
        """Schedule the first attempt to enter."""
        if self._reservoirs:
            schedule_first(self._reservoirs, clock)

    def begin_epoch(self, length: float, start: float, model: kernels.Model) -> kernels.Model:
        """Count the vacant numbers, which a checkpoint does not have."""
        absent = np.flatnonzero(self._inside.present == 0)
        self._inside.vacant[:] = np.bincount(absent // NUMBERS, minlength=len(self._inside.vacant))
        return model

    def write(self, state: State, clock: float) -> None:
        """Leave only the particles that are inside, with their numbers."""
        state.numbers = np.flatnonzero(self._inside.present)
        for key in _ARRAYS:
            setattr(state, key, getattr(state, key)[state.numbers])

    def reset(self, clock: float) -> None:
        """Begin to count from zero."""
        self._inside.entries[:] = 0

    def counts(self, clock: float) -> dict[str, Any]:
        """How many particles have entered through each face, by the field of `Tally`."""
        return {"entries": np.pad(self._inside.entries, (0, len(self._scene.walls)))}


# A face that is a piston.


_UNMOVED = 2.0**1000  # the mass of one at a stated speed: contacts change no bit of its velocity
_OF_EPOCH = 2.0**-24  # a particle at rest on which the piston lies meets it again after this part of an epoch


def piston_of(scene: Scene, state: State, unit_mass: float) -> kernels.Piston | None:
    """The piston of a state, in units of `unit_mass`; None if there is none."""
    if not scene.pistons or state.piston is None:
        return None
    ((n, face),) = scene.pistons
    x, velocity = state.piston
    inwards = (scene.container.lengths[n // 2] - x, -velocity) if n % 2 else (x, velocity)
    push = face.acceleration(scene, n // 2)
    mass = _UNMOVED if face.mass is None else face.mass / unit_mass
    return kernels.Piston(n, mass, push, np.array([*inwards, 0.0]), np.zeros(1))


class PistonPart(Part):
    """The piston of a scene: twice its speed, stated or that which its load gives it, is what it can give a
    particle."""

    def __init__(self, piston: kernels.Piston, scene: Scene) -> None:
        super().__init__({"piston": piston.motion})
        self._piston, self._lengths = piston, scene.container.lengths
        ((number, face),) = scene.pistons
        fallen = 2.0 * face.acceleration(scene, number // 2) * self._lengths[number // 2]
        self.gained = 4.0 * (fallen if face.speed is None else face.speed**2)

    def set_clock(self, clock: float) -> None:
        """Let the present motion be that at this time."""
        self._piston.motion[kernels.PISTON_CLOCK] = clock

    def begin_epoch(self, length: float, start: float, model: kernels.Model) -> kernels.Model:
        """Set the speed at which particles part from it."""
        self._piston.slowest[0] = 0.5 * self._piston.push * _OF_EPOCH * length
        return model

    def end_epoch(self, length: float, start: float) -> None:
        """Move it to the end of the epoch, and let that be time 0 of its clock."""
        advance_piston(self._piston.motion, self._piston.push, length)
        self.set_clock(0.0)

    def write(self, state: State, clock: float) -> None:
        """Write where it is along its axis, and its velocity."""
        piston, motion = self._piston, self._piston.motion.copy()
        advance_piston(motion, piston.push, clock)
        place, velocity = motion[kernels.PISTON_PLACE], motion[kernels.PISTON_VELOCITY]
        upper = piston.face % 2 == 1
        state.piston = np.array(
            [self._lengths[piston.face // 2] - place, -velocity] if upper else [place, velocity]
        )


# Faces that vibrate.


# A particle that is pressed to the face meets it again after a part of an epoch, or of the duration of a
# contact, if that is longer; of the period, if the face's acceleration presses it, and that is shorter.
_HOP_OF_EPOCH, _OF_DURATION, _OF_PERIOD = 2.0**-24, 2.0**-3, 2.0**-15
_OF_SPEED = 2.0**-48  # it parts with this part of the face's speed at least


def motion_of(scene: Scene) -> Motion | None:
    """How the faces move, before the first epoch; None if none vibrates."""
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
    """Faces that move as prescribed: up to twice as fast as they do themselves particles leave them."""

    def __init__(self, scene: Scene, motion: Motion) -> None:
        super().__init__({})
        self._scene, self._motion, self._faces = scene, motion, scene.faces_of(Vibrating)
        self.gained = (2.0 * max(face.greatest_speed for _, face in self._faces)) ** 2

    def begin_epoch(self, length: float, start: float, model: Model) -> Model:
        """Let the periods go on where the clocks are at zero. The remainder of a division is exact, so that
        phases do not drift."""
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
"""The purpose of the random numbers of thermal walls, after those of the initial state."""


def kinds_and_levels(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """(2d,), (2d,) the kernels' kinds of the container's faces, and their levels: temperatures or momenta."""
    surfaces = (scene.faces.get(name) for name in FACES[: 2 * scene.dimension])
    names, levels = zip(*(surface.rule if surface else ("hard", 0.0) for surface in surfaces), strict=True)
    return np.array([RULES[name] for name in names], dtype=np.int64), np.array(levels, dtype=float)


def sliding_velocities(scene: Scene) -> np.ndarray | None:
    """(2d, d) the velocities of the container's faces, None if it has no `has_dragged_faces`."""
    if not scene.drags_faces:
        return None
    velocities = np.zeros((2 * scene.dimension, scene.dimension))
    for n, face in scene.sliding_faces:
        velocities[n] = face.velocity
    return velocities


def accommodations(scene: Scene) -> np.ndarray | None:
    """(2d,) the fractions of hits of the container's faces after which velocities are drawn, None if all
    are."""
    if not scene.partial_faces:
        return None
    fractions = np.ones(2 * scene.dimension)
    for n, face in scene.partial_faces:
        fractions[n] = face.accommodation
    return fractions


def ramp_of(scene: Scene) -> Ramp | None:
    """The temperatures that vary along faces, None without any."""
    if not scene.ramps:
        return None
    axes, high = np.full(2 * scene.dimension, NONE), np.zeros(2 * scene.dimension)
    for n, face in scene.ramps:
        axes[n], high[n] = face.varies_along, face.temperatures[1]
    return Ramp(axes, high)


def has_special_faces(scene: Scene) -> bool:
    """Whether particles meet faces with a kind, other than periodic ones."""
    return bool(scene.faces) and scene.shear_rate is None


def special_faces(scene: Scene, state: State, seed: int | tuple[int, ...], unit_mass: float) -> Faces:
    """The kinds of the container's faces as the kernels' `Faces`, in units of `unit_mass`."""
    kind, level = kinds_and_levels(scene)
    depths, widths = wells_of(scene)
    velocities, ramp = sliding_velocities(scene), ramp_of(scene)
    return Faces(
        kind=kind,
        level=level / unit_mass,
        depth=depths / unit_mass,
        width=widths,
        place=places_in_wells(scene, state.positions, state.radii),
        held=np.zeros(state.positions.shape),
        draws=np.zeros(state.count, dtype=np.int64),
        key=key_of(seed, WALL_DRAWS),
        sticky=kind == STICKY if (kind == STICKY).any() else None,
        motion=motion_of(scene),
        piston=piston_of(scene, state, unit_mass),
        sliding=None if velocities is None else Sliding(velocities, np.zeros((velocities.size, 2))),
        accommodation=accommodations(scene),
        ramp=ramp._replace(high=ramp.high / unit_mass) if ramp else None,
        open=opened(scene, state),
    )


def face_energy(scene: Scene) -> float:
    """Upper estimate of the energy that a thermal face or wall or a well gives a particle, at whatever speed
    it moves."""
    hottest = max(scene.face_temperatures, default=0.0)
    deepest = max((getattr(face, "depth", 0.0) for face in scene.faces.values()), default=0.0)
    fastest = max((math.hypot(*(face.velocity or ())) for _, face in scene.sliding_faces), default=0.0)
    heaviest = max((kind.mass for kind in scene.kinds), default=0.0) if fastest else 0.0
    return scene.dimension * hottest + 2.0 * deepest + heaviest * fastest**2


class FacesPart(Part):
    """Faces with a kind, in units of `unit_mass`: which particles are in a well or stuck, with what energy,
    how often random numbers were drawn, and what momentum faces were given along themselves. lightest: the
    least mass of a particle."""

    def __init__(self, scene: Scene, faces: Faces, unit_mass: float, lightest: float = np.inf) -> None:
        self._shear = faces.sliding.shear if faces.sliding else None
        arrays = {key: getattr(faces, key) for key in ("place", "held", "draws")}
        super().__init__(arrays if self._shear is None else {**arrays, "shear": self._shear})
        self._scene, self._unit_mass = scene, unit_mass
        self.gained = face_energy(scene) / lightest

    @property
    def stored(self) -> float:
        """The energy of particles that stick to a face."""
        return float(self.arrays["held"].sum()) * self._unit_mass

    def write(self, state: State, clock: float) -> None:
        """Write the energies in wells, and add those of particles that stick to a face."""
        state.well_energies = well_energies(self._scene, self.arrays["place"])
        if state.vibrations is not None:
            state.vibrations += self.arrays["held"].sum(axis=1) * self._unit_mass

    def reset(self, clock: float) -> None:
        """Begin to count from zero."""
        if self._shear is not None:
            self._shear[...] = 0.0

    def counts(self, clock: float) -> dict[str, Any]:
        """The momentum that faces were given along themselves, by the field of `Tally`."""
        if self._shear is None:
            return {}
        shear = values(self._shear).reshape(-1, self._scene.dimension) * self._unit_mass
        return {"wall_shear": np.pad(shear, ((0, len(self._scene.walls)), (0, 0)))}
