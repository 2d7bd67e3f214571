"""The event-driven engine (Spencer 2021 and 2022; Lubachevsky, J. Comput. Phys. 94, 255 (1991))."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np

from gaspart.boxes import check_boxes_per_side
from gaspart.engines.common import (
    EventLog,
    law_for_kernel,
    masses_for_kernel,
    surfaces_for_kernel,
    tell_inner,
)
from gaspart.engines.laps import QUIET, lap_length, quiet_lap
from gaspart.engines.progress import MANY, check_progress
from gaspart.errors import SceneError, SimulationError
from gaspart.memory import aligned
from gaspart.scene import Scene
from gaspart.state import State
from gaspart.tally import Tally
from gaspart.validation import choice

if TYPE_CHECKING:
    from gaspart.engines.layout import Record

SEARCHES = ("boxes", "direct", "pairs")
_QUIET = QUIET + 2000  # laps without an event after which a run without an end is given up
_NUMBERS = ("start", "lap", "base", "quiet", "clock", "since")  # of a checkpoint
_BLINK = 2.0**-44  # of a lap: the longest bounce on a floor that is taken for rest
_LOW = 2.0**-44  # of the container: the highest bounce on an interior wall that is taken for rest
# More contacts of one body than these, within so much of a lap, are taken for a collapse. Intervals between
# inelastic contacts shrink geometrically until rounding lets the bodies part, so few of them are left to see.
_CROWD, _CROWDED = 1000, _BLINK
_INELASTIC_CROWD, _INELASTIC_CROWDED = 12, 2.0**-34


@dataclass(frozen=True)
class EventDriven:
    """From one event to the next, exactly.

    search: "boxes", with one next event per body in a queue; "direct", the same without a partition, each
    search over all bodies; "pairs", all pairs before every event (Spencer 2021, section 3.1), the referee.
    All three give the same bits. boxes_per_side: a number, or one per axis; by default about one a body.

    No box is narrower than the diameters of the bodies in it. A few bigger bodies can stand beside the boxes,
    each of them tested by every small one near it: by default the largest of all, if that saves a quarter of
    what is looked at in a search (`beside`); with `boxes_per_side`, those that are wider than a box, which
    must be fewer than the others.
    """

    search: str = "boxes"
    boxes_per_side: int | tuple[int, ...] | None = None

    name: ClassVar[Literal["event"]] = "event"

    def __post_init__(self) -> None:
        choice("search", self.search, SEARCHES)
        if self.search != "boxes" and self.boxes_per_side is not None:
            raise SceneError("boxes_per_side", self.boxes_per_side, 'needs search "boxes"')
        if self.boxes_per_side is not None:
            check_boxes_per_side(self.boxes_per_side)

    def start(self, scene: Scene, state: State, seed: int | tuple[int, ...] = 0) -> EventDynamics:
        """Set the engine up for a scene in a given state; `seed` is that of thermal walls."""
        return EventDynamics(self, scene, state, seed)


class EventDynamics:
    """A scene under way. Clocks count from the start of the current lap, lest they lose precision."""

    def __init__(self, engine: EventDriven, scene: Scene, state: State, seed: int | tuple[int, ...]) -> None:
        from gaspart.beside import boxes_and_largest
        from gaspart.engines import all_pairs, event_kernels, flight, layout, lists, running_sum
        from gaspart.engines.calendar import PLAN, TURN, empty_calendar

        self._kernels, self._all_pairs = event_kernels, all_pairs
        self._flight, self._layout, self._sums = flight, layout, running_sum
        self._scene = scene
        self._reference = state
        d, n = scene.dimension, state.count
        self._rows = aligned((n, 8), float)
        self._rows[:, :d], self._rows[:, d : 2 * d] = state.positions, state.velocities
        self._rows[:, 2 * d + 1] = state.radii
        self._images = state.images.copy()
        by_boxes = engine.search == "boxes"
        boxes, largest = boxes_and_largest(scene, engine.boxes_per_side if by_boxes else 1)
        self._big = None
        if largest < scene.largest_radius:
            bodies = np.flatnonzero(state.radii > largest)
            self._big = layout.Big(bodies, largest)
        self._by_pairs = engine.search == "pairs"
        self._space = layout.Space(
            scene.container.lengths, scene.container.periodic, float(not scene.centres_to_walls)
        )
        self._plans = aligned((n,), PLAN)
        self._plans["partner"] = -1
        self._plans["at"] = boxes.coordinates(state.positions)
        self._partition = lists.empty_partition(boxes, n)
        self._walls = None
        if scene.walls:
            from gaspart import plates, segments

            pieces, wall = segments.segments_of(scene) if d == 2 else plates.plates_of(scene)
            find = segments.segments_near if d == 2 else plates.plates_near
            self._walls = layout.Walls(pieces, wall, *find(pieces, boxes, largest), largest)
        self._calendar = empty_calendar(n)
        self._turn = self._calendar.cursor[TURN:]
        self._law = law_for_kernel(scene, state)
        self._unit_mass, self._masses = (1.0, None) if self._law else masses_for_kernel(state.masses)
        self._surfaces = surfaces_for_kernel(scene, state, seed, self._unit_mass) if scene.faces else None
        self._lightest = float(state.masses.min(initial=np.inf))
        self._gravity = self._watch = None
        if scene.gravity is not None and any(scene.gravity):
            support = layout.no_support(n, _LOW * max(scene.container.lengths)) if scene.walls else None
            self._gravity = layout.Gravity(scene.gravity, np.isinf(state.masses), 0.0, support)
        if self._law or self._gravity:
            inelastic = self._law and self._law.normal < 1.0
            most, self._crowded = (_INELASTIC_CROWD, _INELASTIC_CROWDED) if inelastic else (_CROWD, _CROWDED)
            self._watch = layout.Watch(np.full(n, -np.inf), np.zeros(n, dtype=np.int64), 0.0, most)
        self._lost = np.zeros(2)  # net and gross, before the tally began
        self._base, self._quiet = lap_length(scene, state.velocities, self._lightest), 0
        self._begin_lap(self._base)
        laps, self._clock = divmod(state.time, self._lap)
        self._start = laps * self._lap
        self._rows[:, 2 * d] = self._clock
        self._count()
        self._foresee()

    def reset_tally(self) -> None:
        """Begin to count anew."""
        self._lost = np.array([self.dissipated, self.exchanged])
        self._count()

    def _count(self) -> None:
        """Counters that stand at nothing."""
        faces = 2 * self._scene.dimension + len(self._scene.walls)
        self._counters = self._layout.zero_counters(faces)
        self._since = self.time

    def _foresee(self) -> None:
        if not self._by_pairs:
            self._kernels.foresee_all(
                self._rows,
                self._plans,
                self._calendar,
                self._space,
                self._partition,
                self._counters,
                self._clock,
                self._gravity,
                self._walls,
                self._surfaces,
                self._big,
            )

    @property
    def time(self) -> float:
        """The time reached."""
        return self._start + self._clock

    def advance(self, until: float, most: int | None = None, log: EventLog | None = None) -> None:
        """Process events up to time `until`, at most `most` of them (collisions and wall hits).

        Raises SimulationError, with the state kept, if bodies collapse: they would meet for ever in no time;
        and if nothing happens in a thousand flights through the container, where only events end the run.
        """
        left = np.iinfo(np.int64).max if most is None else most
        room = None if log is None else log.room
        many, begun = MANY, self._clock
        while left > 0:
            if many == 0:
                check_progress(self.time, self._clock - begun, self._lap)
                many, begun = MANY, self._clock
            stop = until - self._start
            ends_lap = stop > self._lap
            reason, done, last = self._run(room, min(stop, self._lap), min(left, many))
            left -= done
            many -= done
            self._quiet = 0 if done else self._quiet
            if log is not None:
                log.take(self._start)
            if reason == self._layout.STOP:
                if not ends_lap:
                    self._clock = stop
                    return
                begun -= self._lap
                self._turn_lap()
                if until == np.inf and self._quiet > _QUIET:
                    raise SimulationError(
                        f"no event up to time {self.time:g} in {self._quiet} laps of the clocks: "
                        "bodies miss one another"
                    )
            elif done:
                self._clock = max(self._clock, last)
            if reason == self._layout.COLLAPSE and self._watch is not None:
                body, most, within = self._watch.contacts.argmax(), self._watch.most, self._watch.blink
                raise SimulationError(
                    f"at time {self.time:g} body {body} has had {most} contacts within a time of {within:g}: "
                    "an inelastic collapse, or a stack at rest; the state is that of the present time"
                )

    def _run(self, room: Record | None, stop: float, most: int) -> tuple[int, int, float]:
        """Let the kernel of this search run: why it stopped, the events it did, the time of the last."""
        common = self._space, self._partition, self._masses, self._counters, room, stop, most
        common = *common, self._gravity, self._law, self._watch, self._walls, self._surfaces
        if self._by_pairs:
            return self._all_pairs.run_pairs(self._rows, self._images, self._plans, *common)
        return self._kernels.run_boxes(
            self._rows, self._images, self._plans, self._calendar, *common, self._big
        )

    def _turn_lap(self) -> None:
        """Start the clocks again from zero, and plan anew."""
        self._flight.synchronise(self._rows, self._lap, self._space, self._gravity)
        self._start += self._lap
        self._clock = 0.0
        if self._watch:
            self._watch.since[:] -= self._lap
        self._quiet += 1
        velocities = self._rows[:, self._scene.dimension : 2 * self._scene.dimension]
        self._base = lap_length(self._scene, velocities, self._lightest, self._base)
        self._begin_lap(quiet_lap(self._scene, velocities, self._lightest, self._base, self._quiet))
        self._foresee()

    def _begin_lap(self, length: float) -> None:
        """Let the present lap have this length, and with it all times that are too short for the clocks."""
        self._lap = length
        if self._gravity:
            self._gravity = self._gravity._replace(blink=_BLINK * length)
        if self._watch:
            self._watch = self._watch._replace(blink=self._crowded * length)

    @property
    def tally(self) -> Tally:
        """What was counted since the last `reset_tally`."""
        layout, counters = self._layout, self._counters
        return Tally(
            time=self.time - self._since,
            collisions=int(counters.counts[layout.COLLISIONS]),
            wall_hits=counters.wall_hits.copy(),
            wall_impulse=self._sums.values(counters.wall_impulse) * self._unit_mass,
            wall_energy=self._sums.values(counters.wall_energy) * self._unit_mass,
            virial_sum=self._sums.net(counters.sums[layout.VIRIAL]) * self._unit_mass,
            pair_tests=int(counters.counts[layout.PAIR_TESTS]),
            box_visits=int(counters.counts[layout.BOX_VISITS]),
            crossings=int(counters.counts[layout.CROSSINGS]),
            worst_contact=float(counters.worst[0]),
            dissipated_energy=self._sums.net(counters.sums[layout.LOSS]),
        )

    @property
    def dissipated(self) -> float:
        """The energy that contacts and thermal walls have taken since time 0."""
        taken = self._counters.sums[self._layout.LOSS], self._counters.wall_energy
        return float(self._lost[0]) + self._sums.net(*taken) * self._unit_mass

    @property
    def exchanged(self) -> float:
        """The sum of what contacts and each face have taken or given since time 0, each counted positive."""
        loss, walls = self._counters.sums[self._layout.LOSS], self._sums.values(self._counters.wall_energy)
        gross = self._sums.net(loss) + float(np.abs(walls).sum())
        return float(self._lost[1]) + gross * self._unit_mass

    @property
    def state(self) -> State:
        """All bodies at the present time."""
        d = self._scene.dimension
        rows, lengths = self._rows.copy(), np.array(self._space.lengths)
        self._flight.advance_rows(rows, self._clock, self._space, self._gravity)
        positions, images = rows[:, :d].copy(), self._images.copy()
        # a body that reaches a periodic face just now may stand beyond it by rounding
        outside = (positions < 0.0) | (positions >= lengths)
        beyond = np.nonzero(outside & self._space.periodic)
        there, length = positions[beyond], lengths[beyond[1]]
        laps = np.where(there < 0.0, -1, 1)
        there = there - laps * length
        positions[beyond] = np.where(there >= length, 0.0, there)
        images[beyond] += laps
        state = replace(
            self._reference,
            time=self.time,
            positions=positions,
            velocities=rows[:, d : 2 * d].copy(),
            images=images,
        )
        tell_inner(state, self._scene, self._law, self._surfaces, self._unit_mass)
        return state

    def _arrays(self) -> dict[str, np.ndarray]:
        """Everything that the kernels change and that cannot be made again, by name."""
        arrays = {"rows": self._rows, "images": self._images, "plans": self._plans, "turn": self._turn}
        arrays.update(self._counters._asdict())
        if self._law:
            arrays["spins"] = self._law.spins
            if self._law.vibrations is not None:
                arrays["vibrations"] = self._law.vibrations
        if self._watch:
            arrays.update(crowd_since=self._watch.since, crowd=self._watch.contacts)
        if self._gravity and self._gravity.support:
            support = self._gravity.support._asdict()
            arrays.update({f"support_{key}": support[key] for key in support if key != "height"})
        if self._surfaces:
            arrays.update({key: getattr(self._surfaces, key) for key in ("place", "held", "draws")})
        return arrays

    def checkpoint(self) -> dict[str, np.ndarray]:
        """All that a continuation to the same bits needs: bodies at their own clocks, plans, counts."""
        parts = {**{key: getattr(self, f"_{key}") for key in _NUMBERS}, "lost": self._lost}
        return {key: np.array(value) for key, value in {**parts, **self._arrays()}.items()}

    def restore(self, parts: dict[str, np.ndarray]) -> None:
        """Go on from a checkpoint of the same scene and engine."""
        for key, array in self._arrays().items():
            array[...] = parts[key]
        for key in _NUMBERS:
            setattr(self, f"_{key}", parts[key].item())
        self._lost = parts["lost"].copy()
        self._begin_lap(self._lap)
        if not self._by_pairs:
            self._kernels.refill(
                self._rows,
                self._plans,
                self._calendar,
                self._space,
                self._partition,
                self._clock,
                self._gravity,
            )
