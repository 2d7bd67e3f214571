"""The event-driven engine (Spencer 2021 and 2022; Lubachevsky, J. Comput. Phys. 94, 255 (1991))."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gaspart.engines.common import EventLog, aligned, masses_for_kernel
from gaspart.errors import SceneError
from gaspart.scene import Scene
from gaspart.state import State
from gaspart.tally import Tally

SEARCHES = ("boxes", "direct", "pairs")
_LAP = 10  # a lap of the clocks is some 2^10 times of flight over a diameter
_STILL = 2.0**960  # the lap of a scene in which nothing moves


@dataclass(frozen=True)
class EventDriven:
    """From one event to the next, exactly.

    search: "boxes", with one next event per body in a queue; "direct", the same without a partition, each
    search over all bodies; "pairs", all pairs before every event (Spencer 2021, section 3.1), the referee.
    All three give the same bits. boxes_per_side: a number, or one per axis; by default about one a body.
    """

    search: str = "boxes"
    boxes_per_side: int | tuple[int, ...] | None = None

    name = "event"

    def __post_init__(self):
        if self.search not in SEARCHES:
            raise SceneError("search", self.search, f"must be one of {SEARCHES}")
        if self.search != "boxes" and self.boxes_per_side is not None:
            raise SceneError("boxes_per_side", self.boxes_per_side, 'needs search "boxes"')

    def start(self, scene: Scene, state: State) -> EventDynamics:
        """Set the engine up for a scene in a given state."""
        return EventDynamics(self, scene, state)


class EventDynamics:
    """A scene under way. Clocks count from the start of the current lap, lest they lose precision."""

    def __init__(self, engine: EventDriven, scene: Scene, state: State):
        from gaspart.boxes import make_boxes, sides_for
        from gaspart.engines import event_kernels as kernels
        from gaspart.engines.calendar import PLAN, empty_calendar

        self._kernels = kernels
        self._scene = scene
        self._reference = state
        d, n = scene.dimension, state.count
        self._rows = aligned((n, 8), float)
        self._rows[:, :d], self._rows[:, d : 2 * d] = state.positions, state.velocities
        self._rows[:, 2 * d + 1] = state.radii
        self._images = state.images.copy()
        per_side = engine.boxes_per_side or sides_for(scene, per_body=1.0)
        boxes = make_boxes(scene, per_side if engine.search == "boxes" else 1, images=True)
        self._by_pairs = engine.search == "pairs"
        self._space = kernels.Space(
            scene.container.lengths, scene.container.periodic, float(not scene.centres_to_walls)
        )
        self._plans = aligned((n,), PLAN)
        self._plans["partner"] = -1
        self._plans["at"] = boxes.coordinates(state.positions)
        self._partition = kernels.Partition(
            boxes.per_side, boxes.widths, boxes.strides, boxes.neighbour, boxes.shift,
            head=np.full(boxes.count, -1, dtype=np.int32),
        )  # fmt: skip
        self._calendar = empty_calendar(n)
        self._unit_mass, self._masses = masses_for_kernel(state.masses)
        self._lap = _lap_length(scene, state)
        self._laps, self._clock = divmod(state.time, self._lap)
        self._rows[:, 2 * d] = self._clock
        self.reset_tally()
        self._foresee()

    def reset_tally(self) -> None:
        """Begin to count anew."""
        faces = 2 * self._scene.dimension
        self._counters = self._kernels.Counters(
            np.zeros(5, dtype=np.int64), np.zeros(2), np.zeros(faces, dtype=np.int64), np.zeros(faces)
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
            )

    @property
    def time(self) -> float:
        return self._laps * self._lap + self._clock

    def advance(self, until: float, most: int | None = None, log: EventLog | None = None) -> None:
        """Process events up to time `until`, at most `most` of them (collisions and wall hits)."""
        left = np.iinfo(np.int64).max if most is None else most
        room = None if log is None else log.room
        while left > 0:
            stop = until - self._laps * self._lap
            ends_lap = stop > self._lap
            reason, done, last = self._run(room, min(stop, self._lap), left)
            left -= done
            if log is not None:
                log.take(self._laps * self._lap)
            if reason == self._kernels.STOP:
                if not ends_lap:
                    self._clock = stop
                    return
                self._turn_lap()
            elif done:
                self._clock = max(self._clock, last)

    def _run(self, room, stop: float, most: int) -> tuple[int, int, float]:
        """Let the kernel of this search run: why it stopped, the events it did, the time of the last."""
        common = self._space, self._partition, self._masses, self._counters, room, stop, most
        if self._by_pairs:
            return self._kernels.run_pairs(self._rows, self._images, self._plans, *common)
        return self._kernels.run_boxes(self._rows, self._images, self._plans, self._calendar, *common)

    def _turn_lap(self) -> None:
        """Start the clocks again from zero, and plan anew."""
        self._kernels.synchronise(self._rows, self._lap, self._space.lengths)
        self._laps += 1
        self._clock = 0.0
        self._foresee()

    @property
    def tally(self) -> Tally:
        kernels, counters = self._kernels, self._counters
        return Tally(
            time=self.time - self._since,
            collisions=int(counters.counts[kernels.COLLISIONS]),
            wall_hits=counters.wall_hits.copy(),
            wall_impulse=counters.wall_impulse * self._unit_mass,
            virial_sum=float(counters.sums[kernels.VIRIAL]) * self._unit_mass,
            pair_tests=int(counters.counts[kernels.PAIR_TESTS]),
            box_visits=int(counters.counts[kernels.BOX_VISITS]),
            crossings=int(counters.counts[kernels.CROSSINGS]),
            worst_contact=float(counters.sums[kernels.WORST]),
        )

    @property
    def state(self) -> State:
        """All bodies at the present time."""
        d = self._scene.dimension
        rows, lengths = self._rows, np.array(self._space.lengths)
        positions = rows[:, :d] + rows[:, d : 2 * d] * (self._clock - rows[:, 2 * d, None])
        periodic = np.array(self._space.periodic)
        # a body that reaches a periodic face just now may stand beyond it by rounding
        beyond = np.where(periodic, (positions >= lengths).astype(np.int64) - (positions < 0), 0)
        positions = positions - beyond * lengths
        positions = np.where(periodic & (positions >= lengths), 0.0, positions)
        return replace(
            self._reference,
            time=self.time,
            positions=positions,
            velocities=rows[:, d : 2 * d].copy(),
            images=self._images + beyond,
        )

    def checkpoint(self) -> dict[str, np.ndarray]:
        """All that a continuation to the same bits needs: bodies at their own clocks, plans, counts."""
        parts = {"laps": self._laps, "clock": self._clock, "since": self._since}
        parts.update(rows=self._rows, images=self._images, plans=self._plans, **self._counters._asdict())
        return {key: np.array(value) for key, value in parts.items()}

    def restore(self, parts: dict[str, np.ndarray]) -> None:
        """Go on from a checkpoint of the same scene and engine."""
        self._rows[...], self._images[...], self._plans[...] = parts["rows"], parts["images"], parts["plans"]
        for key, array in self._counters._asdict().items():
            array[...] = parts[key]
        self._laps, self._clock, self._since = (float(parts[key]) for key in ("laps", "clock", "since"))
        if not self._by_pairs:
            self._kernels.refill(self._plans, self._calendar, self._partition, self._clock)


def _lap_length(scene: Scene, state: State) -> float:
    """The time after which clocks start again from zero: a power of two, so that it scales with the units."""
    speed = float(np.sqrt((state.velocities**2).sum(axis=1).mean())) if state.count else 0.0
    if not speed > 0.0:
        return _STILL
    _, exponent = np.frexp(2 * scene.smallest_radius / speed)
    return float(np.ldexp(1.0, int(exponent) + _LAP))
