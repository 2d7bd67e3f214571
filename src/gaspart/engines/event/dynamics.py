"""A scene under the event-driven engine: the arrays that its kernels work on, and how they are driven."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gaspart.engines.arrays import EventLog, check_parts, write_internal
from gaspart.engines.event.clock_epochs import Epochs
from gaspart.engines.event.model import changing, event_model, monitors
from gaspart.engines.event.search import chosen_search, make_lists, neighbour_lists
from gaspart.engines.event.stalling import (
    MANY,
    check_events,
    check_progress,
    collapsed,
)
from gaspart.engines.event.tally import EventTally
from gaspart.engines.features import piston
from gaspart.engines.features.rest import rest_watch
from gaspart.engines.features.stress import StressSums
from gaspart.engines.features.thermostat import kicks
from gaspart.engines.features.vibrating import begin_epoch
from gaspart.errors import SimulationError
from gaspart.kernels.memory import aligned
from gaspart.scene.scene import Scene
from gaspart.state.oversized import boxes_and_largest
from gaspart.state.state import State
from gaspart.state.tally import Tally

if TYPE_CHECKING:
    from gaspart.kernels.event.monitors import Record
    from gaspart.kernels.model import Space

_NUMBERS = ("start", "epoch", "base", "quiet", "clock")  # of a checkpoint
_SHORTEST_BOUNCE = 2.0**-44  # of an epoch: the longest bounce on a floor that is taken for rest


class EventDynamics:
    """A scene in progress. Clocks count from the start of the current epoch, so that they lose no
    precision."""

    def __init__(
        self,
        scene: Scene,
        state: State,
        seed: int | tuple[int, ...],
        search: str,
        boxes_per_side: int | tuple[int, ...] | None,
        stress: bool = False,
    ) -> None:
        from gaspart.kernels import model
        from gaspart.kernels.event import loop, prediction
        from gaspart.kernels.event import neighbour_lists as lists
        from gaspart.kernels.event.box_lists import empty_lists
        from gaspart.kernels.event.queue import EVENT_COUNT, empty_queue
        from gaspart.kernels.physics import flight

        self._loop, self._prediction, self._flight, self._lists = loop, prediction, flight, lists
        self._scene = scene
        self._reference = state
        n = state.count
        search = chosen_search(scene, search, boxes_per_side is not None)
        self._search = search
        self._grid, largest = boxes_and_largest(scene, boxes_per_side if search == "boxes" else 1)
        self._particles = model.Particles(
            flights=aligned((n,), model.flight_dtype(scene.dimension)),
            images=state.images.copy(),
            predictions=aligned((n,), model.PREDICTION),
        )
        self._flights = self._particles.flights
        self._flights["position"], self._flights["velocity"] = state.positions, state.velocities
        self._flights["radius"] = state.radii
        self._particles.predictions["partner"] = model.NONE
        self._particles.predictions["box"] = self._grid.coordinates(state.positions)
        self._boxes = empty_lists(self._grid, n, neighbour_lists(scene) if search == "lists" else None)
        self._queue = None if search == "pairs" else empty_queue(n)
        self._event_count = np.zeros(1, dtype=np.int64)
        if self._queue:
            self._event_count = self._queue.cursor[EVENT_COUNT:]
        self._model, self._unit_mass = event_model(scene, state, seed, self._grid, largest)
        self._duration = self._model.law.duration if self._model.law else None
        self._piston = self._model.faces.piston if self._model.faces else None
        self._monitors, self._interval = monitors(self._model, n)
        self._epochs = Epochs(scene, float(state.masses.min(initial=np.inf)))
        self._base, self._quiet = self._epochs.length(self._epochs.speed(state.velocities)), 0
        epochs, self._clock = divmod(state.time, self._base)
        self._start = epochs * self._base
        if self._piston:
            piston.set_clock(self._piston, self._clock)
        self._begin_epoch(self._base)
        self._rest = rest_watch(scene, state, self._clock)
        self._kicks = kicks(scene, seed, self._unit_mass)
        self._scheduled = self._rest or self._kicks  # no scene has both
        self._flights["clock"] = self._clock
        self._tally = EventTally(scene, self._unit_mass, self._duration, self._kicks, self.time)
        self._stress = StressSums(self._flights, self._model, self._unit_mass) if stress else None
        self._begin_stress()
        self._predict()

    def reset_tally(self) -> None:
        """Begin to count from zero."""
        self._tally.reset(self.time)
        self._begin_stress()

    def _begin_stress(self) -> None:
        """Let the tally have the stress, from zero on, if it was asked for."""
        if self._stress:
            self._stress.begin(self._clock)
            self._tally.arrays = self._tally.arrays._replace(stress=self._stress.arrays)

    def _make_lists(self) -> None:
        """Make the neighbour lists from their centres."""
        self._boxes = self._boxes._replace(lists=make_lists(self._boxes.lists, self._scene))

    def _predict(self) -> None:
        if self._boxes.lists:
            self._lists.centre_all(self._boxes.lists, self._flights, self._clock, self._model.space.lengths)
            self._make_lists()
        self._begin(anew=True)

    def _begin(self, anew: bool) -> None:
        """Make the queue, with all events predicted `anew` or as they are."""
        if self._queue:
            free = self._model._replace(masses=None, law=None)  # contacts do not matter here
            scene = self._particles, self._queue, self._boxes, free, self._tally.arrays
            self._prediction.begin(*scene, self._clock, anew)

    @property
    def time(self) -> float:
        """The time reached."""
        return self._start + self._clock

    def advance(
        self, until: float, most: int | None = None, log: EventLog | None = None, work: int | None = None
    ) -> None:
        """Process events up to time `until`, at most `most` of them (collisions and wall hits).

        work: the number of events, crossings and predictions of a new epoch after which to return as well, to
        within a factor of 2, at the time reached.

        Raises SimulationError, with the state kept, if particles collapse: they would meet for ever in no
        time; and if nothing happens in a thousand flights through the container, where only events end the
        run.
        """
        left, work = (np.iinfo(np.int64).max if number is None else number for number in (most, work))
        many, begun = MANY, self._clock
        while left > 0 and work > 0:
            if self._rest and self._rest.rests:
                self._stay(until)
                return
            if many == 0:
                check_progress(self.time, self._clock - begun, self._epoch)
                many, begun = MANY, self._clock
            stop = until - self._start
            ends_epoch = stop > self._epoch
            end = min(stop, self._epoch)
            scheduled = self._scheduled if self._scheduled and self._scheduled.next <= end else None
            if scheduled:
                end = scheduled.next
            limits = end, min(left, many, work), min(MANY, work)
            reason, done, crossed, last = self._run(log.room if log else None, limits)
            left -= done
            many -= done
            work -= done + crossed
            self._quiet = 0 if done else self._quiet
            if log is not None:
                log.take(self._start)
            if reason == self._loop.STOP:
                work -= 1 + len(self._flights)  # what follows predicts all anew
                if scheduled:
                    self._clock = end
                    if scheduled.happen(self._particles, self._model, self._tally.arrays, self._start):
                        self._predict()
                    continue
                if not ends_epoch:
                    self._clock = stop
                    return
                begun -= self._epoch
                self._next_epoch()
                if until == np.inf:
                    velocities = self._flights["velocity"]
                    check_events(self.time, self._quiet, self._epochs.flights(velocities, self._epoch))
            else:
                self._clock = max(self._clock, last)
            if reason == self._loop.NO_ROOM:
                self._predict()
            if reason == self._loop.COLLAPSE and self._monitors.collapse:
                raise collapsed(self.time, self._monitors.collapse)

    def _stay(self, until: float) -> None:
        """Let time pass in a scene at rest."""
        if until == np.inf:
            raise SimulationError(
                f"at time {self.time:g} all particles are at rest: there are no more events"
            )
        self._clock = until - self._start

    def _run(self, record: Record | None, limits: tuple[float, int, int]) -> tuple[int, int, int, float]:
        """Let the kernel run: why it stopped, the events and crossings it processed, the time of the last."""
        monitors = self._monitors._replace(record=record)
        scene = self._particles, self._queue, self._boxes, self._model, self._tally.arrays
        return self._loop.run(*scene, monitors, limits, () if self._queue is None else None)

    def _next_epoch(self) -> None:
        """Start the clocks again from zero, and predict all events anew."""
        if self._stress:
            self._stress.next_epoch(self._epoch)
        self._flight.restart_clocks(self._flights, self._epoch, self._model.space, self._model.gravity)
        self._start += self._epoch
        self._clock = 0.0
        if self._monitors.collapse:
            self._monitors.collapse.since[:] -= self._epoch
        if self._duration:
            self._duration.latest[:] -= self._epoch
            self._duration.met[:] -= self._epoch
        if self._scheduled:
            self._scheduled.begin_epoch(self._epoch, self._start)
        if self._piston:
            piston.next_epoch(self._piston, self._epoch)
        self._quiet += 1
        speed = self._epochs.speed(self._flights["velocity"])
        self._base = self._epochs.length(speed, self._base)
        self._begin_epoch(self._epochs.quiet(speed, self._base, self._quiet))
        self._predict()

    def _begin_epoch(self, length: float) -> None:
        """Let the present epoch have this length, and with it all times that are too short for the clocks."""
        self._epoch = length
        if self._model.gravity:
            gravity = self._model.gravity._replace(shortest_bounce=_SHORTEST_BOUNCE * length)
            self._model = self._model._replace(gravity=gravity)
        if self._model.faces and self._model.faces.motion:
            begin_epoch(self._model.faces.motion, self._scene, self._start, length)
        if self._piston:
            piston.begin_epoch(self._piston, length)
        if self._monitors.collapse:
            collapse = self._monitors.collapse._replace(interval=self._interval * length)
            self._monitors = self._monitors._replace(collapse=collapse)

    @property
    def tally(self) -> Tally:
        """What was counted since the last `reset_tally`."""
        counted = self._tally.read(self.time)
        return replace(counted, **self._stress.read(self._clock)) if self._stress else counted

    @property
    def dissipated(self) -> float:
        """The energy that contacts and thermal walls have taken since time 0, less what kicks have given."""
        return self._tally.dissipated

    @property
    def exchanged(self) -> float:
        """The sum of what contacts and each face have taken or given since time 0, each counted positive."""
        return self._tally.exchanged

    def _present(self) -> np.ndarray:
        """The flights (N,) at the present time."""
        flights = self._flights.copy()
        if not (self._rest and self._rest.rests):
            self._flight.advance_all(flights, self._clock, self._model.space, self._model.gravity)
        return flights

    @property
    def state(self) -> State:
        """All particles at the present time."""
        space, flights = self._model.space, self._present()
        positions, images = flights["position"].copy(), self._particles.images.copy()
        _wrap(positions, images, space)
        state = replace(
            self._reference,
            time=self.time,
            positions=positions,
            velocities=flights["velocity"].copy(),
            images=images,
        )
        write_internal(state, self._scene, self._model.law, self._model.faces, self._unit_mass)
        if self._piston:
            state.piston = piston.motion_at(self._piston, self._clock, space.lengths)
        return state

    def _arrays(self) -> dict[str, np.ndarray]:
        """Everything that the kernels change and that cannot be made again, by name."""
        tallied = self._tally.arrays._asdict()
        tallied.pop("stress")
        arrays = {**self._particles._asdict(), **tallied, **changing(self._model)}
        if self._stress:
            arrays["stress"] = self._stress.arrays.sums
        arrays["event_count"] = self._event_count
        if self._boxes.lists:
            arrays["centres"] = self._boxes.lists.listed["centre"]
        if self._scheduled:
            arrays |= {f"scheduled_{key}": array for key, array in self._scheduled.arrays.items()}
        if collapse := self._monitors.collapse:
            arrays |= {"contacts_since": collapse.since, "contacts": collapse.contacts}
        return arrays

    def checkpoint(self) -> dict[str, np.ndarray]:
        """All that a continuation to the same bits needs: particles at their own clocks, predictions,
        counts."""
        parts = {key: getattr(self, f"_{key}") for key in _NUMBERS}
        parts |= {"since": self._tally.since, "lost": self._tally.lost, **self._arrays()}
        parts |= {"search": self._search, "boxes_per_side": self._grid.per_side}
        return {key: np.array(value) for key, value in parts.items()}

    def restore(self, parts: dict[str, np.ndarray]) -> None:
        """Go on from a checkpoint of the same scene, to the same bits whatever its search and boxes."""
        arrays = self._arrays()
        alike = str(parts.get("search")) == self._search
        alike = alike and np.array_equal(parts.get("boxes_per_side", ()), self._grid.per_side)
        if not alike:
            arrays.pop("centres", None)  # of other neighbour lists, or of none
        numbers = {key: np.array(getattr(self, f"_{key}")) for key in _NUMBERS}
        check_parts(
            parts, {**arrays, **numbers, "lost": self._tally.lost, "since": np.array(self._tally.since)}
        )
        for key, array in arrays.items():
            array[...] = parts[key]
        for key in _NUMBERS:
            setattr(self, f"_{key}", parts[key].item())
        self._tally.since, self._tally.lost = parts["since"].item(), parts["lost"].copy()
        self._begin_epoch(self._epoch)
        if not alike:
            self._particles.predictions["box"] = self._grid.coordinates(self._present()["position"])
            self._predict()
            return
        if self._boxes.lists:
            self._make_lists()
        self._begin(anew=False)


def _wrap(positions: np.ndarray, images: np.ndarray, space: Space) -> None:
    """Put particles back that rounding shows beyond a periodic face, which they reach just now."""
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
