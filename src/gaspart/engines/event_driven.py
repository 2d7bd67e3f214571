"""The event-driven engine (Spencer 2021 and 2022; Lubachevsky, J. Comput. Phys. 94, 255 (1991))."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np

from gaspart.engines.common import (
    EventLog,
    law_for_kernel,
    masses_for_kernel,
    surfaces_for_kernel,
    tell_inner,
)
from gaspart.engines.laps import lap_length
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
_QUIET = 1000  # laps without an event after which a run without an end is given up
_BLINK = 2.0**-44  # of a lap: the longest bounce on a floor that is taken for rest
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

    def start(self, scene: Scene, state: State, seed: int | tuple[int, ...] = 0) -> EventDynamics:
        """Set the engine up for a scene in a given state; `seed` is that of thermal walls."""
        return EventDynamics(self, scene, state, seed)


class EventDynamics:
    """A scene under way. Clocks count from the start of the current lap, lest they lose precision."""

    def __init__(self, engine: EventDriven, scene: Scene, state: State, seed: int | tuple[int, ...]) -> None:
        from gaspart.beside import boxes_and_largest
        from gaspart.engines import all_pairs, event_kernels, flight, layout, lists
        from gaspart.engines.calendar import PLAN, TURN, empty_calendar

        self._kernels, self._all_pairs = event_kernels, all_pairs
        self._flight, self._layout = flight, layout
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
        self._lap = lap_length(scene, state)
        self._gravity = None
        if scene.gravity is not None and any(scene.gravity):
            self._gravity = layout.Gravity(scene.gravity, np.isinf(state.masses), _BLINK * self._lap)
        self._watch = None
        if self._law or self._gravity:
            inelastic = self._law and self._law.normal < 1.0
            most, within = (_INELASTIC_CROWD, _INELASTIC_CROWDED) if inelastic else (_CROWD, _CROWDED)
            start = np.full(n, -np.inf)
            self._watch = layout.Watch(start, np.zeros(n, dtype=np.int64), within * self._lap, most)
        self._lost = 0.0
        self._laps, self._clock = divmod(state.time, self._lap)
        self._rows[:, 2 * d] = self._clock
        self._count()
        self._foresee()

    def reset_tally(self) -> None:
        """Begin to count anew."""
        self._lost = self.dissipated
        self._count()

    def _count(self) -> None:
        """Counters that stand at nothing."""
        faces = 2 * self._scene.dimension + len(self._scene.walls)
        hits, impulse, energy = np.zeros(faces, dtype=np.int64), np.zeros(faces), np.zeros(faces)
        self._counters = self._layout.Counters(
            np.zeros(5, dtype=np.int64), np.zeros(3), hits, impulse, energy
        )
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
        return self._laps * self._lap + self._clock

    def advance(self, until: float, most: int | None = None, log: EventLog | None = None) -> None:
        """Process events up to time `until`, at most `most` of them (collisions and wall hits).

        Raises SimulationError, with the state kept, if bodies collapse: they would meet for ever in no time;
        and if nothing happens in a thousand laps of a run that only events would end.
        """
        quiet = 0
        left = np.iinfo(np.int64).max if most is None else most
        room = None if log is None else log.room
        many, begun = MANY, self._clock
        while left > 0:
            if many == 0:
                check_progress(self.time, self._clock - begun, self._lap)
                many, begun = MANY, self._clock
            stop = until - self._laps * self._lap
            ends_lap = stop > self._lap
            reason, done, last = self._run(room, min(stop, self._lap), min(left, many))
            left -= done
            many -= done
            if log is not None:
                log.take(self._laps * self._lap)
            if reason == self._layout.STOP:
                if not ends_lap:
                    self._clock = stop
                    return
                self._turn_lap()
                begun -= self._lap
                quiet = 0 if done else quiet + 1
                if until == np.inf and quiet > _QUIET:
                    raise SimulationError(
                        f"no event from time {self.time - quiet * self._lap:g} on: bodies miss one another"
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
        self._laps += 1
        self._clock = 0.0
        if self._watch:
            self._watch.since[:] -= self._lap
        self._foresee()

    @property
    def tally(self) -> Tally:
        """What was counted since the last `reset_tally`."""
        layout, counters = self._layout, self._counters
        return Tally(
            time=self.time - self._since,
            collisions=int(counters.counts[layout.COLLISIONS]),
            wall_hits=counters.wall_hits.copy(),
            wall_impulse=counters.wall_impulse * self._unit_mass,
            wall_energy=counters.wall_energy * self._unit_mass,
            virial_sum=float(counters.sums[layout.VIRIAL]) * self._unit_mass,
            pair_tests=int(counters.counts[layout.PAIR_TESTS]),
            box_visits=int(counters.counts[layout.BOX_VISITS]),
            crossings=int(counters.counts[layout.CROSSINGS]),
            worst_contact=float(counters.sums[layout.WORST]),
            dissipated_energy=float(counters.sums[layout.LOSS]),
        )

    @property
    def dissipated(self) -> float:
        """The energy that contacts and thermal walls have taken since time 0."""
        walls = float(self._counters.wall_energy.sum()) * self._unit_mass
        return self._lost + float(self._counters.sums[self._layout.LOSS]) + walls

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
        if self._surfaces:
            arrays.update({key: getattr(self._surfaces, key) for key in ("place", "held", "draws")})
        return arrays

    def checkpoint(self) -> dict[str, np.ndarray]:
        """All that a continuation to the same bits needs: bodies at their own clocks, plans, counts."""
        parts = {"laps": self._laps, "clock": self._clock, "since": self._since, "lost": self._lost}
        return {key: np.array(value) for key, value in {**parts, **self._arrays()}.items()}

    def restore(self, parts: dict[str, np.ndarray]) -> None:
        """Go on from a checkpoint of the same scene and engine."""
        for key, array in self._arrays().items():
            array[...] = parts[key]
        times = (float(parts[key]) for key in ("laps", "clock", "since", "lost"))
        self._laps, self._clock, self._since, self._lost = times
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
