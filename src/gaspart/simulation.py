"""Simulation: a scene, an engine and a seed, and the state and counters that they have reached."""

from __future__ import annotations

import html
import math
import warnings
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

import gaspart
from gaspart.engines import Engine, chosen
from gaspart.engines.checkpoint_identity import check_identity, checkpoint_identity
from gaspart.engines.event_log import EventLog
from gaspart.errors import SceneError, SimulationError
from gaspart.keys.values import count_of, number
from gaspart.scene.face_checks import check_piston_end, piston_end
from gaspart.scene.open_faces import refuse_open
from gaspart.scene.scene import DRAWN, THUMBNAIL, Scene, require_scene
from gaspart.scene.walls import Plate, Wall, box_of_walls
from gaspart.state.given import check_apart, state_at_time_zero
from gaspart.state.initial import initial_state
from gaspart.state.optional_tallies import OptionalTally, StressTally
from gaspart.state.state import State
from gaspart.state.tally import Tally

if TYPE_CHECKING:
    from gaspart.rendering.view import View

ENERGY_DRIFT = {"float64": 1e-9, "float32": 1e-3}
"""Drift of the energy at which a run is stopped, relative to that of the gas, by the engine's precision."""
EXCHANGE_ERROR = {"float64": 2.0**-52, "float32": 2.0**-23}
"""Drift relative to the energy exchanged with contacts and thermal walls that is allowed for its rounding."""
PROPERTIES = (
    "positions",
    "unwrapped",
    "images",
    "velocities",
    "speeds",
    "spins",
    "kinetic_energies",
    "radii",
    "masses",
    "moments_of_inertia",
    "species",
)
"""Properties of each particle that `Simulation.properties` returns; defined in `State`."""


class Simulation:
    """One run of a scene by an engine, which is advanced in time.

    `engine`: by default event-driven; "event", "step" or "dsmc" is one with default settings.
    `seed`: a whole number, or a tuple of them, that fixes the initial state and the random
    numbers of thermal walls. stress: whether `tally` has the stress tensor and the heat flux, of a periodic
    scene without gravity; tallies: what it has that not every run counts (`state.optional_tallies`), of which
    `stress` adds a `StressTally`. initial: a state whose positions, velocities and spins are those at time 0,
    instead of what the scene states; its particles and the size of its container must be the scene's.
    Velocities are about the flow of a sheared scene: kept at the shear rate of the state, else peculiar ones
    with the flow added. Its images keep their displacement and a piston its motion, which is at rest at its
    side if the state has none; faces that vibrate begin anew.

    Raises SceneError if the scene cannot be set up, the engine cannot model it, or particles of `initial`
    overlap or are not inside the container.
    """

    scene: Scene
    engine: Engine

    def __init__(
        self,
        scene: Scene,
        engine: Engine | str | None = None,
        seed: int | tuple[int, ...] = 0,
        stress: bool = False,
        initial: State | None = None,
        tallies: Iterable[OptionalTally] = (),
    ) -> None:
        require_scene(scene)
        self.scene, self.engine, self.seed = scene, chosen(engine), seed
        self._asked, self._given = self.engine, initial
        self.tallies: tuple[OptionalTally, ...] = (*tallies, *([StressTally()] if stress else []))
        self._log: EventLog | None = None
        self._advanced = False
        self._set_up()

    def __repr__(self) -> str:
        kind = "discs" if self.scene.dimension == 2 else "spheres"
        reached = f"time {self.time:g}, {self._dynamics.tally.collisions} collisions"
        count = self.state.count if self.scene.is_open else self.scene.count
        return f"<Simulation of {count} {kind}, {self.engine.name} engine: {reached}>"

    def _repr_html_(self) -> str:
        """A picture of the present state, with `repr` below it."""
        if self.scene.count > DRAWN:
            return html.escape(repr(self))
        return gaspart.render(self, size=THUMBNAIL).figure(repr(self))

    def _set_up(self) -> None:
        self.engine = self._asked.resolved(self.scene)
        if self._given is None:
            self._initial = initial_state(self.scene, self.seed)
        else:
            self._initial = state_at_time_zero(self.scene, self._given)
            if self.engine.forbids_overlap:
                check_apart(self.scene, self._initial)
        self._energy = self._initial.energy
        self._moving = self._initial.kinetic_energy + self._initial.vibrational_energy
        for tally in self.tallies:
            self.engine.check_tally(tally, self.scene)
        self._dynamics = self.engine.start(self.scene, self._initial, self.seed, self.tallies)

    def add(
        self,
        position: Iterable[float],
        velocity: Iterable[float],
        radius: float,
        mass: float = 1.0,
        **properties: Any,
    ) -> None:
        """Add one particle (properties as in `Particle`): `scene` becomes a new, validated scene. Refused
        once the simulation has advanced."""
        self._change(
            self.scene.with_particles(
                gaspart.Particle(tuple(position), tuple(velocity), radius, mass, **properties)
            )
        )

    def add_random(self, count: int, radius: float, **properties: Any) -> None:
        """Add `count` particles at random places (properties as in `Species`), before the first advance."""
        self._change(self.scene.with_species(gaspart.Species(count, radius, **properties)))

    def add_wall(self, start: Iterable[float], end: Iterable[float]) -> None:
        """Add an interior wall from `start` to `end`. Refused after the first advance."""
        self._change(self.scene.with_walls(Wall(tuple(start), tuple(end))))

    def add_plate(self, corner: Iterable[float], edges: Iterable[Iterable[float]]) -> None:
        """Add an interior wall of three dimensions (see `Plate`). Refused after the first advance."""
        self._change(self.scene.with_walls(Plate(tuple(corner), tuple(map(tuple, edges)))))

    def add_box(self, lower: Iterable[float], upper: Iterable[float]) -> None:
        """Add the walls of a rectangle or of a cuboid, given opposite corners. Refused after the first
        advance."""
        self._change(self.scene.with_walls(*box_of_walls(tuple(lower), tuple(upper))))

    def _change(self, scene: Scene) -> None:
        if self._advanced:
            raise SceneError(
                "scene", "under way", "particles and walls can only be added before the first advance"
            )
        before = self.scene
        self.scene = scene
        try:
            self._set_up()
        except SceneError:
            self.scene = before
            self._set_up()
            raise

    def advance(
        self,
        duration: float | None = None,
        max_events: int | None = None,
        until: float | None = None,
        max_work: int | None = None,
    ) -> None:
        """Advance by `duration`, to the time `until`, or by `max_events` collisions and wall hits, whichever
        comes first. The time-stepped engine stops at the last complete step not after the target.

        max_work (event-driven engine): stop as well after about so many events, crossings of boxes and of
        periodic faces, and predictions, so that a call takes a bounded time however rare events are.

        Raises SceneError, with nothing changed, for no target, one in the past, or one that is not a number;
        `until` may be infinite together with max_events.
        """
        if max_events is not None:
            max_events = count_of("max_events", max_events)
        if max_work is not None:
            max_work = count_of("max_work", max_work, least=1)
        if until is not None and not (until == math.inf and max_events is not None):
            until = number("until", until, "must be a finite number, or be given with max_events")
            if until < self.time:
                raise SceneError("until", until, f"is before the present time {self.time:g}")
        if duration is not None:
            duration = number("duration", duration, "must be a finite number that is not negative", least=0.0)
            until = min(math.inf if until is None else until, self.time + duration)
        if until is None:
            if max_events is None:
                raise SceneError("duration", None, "give duration, until or max_events")
            until = math.inf
        place = None if self._initial.piston is None else float(self._initial.piston[0])
        if self.scene.pistons:
            if max_events is None:
                check_piston_end(self.scene, "until", until, place)
            until = min(until, piston_end(self.scene, place))
        before, self._advanced = self._advanced, True
        if not before:
            self._warn_at_rest()
        try:
            self._dynamics.advance(until, max_events, self._log, max_work)
        except SceneError:  # the engine refused the target
            self._advanced = before
            raise

    def _warn_at_rest(self) -> None:
        """Warn if all particles are at rest and the scene has nothing that sets them in motion."""
        scene = self.scene
        moved = any(face.moves for face in scene.faces.values()) or scene.is_open or scene.moving_wall
        if self._moving or not scene.moving_count or scene.gravity or scene.thermostat or moved:
            return
        warnings.warn(
            "gaspart: all particles are at rest, and nothing in the scene moves them: "
            "give a species a temperature or a speed",
            stacklevel=3,
        )

    @property
    def time(self) -> float:
        """The simulated time reached."""
        return self._dynamics.time

    @property
    def state(self) -> State:
        """All particles now; read-only, of which `copy` can be changed."""
        return self._dynamics.state.read_only()

    @property
    def initial_state(self) -> State:
        """All particles at the start; read-only, of which `copy` can be changed."""
        return self._initial.copy().read_only()

    @property
    def tally(self) -> Tally:
        """Counters and sums since the start, or since the last `reset_tally`; a copy."""
        return self._dynamics.tally

    def sums_of(self, tally: str) -> np.ndarray:
        """The sums of the optional tally of this name, as in `tally` but read faster: of "stress" (2 d^2 +
        d,) those of the stress tensor, of its collisional part and of the heat flux. Raises SceneError unless
        it was asked for."""
        if not any(asked.name == tally for asked in self.tallies):
            raise SceneError(tally, False, "was not asked for when the simulation was made")
        return self._dynamics.sums_of(tally)

    def reset_tally(self) -> None:
        """Set all counters and sums to zero."""
        self._dynamics.reset_tally()

    @property
    def record_events(self) -> bool:
        """Whether events are recorded (event-driven engine only)."""
        return self._log is not None

    @record_events.setter
    def record_events(self, wanted: bool) -> None:
        if wanted and not self.engine.records_events:
            raise SceneError("record_events", wanted, 'needs the "event" engine')
        if wanted:
            refuse_open(self.scene, "changes the particles: events are not recorded")
        self._log = EventLog(self.scene.dimension, self.scene.rough) if wanted else None

    @property
    def events(self) -> dict[str, np.ndarray]:
        """The events recorded: time (M,), particles (M, 2), positions and velocities (M, 2, d) just after;
        with rough contacts also spins, (M, 2) in 2D and (M, 2, 3) in 3D.

        The second of `particles` is -1 - face for a hit at a face of the container or the edge of its well,
        -1 - 2d - n for one at interior wall n.
        """
        if self._log is None:
            raise SceneError("events", None, "set record_events to True before advancing")
        return self._log.events

    def again(self) -> Simulation:
        """This simulation at its start."""
        return Simulation(self.scene, self.engine, self.seed, initial=self._given, tallies=self.tallies)

    def replay(self, by: str = "time", interval: float | None = None) -> Iterator[State]:
        """The states from the start to the present time, by running it again: at every `interval`
        (by="time"), or after every event (by="event", event-driven engine only)."""
        if by == "time":
            step = number("interval", interval, "must be positive", above=0.0)
            count = math.floor(self.time / step * (1 + 1e-12)) + 1
            yield from self._states_at(min(n * step, self.time) for n in range(count))
        elif by == "event":
            again = self.again()
            yield again.state
            while True:
                again.advance(until=self.time, max_events=1)
                if again.time >= self.time:
                    yield again.state
                    return
                yield again.state
        else:
            raise SceneError("by", by, 'must be "time" or "event"')

    def _states_at(self, times: Iterable[float]) -> Iterator[State]:
        """The states at rising times, by running it again."""
        again = self.again()
        for time in times:
            again.advance(until=time)
            yield again.state

    def properties(self, *names: str, at: Iterable[float] | None = None) -> dict[str, np.ndarray]:
        """Chosen properties of all particles as arrays, by their names in `PROPERTIES`.

        Now: (N, ...) each. Or at the times `at`, from the start to the present one and in any order, by
        running it again: (T, N, ...) each, and `time` (T,) with them.

        Raises SceneError for an unknown name, for a time outside this range, and for times of a scene with
        open faces, whose particles are others at each.
        """
        for name in names:
            if name not in PROPERTIES:
                raise SceneError("properties", name, f"must be one of {PROPERTIES}")
        if at is None:
            state = self.state
            return {name: getattr(state, name) for name in names}
        refuse_open(self.scene, "changes the particles: look at the states of `replay`")
        times = [number("at", time, "must be from 0 to the present time", least=0.0) for time in at]
        if max(times, default=0.0) > self.time:
            raise SceneError("at", max(times), f"is after the present time {self.time:g}")
        rising = sorted(set(times))
        found = {
            time: [getattr(state, name) for name in names]
            for time, state in zip(rising, self._states_at(rising), strict=True)
        }
        arrays = {name: np.array([found[time][n] for time in times]) for n, name in enumerate(names)}
        return {"time": np.array(times), **arrays}

    def check_invariants(self, state: State | None = None) -> None:
        """Raise SimulationError if the energy has drifted, exchange with contacts and walls accounted for,
        or if a position or velocity is not finite. state: the present one, if the caller has it."""
        state = self.state if state is None else state
        if not (np.isfinite(state.positions).all() and np.isfinite(state.velocities).all()):
            raise SimulationError(f"at time {self.time:g} a position or velocity is not finite")
        moving = state.kinetic_energy + state.vibrational_energy
        drift = abs(moving + state.potential_energy + self._dynamics.dissipated - self._energy)
        scale = max(moving, self._moving)
        if state.gravity is not None:  # what a fall through the container can change
            masses = state.masses[np.isfinite(state.masses)]
            scale += float(masses.sum() * (abs(state.gravity) @ state.lengths))
        precision = self.engine.precision
        exchanged = self._dynamics.exchanged + abs(state.potential_energy)  # a flow falls without end
        allowed = ENERGY_DRIFT[precision] * scale + EXCHANGE_ERROR[precision] * exchanged
        if drift > allowed:
            raise SimulationError(
                f"at time {self.time:g} the energy has drifted by {drift:g} from {self._energy:g}"
            )

    def show(self, frames: int = 200) -> View:
        """An interactive view of the run so far, `gaspart.view(self, frames)`, which shows itself in a
        notebook. Raises SceneError for a simulation that has not advanced."""
        return gaspart.view(self, frames)  # its public name, because views are made of simulations

    def checkpoint(self) -> dict[str, np.ndarray]:
        """Arrays from which `restore` continues to the same bits, and what they belong to: scene, seed,
        engine, version and the initial state, if it was given."""
        return {**self._dynamics.checkpoint(), **self._identity()}

    def _identity(self) -> dict[str, np.ndarray]:
        return checkpoint_identity(
            self.scene, self.engine, self.seed, None if self._given is None else self._initial
        )

    def restore(self, checkpoint: dict[str, np.ndarray]) -> None:
        """Continue from a checkpoint of a simulation of the same scene and seed, with the same engine, to the
        same bits: settings of an engine that change no result, such as the search or threads, may be others.

        Raises SceneError, with nothing changed, for any other checkpoint, and for one with missing arrays.
        """
        check_identity(checkpoint, self._identity())
        self._advanced = True
        self._dynamics.restore(checkpoint)
