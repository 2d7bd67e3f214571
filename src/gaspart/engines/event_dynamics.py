"""A scene under the event-driven engine: the arrays that its kernels work on, and how they are driven."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gaspart.engines import piston
from gaspart.engines.arrays import EventLog, write_internal
from gaspart.engines.clock_epochs import QUIET, epoch_length, quiet_epoch
from gaspart.engines.event_model import event_model, monitors
from gaspart.engines.event_search import chosen_search, make_lists, neighbour_lists
from gaspart.engines.kicks import kicks
from gaspart.engines.rest import rest_watch
from gaspart.engines.stalling import MANY, check_progress
from gaspart.engines.vibration import begin_epoch
from gaspart.errors import SimulationError
from gaspart.kernels.memory import aligned
from gaspart.scene.scene import Scene
from gaspart.state.oversized import boxes_and_largest
from gaspart.state.state import State
from gaspart.state.tally import Tally

if TYPE_CHECKING:
    from gaspart.kernels.event.monitors import Record

_QUIET = QUIET + 2000  # epochs without an event after which a run without an end is given up
_NUMBERS = ("start", "epoch", "base", "quiet", "clock", "since")  # of a checkpoint
_OF_DURATION = ("latest", "met", "island", "elastic", "kept")
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
    ) -> None:
        from gaspart.kernels import flight, model, running_sum
        from gaspart.kernels.event import loop
        from gaspart.kernels.event import neighbour_lists as lists
        from gaspart.kernels.event.box_lists import empty_lists
        from gaspart.kernels.event.queue import EVENT_COUNT, empty_queue

        self._loop, self._flight, self._kernels, self._sums = loop, flight, model, running_sum
        self._lists = lists
        self._scene = scene
        self._reference = state
        n = state.count
        search = chosen_search(scene, search, boxes_per_side is not None)
        boxes, largest = boxes_and_largest(scene, boxes_per_side if search == "boxes" else 1)
        self._particles = model.Particles(
            flights=aligned((n,), model.flight_dtype(scene.dimension)),
            images=state.images.copy(),
            predictions=aligned((n,), model.PREDICTION),
        )
        self._flights = self._particles.flights
        self._flights["position"], self._flights["velocity"] = state.positions, state.velocities
        self._flights["radius"] = state.radii
        self._particles.predictions["partner"] = model.NONE
        self._particles.predictions["box"] = boxes.coordinates(state.positions)
        self._boxes = empty_lists(boxes, n, neighbour_lists(scene) if search == "lists" else None)
        self._queue = None if search == "pairs" else empty_queue(n)
        self._event_count = np.zeros(1, dtype=np.int64)
        if self._queue:
            self._event_count = self._queue.cursor[EVENT_COUNT:]
        self._model, self._unit_mass = event_model(scene, state, seed, boxes, largest)
        self._duration = self._model.law.duration if self._model.law else None
        self._piston = self._model.faces.piston if self._model.faces else None
        self._monitors, self._interval = monitors(self._model, n)
        self._lightest = float(state.masses.min(initial=np.inf))
        self._lost = np.zeros(2)  # net and gross, before the tally began
        self._base, self._quiet = epoch_length(scene, state.velocities, self._lightest), 0
        epochs, self._clock = divmod(state.time, self._base)
        self._start = epochs * self._base
        if self._piston:
            piston.set_clock(self._piston, self._clock)
        self._begin_epoch(self._base)
        self._rest = rest_watch(scene, state, self._clock)
        self._kicks = kicks(scene, seed, self._unit_mass)
        self._scheduled = self._rest or self._kicks  # no scene has both
        self._flights["clock"] = self._clock
        self._count()
        self._predict()

    def reset_tally(self) -> None:
        """Begin to count from zero."""
        self._lost = np.array([self.dissipated, self.exchanged])
        self._count()

    def _count(self) -> None:
        """A tally at zero."""
        self._tally = self._kernels.empty_tally(2 * self._scene.dimension + len(self._scene.walls))
        if self._duration:
            self._duration.elastic[:], self._duration.kept[:] = 0, 0.0
        if self._kicks:
            self._kicks.reset()
        self._since = self.time

    def _make_lists(self) -> None:
        """Make the neighbour lists from their centres."""
        self._boxes = self._boxes._replace(lists=make_lists(self._boxes.lists, self._scene))

    def _predict(self) -> None:
        if self._boxes.lists:
            self._lists.centre_all(self._boxes.lists, self._flights, self._clock, self._model.space.lengths)
            self._make_lists()
        if self._queue:
            self._loop.predict_all(
                self._particles, self._queue, self._boxes, self._model, self._tally, self._clock
            )

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
                    if scheduled.happen(self._particles, self._model, self._tally):
                        self._predict()
                    continue
                if not ends_epoch:
                    self._clock = stop
                    return
                begun -= self._epoch
                self._next_epoch()
                if until == np.inf and self._quiet > _QUIET:
                    raise SimulationError(
                        f"no event up to time {self.time:g} in {self._quiet} epochs of the clocks: "
                        "particles miss one another"
                    )
            else:
                self._clock = max(self._clock, last)
            if reason == self._loop.NO_ROOM:
                self._predict()
            self._check_collapse(reason)

    def _check_collapse(self, reason: int) -> None:
        """Raise SimulationError if a collapse is why the kernel stopped."""
        if reason == self._loop.COLLAPSE and self._monitors.collapse is not None:
            collapse = self._monitors.collapse
            raise SimulationError(
                f"at time {self.time:g} particle {collapse.contacts.argmax()} has had "
                f"{collapse.most} contacts within a time of {collapse.interval:g}: "
                "an inelastic collapse, or a stack at rest; the state is that of the present time"
            )

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
        scene = self._particles, self._queue, self._boxes, self._model, self._tally
        return self._loop.run(*scene, monitors, limits, () if self._queue is None else None)

    def _next_epoch(self) -> None:
        """Start the clocks again from zero, and predict all events anew."""
        self._flight.restart_clocks(self._flights, self._epoch, self._model.space, self._model.gravity)
        self._start += self._epoch
        self._clock = 0.0
        if self._monitors.collapse:
            self._monitors.collapse.since[:] -= self._epoch
        if self._duration:
            self._duration.latest[:] -= self._epoch
            self._duration.met[:] -= self._epoch
        if self._scheduled:
            self._scheduled.begin_epoch(self._epoch)
        if self._piston:
            piston.next_epoch(self._piston, self._epoch)
        self._quiet += 1
        velocities = self._flights["velocity"]
        self._base = epoch_length(self._scene, velocities, self._lightest, self._base)
        self._begin_epoch(quiet_epoch(self._scene, velocities, self._lightest, self._base, self._quiet))
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
        kernels, tally, duration = self._kernels, self._tally, self._duration
        return Tally(
            time=self.time - self._since,
            collisions=int(tally.counts[kernels.COLLISIONS]),
            wall_hits=tally.wall_hits.copy(),
            wall_impulse=self._sums.values(tally.wall_impulse) * self._unit_mass,
            wall_energy=self._sums.values(tally.wall_energy) * self._unit_mass,
            virial_sum=self._sums.net(tally.sums[kernels.VIRIAL]) * self._unit_mass,
            pair_tests=int(tally.counts[kernels.PAIR_TESTS]),
            box_visits=int(tally.counts[kernels.BOX_VISITS]),
            crossings=int(tally.counts[kernels.CROSSINGS]),
            worst_contact=float(tally.worst[0]),
            dissipated_energy=self._sums.net(tally.sums[kernels.LOSS]),
            elastic_contacts=int(duration.elastic[0]) if duration else 0,
            retained_energy=self._sums.net(duration.kept) if duration else 0.0,
            thermostat_energy=self._given(),
        )

    @property
    def dissipated(self) -> float:
        """The energy that contacts and thermal walls have taken since time 0, less what kicks have given."""
        taken = self._tally.sums[self._kernels.LOSS], self._tally.wall_energy
        return float(self._lost[0]) + self._sums.net(*taken) * self._unit_mass - self._given()

    @property
    def exchanged(self) -> float:
        """The sum of what contacts and each face have taken or given since time 0, each counted positive."""
        loss, walls = self._tally.sums[self._kernels.LOSS], self._sums.values(self._tally.wall_energy)
        gross = self._sums.net(loss) + float(np.abs(walls).sum())
        return float(self._lost[1]) + gross * self._unit_mass + self._given()

    def _given(self) -> float:
        """The energy that kicks have given since the tally began."""
        return self._sums.net(self._kicks.given) * self._unit_mass if self._kicks else 0.0

    @property
    def state(self) -> State:
        """All particles at the present time."""
        space = self._model.space
        flights, lengths = self._flights.copy(), np.array(space.lengths)
        if not (self._rest and self._rest.rests):
            self._flight.advance_all(flights, self._clock, space, self._model.gravity)
        positions, images = flights["position"].copy(), self._particles.images.copy()
        # a particle that reaches a periodic face just now may stand beyond it by rounding
        outside = (positions < 0.0) | (positions >= lengths)
        beyond = np.nonzero(outside & space.periodic)
        there, length = positions[beyond], lengths[beyond[1]]
        crossed = np.where(there < 0.0, -1, 1)
        there = there - crossed * length
        positions[beyond] = np.where(there >= length, 0.0, there)
        images[beyond] += crossed
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
        arrays = {**self._particles._asdict(), "event_count": self._event_count, **self._tally._asdict()}
        law, faces, collapse = self._model.law, self._model.faces, self._monitors.collapse
        if self._boxes.lists:
            arrays["centres"] = self._boxes.lists.listed["centre"]
        if law:
            arrays["spins"] = law.spins
            if law.vibrations is not None:
                arrays["vibrations"] = law.vibrations
        if self._duration:
            arrays.update({f"contact_{key}": self._duration._asdict()[key] for key in _OF_DURATION})
            if self._model.gravity:
                arrays["gravity_fixed"] = self._model.gravity.fixed
        if self._scheduled:
            arrays.update({f"scheduled_{key}": array for key, array in self._scheduled.arrays.items()})
        if collapse:
            arrays.update(contacts_since=collapse.since, contacts=collapse.contacts)
        if self._model.gravity and self._model.gravity.support:
            support = self._model.gravity.support._asdict()
            arrays.update({f"support_{key}": support[key] for key in support if key != "height"})
        if faces:
            arrays.update({key: getattr(faces, key) for key in ("place", "held", "draws")})
        if self._piston:
            arrays["piston"] = self._piston.motion
        return arrays

    def checkpoint(self) -> dict[str, np.ndarray]:
        """All that a continuation to the same bits needs: particles at their own clocks, predictions,
        counts."""
        parts = {**{key: getattr(self, f"_{key}") for key in _NUMBERS}, "lost": self._lost}
        return {key: np.array(value) for key, value in {**parts, **self._arrays()}.items()}

    def restore(self, parts: dict[str, np.ndarray]) -> None:
        """Go on from a checkpoint of the same scene and engine."""
        for key, array in self._arrays().items():
            array[...] = parts[key]
        for key in _NUMBERS:
            setattr(self, f"_{key}", parts[key].item())
        self._lost = parts["lost"].copy()
        self._begin_epoch(self._epoch)
        if self._boxes.lists:
            self._make_lists()
        if self._queue:
            self._loop.restore(self._particles, self._queue, self._boxes, self._model, self._clock)
