"""Simulation of a scene by an engine: its state and counters at the present time."""

from __future__ import annotations

import html
import math
import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, Protocol

import numpy as np

import gaspart
from gaspart.engines import Engine, engine_to_dict, resolve_engine
from gaspart.engines.dynamics import EventLog, check_identity, checkpoint_identity
from gaspart.errors import SceneError, SimulationError
from gaspart.keys.values import count_of, number
from gaspart.scene.boundaries import check_piston_end, piston_end, refuse_open
from gaspart.scene.scene import DRAWN, THUMBNAIL, Scene, require_scene
from gaspart.scene.walls import Plate, Wall, box_of_walls
from gaspart.state.given import check_apart, state_at_time_zero
from gaspart.state.initial import initial_state
from gaspart.state.optional_tallies import OptionalTally
from gaspart.state.state import State
from gaspart.state.tally import StressTally, Tally

ENERGY_DRIFT = {"float64": 1e-9, "float32": 1e-3}
"""Relative drift of the gas's energy at which a run is stopped, by the engine's precision."""
EXCHANGE_ERROR = {"float64": 2.0**-52, "float32": 2.0**-23}
"""Allowed additional drift due to rounding, relative to the energy exchanged with contacts and walls."""
PROPERTIES = (
    "positions", "unwrapped", "images", "velocities", "speeds", "spins", "kinetic_energies", "radii",
    "masses", "moments_of_inertia", "species",
)  # fmt: skip
"""Properties of particles that `Simulation.properties` can return; `State` defines them."""


class Page(Protocol):
    """A page that shows itself in a notebook, such as `rendering.view.View`."""

    def save(self, path: str | Path, overwrite: bool = False) -> Path:
        """Write the page to an .html file."""

    def _repr_html_(self) -> str: ...


class Simulation:
    """A run of a scene by an engine, which is advanced in time.

    If the shear rates of `initial` and of the scene differ, the flow of `initial` is subtracted from the
    velocities, and the flow of the scene is added. The displacement of sheared images, and the position and
    velocity of a piston, are the values in `initial`. If `initial` has no piston, the piston starts at rest
    at its side of the container. Vibrating faces start at the beginning of a period.

    Parameters
    ----------
    scene : Scene
        The scene to simulate.
    engine : Engine or {"event", "step", "dsmc"}, optional
        Engine, or the name of an engine with default settings. Default: event-driven.
    seed : int or tuple of int, default 0
        Seed of the initial state and of the random numbers of thermal walls.
    stress : bool, default False
        Also tally the stress tensor and the heat flux, in a periodic scene without gravity. This adds a
        `StressTally` to the `tallies`.
    initial : State, optional
        State with the positions, velocities and spins at time 0, instead of the initial state of the
        scene. Its particles and the size of its container must be the same as in the scene.
    tallies : iterable of OptionalTally, optional
        Tallies that are made only on request: `StressTally`, `ImpulseTally`, `PairImpulseTally`.

    Raises
    ------
    SceneError
        If the scene cannot be set up, if the engine does not support it, or if particles of `initial` overlap
        or are not inside the container.

    See Also
    --------
    run : Simulate a scene and write a trajectory.

    Examples
    --------
    >>> import gaspart as gp
    >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)])
    >>> simulation = gp.Simulation(scene, seed=1)
    >>> simulation.advance(duration=2.0)
    >>> simulation.time, simulation.state.positions.shape
    (2.0, (20, 2))
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
        self.scene, self.engine, self.seed = scene, resolve_engine(engine), seed
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
        """Return a picture of the present state, with `repr` as a caption."""
        if self.scene.count > DRAWN:
            return html.escape(repr(self))
        return gaspart.render(self, size=THUMBNAIL).figure(repr(self))

    def _set_up(self) -> None:
        """Create the initial state and the dynamics of the engine."""
        self.engine = self._asked.for_scene(self.scene)
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
        """Add a particle before the first advance; `scene` is replaced by a new, validated scene.

        Parameters
        ----------
        position : iterable of float, shape (d,), [length]
            Position of the centre.
        velocity : iterable of float, shape (d,), [length/time]
            Velocity.
        radius : float, [length]
            Radius.
        mass : float, default 1.0, [mass]
            Mass.
        **properties
            Other properties as in `Particle`.

        Raises
        ------
        SceneError
            If the simulation has advanced, or the new scene is impossible; nothing is changed then.
        """
        particle = gaspart.Particle(tuple(position), tuple(velocity), radius, mass, **properties)
        self._change(self.scene.with_particles(particle))

    def add_random(self, count: int, radius: float, **properties: Any) -> None:
        """Add particles at random positions, as `add` does; `properties` are those of `Species`."""
        self._change(self.scene.with_species(gaspart.Species(count, radius, **properties)))

    def add_wall(self, start: Iterable[float], end: Iterable[float]) -> None:
        """Add an interior wall of two dimensions from `start` to `end` (2,), as `add` does."""
        self._change(self.scene.with_walls(Wall(tuple(start), tuple(end))))

    def add_plate(self, corner: Iterable[float], edges: Iterable[Iterable[float]]) -> None:
        """Add an interior wall of three dimensions (see `Plate`), as `add` does."""
        self._change(self.scene.with_walls(Plate(tuple(corner), tuple(map(tuple, edges)))))

    def add_box(self, lower: Iterable[float], upper: Iterable[float]) -> None:
        """Add the walls of a rectangle or of a cuboid between two opposite corners (d,), as `add` does."""
        self._change(self.scene.with_walls(*box_of_walls(tuple(lower), tuple(upper))))

    def _change(self, scene: Scene) -> None:
        """Set up the simulation again for another scene; nothing changes if this fails."""
        if self._advanced:
            rule = "particles and walls can only be added before the first advance"
            raise SceneError("scene", "under way", rule)
        before, self.scene = self.scene, scene
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
        """Advance by a duration, to a time, or by some events, whichever is reached first.

        The time-stepped engine stops at the end of the last step that ends by the target time.

        Parameters
        ----------
        duration : float, [time], optional
            Time by which to advance.
        max_events : int, optional
            Number of collisions and wall hits by which to advance.
        until : float, [time], optional
            Time to which to advance. It may be infinite together with `max_events`.
        max_work : int, optional
            Event-driven engine only: also stop after about this number of operations, so that a call takes a
            limited time even if events are rare. Operations are events, crossings of boxes and of periodic
            faces, and predictions.

        Raises
        ------
        SceneError
            If there is no target, or if the target is in the past or not a number. The simulation is
            unchanged in this case.
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
        piston = None if self._initial.piston is None else float(self._initial.piston[0])
        if self.scene.pistons:
            if max_events is None:
                check_piston_end(self.scene, "until", until, piston)
            until = min(until, piston_end(self.scene, piston))
        before, self._advanced = self._advanced, True
        if not before:
            self._warn_at_rest()
        try:
            self._dynamics.advance(until, max_events, self._log, max_work)
        except SceneError:  # the engine rejected the target
            self._advanced = before
            raise

    def _warn_at_rest(self) -> None:
        """Warn if all particles are at rest, and nothing in the scene can move them."""
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
        """Present simulated time."""
        return self._dynamics.time

    @property
    def state(self) -> State:
        """Read-only state of all particles at the present time; its `copy` can be changed."""
        return self._dynamics.state.read_only()

    @property
    def initial_state(self) -> State:
        """Read-only state of all particles at time 0; its `copy` can be changed."""
        return self._initial.copy().read_only()

    @property
    def tally(self) -> Tally:
        """Copy of the counters and sums since the start, or since the last `reset_tally`."""
        return self._dynamics.tally

    def sums_of(self, tally: str) -> np.ndarray:
        """Return the sums of an optional tally by its name; this is faster than reading `tally`.

        For "stress", the array (2 d^2 + d,) contains the sums of the stress tensor, of its collisional part
        and of the heat flux. Raises SceneError if the simulation was created without this tally.
        """
        if not any(optional_tally.name == tally for optional_tally in self.tallies):
            raise SceneError(tally, False, "was not requested; name the tally when the simulation is made")
        return self._dynamics.sums_of(tally)

    def reset_tally(self) -> None:
        """Set all counters and sums to zero."""
        self._dynamics.reset_tally()

    @property
    def record_events(self) -> bool:
        """True if events are recorded (event-driven engine only)."""
        return self._log is not None

    @record_events.setter
    def record_events(self, enabled: bool) -> None:
        if enabled and not self.engine.records_events:
            raise SceneError("record_events", enabled, 'needs the "event" engine')
        if enabled:
            refuse_open(self.scene, "changes the particles: events are not recorded")
        self._log = EventLog(self.scene.dimension, self.scene.rough) if enabled else None

    @property
    def events(self) -> dict[str, np.ndarray]:
        """Recorded events: times, particles, and positions and velocities after the events.

        The arrays for M events are time (M,), particles (M, 2), positions and velocities (M, 2, d). If
        contacts are rough, there are also spins, (M, 2) in 2D and (M, 2, 3) in 3D. The second entry of
        `particles` is negative for hits: -1 - n at face n of the container or at the edge of its well, and -1
        - 2d - n at interior wall n. Raises SceneError if `record_events` was not set to True.
        """
        if self._log is None:
            raise SceneError("events", None, "set record_events to True before advancing")
        return self._log.events

    def again(self) -> Simulation:
        """Return a new simulation at time 0 of the same scene, engine, seed, initial state and tallies."""
        return Simulation(self.scene, self.engine, self.seed, initial=self._given, tallies=self.tallies)

    def replay(self, by: str = "time", interval: float | None = None) -> Iterator[State]:
        """Run the simulation again from time 0, and yield states up to the present time.

        Parameters
        ----------
        by : {"time", "event"}, default "time"
            Yield a state at every `interval`, or after every event (event-driven engine only).
        interval : float, [time], optional
            Time between states. Requires by="time".

        Raises
        ------
        SceneError
            If `by` is unknown, or the interval is not positive.
        """
        if by == "time":
            step = number("interval", interval, "must be positive", above=0.0)
            count = math.floor(self.time / step * (1 + 1e-12)) + 1
            yield from self._states_at(min(n * step, self.time) for n in range(count))
        elif by == "event":
            again = self.again()
            yield again.state
            while again.time < self.time:
                again.advance(until=self.time, max_events=1)
                yield again.state
        else:
            raise SceneError("by", by, 'must be "time" or "event"')

    def _states_at(self, times: Iterable[float]) -> Iterator[State]:
        """Run the simulation again and yield the states at ascending times."""
        again = self.again()
        for time in times:
            again.advance(until=time)
            yield again.state

    def properties(self, *names: str, at: Iterable[float] | None = None) -> dict[str, np.ndarray]:
        """Return selected properties of all particles, at the present time or at the times `at`.

        Parameters
        ----------
        *names : str
            Names of properties from `PROPERTIES`: "positions", "velocities", "speeds" ...
        at : iterable of float, [time], optional
            Times from 0 to the present time, in any order. The simulation is run again to compute the states
            at these times. Default: the present time.

        Returns
        -------
        dict of str to ndarray
            The arrays by name, of shape (N, ...). With `at`, their shape is (T, N, ...), and "time" of shape
            (T,) is included.

        Raises
        ------
        SceneError
            If a name is unknown, if a time is outside the run, or if there are times and faces are open,
            because the particles in the container then differ between times.
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
        values = {
            time: [getattr(state, name) for name in names]
            for time, state in zip(rising, self._states_at(rising), strict=True)
        }
        arrays = {name: np.array([values[time][n] for time in times]) for n, name in enumerate(names)}
        return {"time": np.array(times), **arrays}

    def check_invariants(self, state: State | None = None) -> None:
        """Raise SimulationError if the energy has drifted, or a position or velocity is not finite.

        Energy that contacts and walls add or remove does not count as drift. The caller may pass the present
        state if it is already computed.
        """
        state = self.state if state is None else state
        if not (np.isfinite(state.positions).all() and np.isfinite(state.velocities).all()):
            raise SimulationError(f"at time {self.time:g} a position or velocity is not finite")
        moving = state.kinetic_energy + state.vibrational_energy
        drift = abs(moving + state.potential_energy + self._dynamics.dissipated - self._energy)
        scale = max(moving, self._moving)
        if state.gravity is not None:  # energy of a fall through the container
            masses = state.masses[np.isfinite(state.masses)]
            scale += float(masses.sum() * (abs(state.gravity) @ state.lengths))
        precision = self.engine.precision
        # in a flow driven along a periodic axis, particles fall without end
        exchanged = self._dynamics.exchanged + abs(state.potential_energy)
        allowed = ENERGY_DRIFT[precision] * scale + EXCHANGE_ERROR[precision] * exchanged
        if drift > allowed:
            raise SimulationError(
                f"at time {self.time:g} the energy has drifted by {drift:g} from {self._energy:g}"
            )

    def show(self, frames: int = 200) -> Page:
        """Return an interactive view of the run so far, see `view`; SceneError if it has not advanced."""
        # imported by its public name, because views are made from simulations
        return gaspart.view(self, frames)

    def checkpoint(self) -> dict[str, np.ndarray]:
        """Return a checkpoint, from which `restore` continues bitwise identically.

        It has arrays of the present state, and the data that identify the run: scene, seed, engine, version
        and, if the caller supplied it, the initial state.
        """
        return {**self._dynamics.checkpoint(), **self._identity()}

    def _identity(self) -> dict[str, np.ndarray]:
        """Return the arrays of a checkpoint that identify the run."""
        neutral, given = self.engine.neutral_settings, None if self._given is None else self._initial
        settings = {key: x for key, x in engine_to_dict(self.engine).items() if key not in neutral}
        return checkpoint_identity(self.scene, settings, self.seed, given)

    def restore(self, checkpoint: dict[str, np.ndarray]) -> None:
        """Continue bitwise identically from a checkpoint of the same scene, seed and engine.

        Settings of the engine that do not affect results, such as the search or the number of threads, may
        differ.

        Raises
        ------
        SceneError
            If the checkpoint belongs to another simulation, or if arrays are missing. The simulation is
            unchanged in this case.
        """
        check_identity(checkpoint, self._identity())
        self._advanced = True
        self._dynamics.restore(checkpoint)
