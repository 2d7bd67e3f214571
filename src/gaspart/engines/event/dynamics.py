"""Dynamics of a scene under the event-driven engine: the arrays of its kernels, and their control."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from operator import attrgetter
from typing import Any

import numpy as np

from gaspart.engines.dynamics import Dynamics, EventLog
from gaspart.engines.event.search import chosen_search, make_lists, neighbour_lists
from gaspart.engines.event.tally import (
    MANY,
    CollapsePart,
    Epochs,
    EventTally,
    check_clocks,
    check_events,
    check_progress,
    tally_parts,
)
from gaspart.engines.features.faces import (
    FacesPart,
    MovingWallPart,
    OpenPart,
    PistonPart,
    VibratingPart,
    WarmWallsPart,
    crowded_error,
    has_special_faces,
    interior_walls,
    moving_wall_of,
    reservoirs_of,
    special_faces,
    warm_walls,
    with_room,
)
from gaspart.engines.features.law import (
    DurationPart,
    LawPart,
    contact_duration,
    contact_law,
    rest_watch,
    scaled_masses,
)
from gaspart.engines.features.part import (
    GravityPart,
    Part,
    ShearPart,
    gravity_of,
    kicks,
    shear_of,
    write_parts,
)
from gaspart.engines.features.tallies import EventPerAreaPart
from gaspart.errors import SimulationError
from gaspart.kernels.event import loop, prediction
from gaspart.kernels.event import neighbour_lists as lists
from gaspart.kernels.event.boxes import empty_lists
from gaspart.kernels.event.pair_contact import Monitors, Record
from gaspart.kernels.event.queue import EVENT_COUNT, empty_queue
from gaspart.kernels.memory import aligned_zeros
from gaspart.kernels.model import NONE, PREDICTION, Model, Oversized, Particles, Space, flight_dtype
from gaspart.kernels.physics.flight import advance_all, restart_clocks
from gaspart.scene.faces import GRADIENT
from gaspart.scene.scene import Scene
from gaspart.state.boxes import Boxes, boxes_and_largest
from gaspart.state.optional_tallies import OptionalTally
from gaspart.state.state import State
from gaspart.state.tally import Tally

# Model and particles of the event-driven engine's kernels, and the parts of a run.


def particles_of(state: State, boxes: Boxes) -> Particles:
    """Return the particles of a state as arrays of the kernels, without predictions of events."""
    n = state.count
    particles = Particles(
        flights=aligned_zeros((n,), flight_dtype(state.dimension)),
        images=state.images.copy(),
        predictions=aligned_zeros((n,), PREDICTION),
    )
    flights, predictions = particles.flights, particles.predictions
    flights["position"], flights["velocity"] = state.positions, state.velocities
    flights["radius"] = state.radii
    predictions["partner"], predictions["box"] = NONE, boxes.coordinates(state.positions)
    return particles


def event_model(
    scene: Scene, state: State, seed: int | tuple[int, ...], boxes: Boxes, largest: float
) -> tuple[Model, float]:
    """Return the kernels' model of a scene and its unit of mass; `largest` radius of particles in boxes."""
    law = contact_law(scene, state)
    law = law._replace(duration=contact_duration(scene, law)) if law else None
    unit_mass, masses = (1.0, None) if law else scaled_masses(state.masses)
    oversized, warm = np.flatnonzero(state.radii > largest), warm_walls(scene, state, seed, unit_mass)
    moving = moving_wall_of(scene, state, unit_mass)
    faces = special_faces(scene, state, seed, unit_mass) if has_special_faces(scene) else None
    model = Model(
        space=Space(scene.container.lengths, scene.container.periodic, float(not scene.centres_to_walls)),
        masses=masses,
        gravity=gravity_of(scene, state),
        law=law,
        faces=faces,
        walls=interior_walls(scene, boxes, largest, warm, moving) if scene.walls else None,
        oversized=Oversized(oversized, largest) if len(oversized) else None,
        shear=shear_of(scene),
        reservoirs=reservoirs_of(scene, seed, faces.open) if faces and faces.open else None,
    )
    return model, unit_mass


def event_parts(
    scene: Scene, state: State, seed: int | tuple[int, ...], model: Model, unit_mass: float
) -> list[Part]:
    """Return the parts of a run, one for each feature of the scene."""
    gravity, law, faces, walls = model.gravity, model.law, model.faces, model.walls
    lightest = float(state.masses.min(initial=np.inf))
    parts = (
        GravityPart(gravity, scene.container.lengths) if gravity else None,
        FacesPart(scene, faces, unit_mass, lightest) if faces else None,
        WarmWallsPart(scene, walls.warm, lightest) if walls and walls.warm else None,
        MovingWallPart(walls.moving, unit_mass) if walls and walls.moving else None,
        ShearPart(scene, state, model.shear) if model.shear else None,
        VibratingPart(scene, faces.motion) if faces and faces.motion else None,
        PistonPart(faces.piston, scene) if faces and faces.piston else None,
        OpenPart(scene, faces.open, model.reservoirs) if faces and faces.open else None,
        LawPart(law) if law else None,
        DurationPart(law, law.duration, gravity) if law and law.duration else None,
        kicks(scene, seed, unit_mass),
        rest_watch(scene, state),
        EventPerAreaPart(scene, state, unit_mass) if scene.has_unequal_areas else None,
    )
    return [part for part in parts if part]


def wrap(positions: np.ndarray, images: np.ndarray, space: Space) -> None:
    """Move particles that rounding put beyond a periodic face to the face, which they reach just now."""
    lengths = np.array(space.lengths)
    outside = ((positions < 0.0) | (positions >= lengths)) & space.periodic
    if not outside.any():
        return
    beyond = np.nonzero(outside)
    there, length = positions[beyond], lengths[beyond[1]]
    crossed = np.where(there < 0.0, -1, 1)
    there = there - crossed * length
    positions[beyond] = np.where(there >= length, 0.0, there)
    images[beyond] += crossed


class EventDynamics(Dynamics):
    """Running scene under the event-driven engine. Each particle has a clock. A run is divided into epochs,
    and times on the clocks are relative to the start of the current epoch, so that they keep their precision.
    """

    numbers = ("start", "epoch", "base", "quiet", "clock", "since")

    def __init__(
        self,
        scene: Scene,
        state: State,
        seed: int | tuple[int, ...],
        search: str,
        boxes_per_side: int | tuple[int, ...] | None,
        tallies: Sequence[OptionalTally] = (),
    ) -> None:
        state = with_room(scene, state)
        self._scene, self._reference, n = scene, state, state.count
        self._search = chosen_search(scene, search, boxes_per_side is not None)
        with_boxes = self._search == "boxes"
        self._grid, largest = boxes_and_largest(scene, boxes_per_side if with_boxes else 1)
        self._grid = self._grid if scene.shear_rate is None else self._grid.cut(GRADIENT)
        self._particles = particles_of(state, self._grid)
        self._flights = self._particles.flights
        self._boxes = empty_lists(self._grid, n, neighbour_lists(scene) if self._search == "lists" else None)
        self._queue = None if self._search == "pairs" else empty_queue(n)
        self._event_count = np.zeros(1, dtype=np.int64)
        if self._queue:
            self._event_count = self._queue.cursor[EVENT_COUNT:]
        self._model, unit_mass = event_model(scene, state, seed, self._grid, largest)
        self._collapse = CollapsePart(self._model, n)
        self._parts = [*event_parts(scene, state, seed, self._model, unit_mass), self._collapse]
        self._parts += tally_parts(tallies, self._flights, self._model, unit_mass, scene, state)
        self._epochs = Epochs(scene, state.masses, sum(part.gained for part in self._parts))
        self._base, self._quiet = self._base_from(0.0), 0
        epochs, self._clock = divmod(state.time, self._base)
        self._start = epochs * self._base
        for part in self._parts:
            part.set_clock(self._clock)
        self._begin_epoch(self._base)
        self._flights["clock"] = self._clock
        self._tally = EventTally(scene, unit_mass, self._parts)
        self._tally.begin(self.time, self._clock)
        self._predict()

    def reset_tally(self) -> None:
        self._tally.reset(self.time, self._clock)

    def _make_lists(self) -> None:
        """Make the neighbour lists from the stored centres of the lists."""
        self._boxes = self._boxes._replace(lists=make_lists(self._boxes.lists, self._scene))

    def _predict(self) -> None:
        if self._boxes.lists:
            lists.centre_all(self._boxes.lists, self._flights, self._clock, self._model.space.lengths)
            self._make_lists()
        self._begin(anew=True)

    def _begin(self, anew: bool) -> None:
        """Make the queue of events. Predict all events again if `anew` is True."""
        if self._queue:
            free = self._model._replace(masses=None, law=None)  # contacts are not needed here
            scene = self._particles, self._queue, self._boxes, free, self._tally.arrays
            prediction.begin(*scene, self._clock, anew)

    @property
    def time(self) -> float:
        return self._start + self._clock

    def advance(
        self,
        until: float,
        max_events: int | None = None,
        log: EventLog | None = None,
        max_work: int | None = None,
    ) -> None:
        """Process events up to time `until`, at most `max_events` of them. Events are collisions, wall hits,
        and attempted entries through open faces. Raises SimulationError, with the state saved, in two cases.
        The first is a collapse: infinitely many collisions in a finite time. The second is a run without an
        end time in which no event occurs during a thousand flights through the container. `max_work`: maximum
        work: the sum of the numbers of events, box crossings and predictions at the start of epochs. At this
        limit, the call returns before the time `until`. The work exceeds the limit by at most a factor of 2.
        """
        remaining, work = (
            np.iinfo(np.int64).max if number is None else number for number in (max_events, max_work)
        )
        many, begun = MANY, self._clock
        while remaining > 0 and work > 0:
            if self._at_rest:
                self._stay(until)
                return
            if many == 0:
                check_progress(self.time, self._clock - begun, self._epoch)
                many, begun = MANY, self._clock
            stop = until - self._start
            ends_epoch = stop > self._epoch
            part, end = min(self._parts, key=attrgetter("next")), min(stop, self._epoch)
            scheduled, end = part.next <= end, min(part.next, end)
            limits = end, min(remaining, many, work), min(MANY, work)
            reason, done, crossed, last = self._run(log.room if log else None, limits)
            remaining -= done
            many -= done
            work -= done + crossed
            self._quiet = 0 if done else self._quiet
            if log is not None:
                log.take(self._start)
            if reason == loop.STOP:
                work -= 1
                if scheduled:
                    self._clock = end
                    if part.apply_event(self._particles, self._model, self._tally.arrays, self._start):
                        begun -= self._renew_epoch()
                        self._predict()
                        work -= len(self._flights)
                    continue
                if not ends_epoch:
                    self._clock = stop
                    return
                work -= len(self._flights)  # all events are predicted again
                begun -= self._next_epoch(endless=until == np.inf)
            else:
                self._clock = max(self._clock, last)
            if reason == loop.NO_ROOM:
                self._predict()
            if reason == loop.COLLAPSE:
                raise self._collapse.error(self.time)
            if reason == loop.CROWDED:
                raise crowded_error(self.time, len(self._flights))

    @property
    def _at_rest(self) -> bool:
        """True if all particles are permanently at rest."""
        return any(part.at_rest for part in self._parts)

    def _stay(self, until: float) -> None:
        """Advance the time to `until` in a scene whose particles are at rest."""
        if until == np.inf:
            raise SimulationError(
                f"at time {self.time:g} all particles are at rest: there are no more events"
            )
        self._clock = until - self._start

    def _run(self, record: Record | None, limits: tuple[float, int, int]) -> tuple[int, int, int, float]:
        """Run the kernel, and return why it stopped, numbers of events and crossings, and the last event's
        time.
        """
        monitors = Monitors(record, self._collapse.watch)
        scene = self._particles, self._queue, self._boxes, self._model, self._tally.arrays
        return loop.run(*scene, monitors, limits, () if self._queue is None else None)

    def _next_epoch(self, endless: bool) -> float:
        """Restart the clocks and predict all events; return the previous length. `endless`: no end
        in time.
        """
        length = self._epoch
        check_clocks(self._start, self._epoch)
        for part in self._parts:
            part.close_epoch(self._epoch)
        restart_clocks(self._flights, self._epoch, self._model.space, self._model.gravity)
        self._start += self._epoch
        self._clock = 0.0
        for part in self._parts:
            part.end_epoch(self._epoch, self._start)
        self._quiet += 1
        self._base = self._base_from(self._base)
        speed = self._epochs.speed(self._flights["velocity"])
        self._begin_epoch(self._epochs.quiet(speed, self._base, self._quiet))
        self._predict()
        if endless:
            flights = self._epochs.flights(self._flights["velocity"], self._epoch)
            check_events(self.time, self._quiet, flights)
        return length

    def _base_from(self, present: float) -> float:
        """Return the next epoch's length, before `Epochs.quiet` extends it, from the previous one
        likewise.
        """
        stored = sum(part.stored for part in self._parts)
        return self._epochs.base(self._flights["velocity"], stored, present)

    def _renew_epoch(self) -> float:
        """Start shorter epochs if the particles have become much faster. All particles must be at the present
        time. The new lengths are needed because an epoch of a gas at rest has no end. Returns the amount by
        which the start of the epoch has moved.
        """
        base, time = self._base_from(self._base), self.time
        if base >= self._base:
            return 0.0
        start = math.floor(time / base) * base
        later = start - self._start
        for part in self._parts:
            part.close_epoch(self._clock)
        restart_clocks(self._flights, self._clock, self._model.space, self._model.gravity)
        self._base, self._quiet, self._start, self._clock = base, 0, start, time - start
        self._flights["clock"] = self._clock
        for part in self._parts:
            part.end_epoch(later, start)
        self._begin_epoch(base)
        return later

    def _begin_epoch(self, length: float) -> None:
        """Set the length of the present epoch, and all data of parts that depend on it."""
        self._epoch = length
        for part in self._parts:
            self._model = part.begin_epoch(length, self._start, self._model)

    @property
    def tally(self) -> Tally:
        return self._tally.read(self.time, self._clock)

    @property
    def dissipated(self) -> float:
        return self._tally.dissipated

    @property
    def exchanged(self) -> float:
        return self._tally.exchanged

    def _present(self) -> np.ndarray:
        """Return the particles' flights (N,), moved to the present time."""
        flights = self._flights.copy()
        if not self._at_rest:
            advance_all(flights, self._clock, self._model.space, self._model.gravity)
        return flights

    @property
    def state(self) -> State:
        flights = self._present()
        state = replace(
            self._reference,
            time=self.time,
            positions=flights["position"].copy(),
            velocities=flights["velocity"].copy(),
            images=self._particles.images.copy(),
        )
        write_parts(self._parts, state, self._clock)
        wrap(state.positions, state.images, self._model.space)
        return state

    @property
    def _since(self) -> float:
        """Time of the last reset of the counters."""
        return self._tally.since

    @_since.setter
    def _since(self, time: float) -> None:
        self._tally.since = time

    def _arrays(self) -> dict[str, np.ndarray]:
        arrays = {**self._particles._asdict(), **self._tally.changing, **super()._arrays()}
        arrays |= {"event_count": self._event_count, "lost": self._tally.lost}
        if self._boxes.lists:
            arrays["centres"] = self._boxes.lists.listed["centre"]
        return arrays

    def _checkpoint_data(self) -> dict[str, Any]:
        """Return the data of a checkpoint: particles at their own times, predictions, counters, search.
        Neighbour lists are not stored, but only their capacity `room`. If the capacity does not suffice after
        the restart, all lists are made again; the counters of work then differ.
        """
        lists = self._boxes.lists
        room = {"room": (lists.room, lists.per_cell)} if lists else {}
        return {**super()._checkpoint_data(), **self._search_settings(), **room}

    def _search_settings(self) -> dict[str, Any]:
        """Return the search settings to which predictions and list centres belong."""
        return {"search": self._search, "boxes_per_side": self._grid.per_side}

    def _is_of_this_search(self, checkpoint: dict[str, np.ndarray]) -> bool:
        return all(
            np.array_equal(checkpoint.get(key, ()), value) for key, value in self._search_settings().items()
        )

    def _required_arrays(self, checkpoint: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Return the arrays required from a checkpoint, except the arrays of the search. If the checkpoint is
        from a different search, the centres of neighbour lists are not required.
        """
        spared = {
            *self._search_settings(),
            *(() if self._is_of_this_search(checkpoint) else ("centres", "room")),
        }
        return {key: array for key, array in self.checkpoint().items() if key not in spared}

    def _go_on(self, checkpoint: dict[str, np.ndarray]) -> None:
        """Start the epoch again. If the search has changed, all events are predicted again."""
        self._begin_epoch(self._epoch)
        if not self._is_of_this_search(checkpoint):
            self._particles.predictions["box"] = self._grid.coordinates(self._present()["position"])
            self._predict()
            return
        if self._boxes.lists:
            room = np.clip(checkpoint["room"], 1, 2 * (len(self._flights) + self._boxes.lists.room))
            lists = neighbour_lists(self._scene, *room.tolist())
            lists.listed["centre"] = self._boxes.lists.listed["centre"]
            self._boxes = self._boxes._replace(lists=lists)
            self._make_lists()
        self._begin(anew=False)
