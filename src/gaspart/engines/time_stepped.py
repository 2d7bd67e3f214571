"""The time-stepped engine (Frederickx & Meerts 2010), with the contact put right."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import DTypeLike

from gaspart.boxes import check_boxes_per_side
from gaspart.engines.common import EventLog, masses_for_kernel, tell_inner
from gaspart.engines.step_settings import (
    changing,
    check_late,
    check_precision,
    check_scene,
    check_step,
    giants_of,
    largest_terms,
    needs_rules,
    rules_for,
)
from gaspart.errors import SceneError
from gaspart.scene import Scene, count_of, number
from gaspart.state import State
from gaspart.tally import Tally
from gaspart.validation import choice

PRECISIONS = ("float64", "float32")
_MOST_STEPS = 2.0**53  # above, float64 does not distinguish their numbers


@dataclass(frozen=True)
class TimeStepped:
    """Small steps; pairs that overlap after a step are put right.

    time_step: in the scene's time unit. boxes_per_side: search the boxes of a grid, a number of them or one
    per axis, down to 1 (all pairs); by default a neighbour list is used instead, with a `skin` (a length)
    that the engine chooses unless it is given. near_boxes: look only into boxes within reach of a contact.
    precision: "float64" or "float32". rewind: collide pairs as they were at their contact (off: as they lie
    after the step, to measure what rewinding buys). passes: how often a step may look for overlaps; it ends
    with the first pass that finds none. With more than one, overlaps that grew and shrank within the step
    count too; one is the rule of Frederickx & Meerts. docs/time-stepped.md tells what each of these buys.

    threads: how many share the work of a list; not worth it below some 5e4 bodies (docs/performance.md).

    The result is the same, bit for bit, for any boxes_per_side, near_boxes, skin and threads.
    """

    time_step: float
    boxes_per_side: int | tuple[int, ...] | None = None
    precision: str = "float64"
    rewind: bool = True
    passes: int = 4
    skin: float | None = None
    near_boxes: bool = False
    threads: int = 1

    name: ClassVar[Literal["step"]] = "step"

    def __post_init__(self) -> None:
        step = number("time_step", self.time_step, "must be positive", above=0.0)
        object.__setattr__(self, "time_step", step)
        choice("precision", self.precision, PRECISIONS)
        for key in ("rewind", "near_boxes"):
            if not isinstance(getattr(self, key), bool):
                raise SceneError(key, getattr(self, key), "must be true or false")
        for key in ("passes", "threads"):
            count_of(key, getattr(self, key), least=1)
        if self.boxes_per_side is not None:
            check_boxes_per_side(self.boxes_per_side)
        if self.skin is not None:
            if self.boxes_per_side is not None:
                raise SceneError("skin", self.skin, "excludes boxes_per_side")
            object.__setattr__(self, "skin", number("skin", self.skin, "must be positive", above=0.0))
        if self.near_boxes and self.boxes_per_side is None:
            raise SceneError("near_boxes", True, "needs boxes_per_side")

    def start(self, scene: Scene, state: State, seed: int | tuple[int, ...] = 0) -> StepDynamics:
        """Set the engine up for a scene in a given state; `seed` is that of thermal walls."""
        return StepDynamics(self, scene, state, seed)


class StepDynamics:
    """A scene under way; its time is a whole number of steps."""

    def __init__(self, engine: TimeStepped, scene: Scene, state: State, seed: int | tuple[int, ...]) -> None:
        from gaspart.engines import running_sum, step_eight
        from gaspart.engines import step_kernels as kernels
        from gaspart.engines import step_layout as layout
        from gaspart.engines import step_search as search

        giants = giants_of(state)
        check_scene(scene, state, giants)
        check_precision(engine, scene, state)
        check_step(engine, state)
        self._kernels, self._layout, self._sums = kernels, layout, running_sum
        self._engine, self._scene, self._reference = engine, scene, state
        self._real = real = np.dtype(engine.precision).type
        normal = 1.0 if scene.restitution is None else scene.restitution.normal
        self._space = layout.Space(
            tuple(real(length) for length in scene.container.lengths),
            scene.container.periodic,
            real(not scene.centres_to_walls),
            *(real(number) for number in (normal, 0.5 * (1.0 + normal))),
        )
        self._unit_mass, masses = masses_for_kernel(state.masses)
        if needs_rules(scene):
            self._unit_mass, masses = 1.0, state.masses
        masses = np.ones(state.count) if masses is None else masses
        shape = (scene.dimension, state.count)
        self._bodies = layout.Bodies(
            step_eight.roomy(shape, real),
            np.empty(shape, real),
            np.empty(shape, np.int32),
            radii=step_eight.roomy((state.count,), real),
            index=np.empty(state.count, np.uint32),
            masses=masses.astype(real),
            ordinary=int(state.count - giants.sum()),
        )
        slots = np.argsort(giants, kind="stable")  # giants last
        self._place(slots, state.positions, state.velocities, state.images)
        ordinary = state.radii[~giants]
        self._inset = real(self._space.margin * real(ordinary.max(initial=0.0)))
        self._partition = search.partition_for(engine, scene, state, ordinary)
        self._cells = search.cells_for(engine, scene, state, ordinary)
        self._rules, self._law = rules_for(engine, scene, state, seed, self._unit_mass)
        self._gravity = None if scene.gravity is None else tuple(real(g) for g in scene.gravity)
        self._watch = layout.Watch(step_eight.roomy((state.count,), np.uint32), np.zeros(2))
        self._watch.reach[layout.SPENT] = np.inf  # no list is made yet
        self._pairs = np.empty((engine.threads, state.count // engine.threads + 16), np.uint64)
        self._threads = engine.threads if engine.threads > 1 else None
        self._largest = largest_terms(scene, state, self._unit_mass)
        self._lost = np.zeros(2)  # net and gross, before the tally began
        self._step = real(engine.time_step)
        self._start, self._steps = state.time, 0
        self._count()

    def _place(
        self, slots: np.ndarray, positions: np.ndarray, velocities: np.ndarray, images: np.ndarray
    ) -> None:
        """Put the bodies into their slots: (N,) which body is in each."""
        bodies = self._bodies
        bodies.positions[...] = positions[slots].T
        bodies.velocities[...] = velocities[slots].T
        bodies.images[...] = images.T
        bodies.radii[...] = self._reference.radii[slots]
        bodies.index[...] = slots

    def _by_body(self, values: np.ndarray, dtype: DTypeLike) -> np.ndarray:
        """(N, d) of the bodies in their own order, from (d, N) by slot."""
        found = np.empty(values.shape[::-1], dtype)
        found[self._bodies.index] = values.T
        return found

    def reset_tally(self) -> None:
        """Begin to count anew."""
        self._lost = np.array([self.dissipated, self.exchanged])
        self._count()

    def _count(self) -> None:
        """Counters that stand at nothing."""
        faces = (self._engine.threads, 2 * self._scene.dimension)
        if self._rules:
            self._rules.heat[:] = 0
        self._counters = self._layout.Counters(
            counts=np.zeros(8, dtype=np.int64),
            sums=np.zeros((2, 2)),
            extremes=np.zeros(2),
            wall_hits=np.zeros(faces, dtype=np.int64),
            wall_impulse=np.zeros((*faces, 2), dtype=np.int64),
            wall_loss=np.zeros((self._engine.threads, 2), dtype=np.int64),
            momentum=self._largest[0],
            energy=self._largest[1],
        )
        self._since = self._steps

    @property
    def dissipated(self) -> float:
        """The energy that contacts and thermal walls have taken since time 0."""
        return float(self._lost[0]) + self._sums.net(*self._loss, self._heat) * self._unit_mass

    @property
    def exchanged(self) -> float:
        """The sum of what contacts and each face have taken or given since time 0, each counted positive."""
        gross = self._sums.net(*self._loss) + float(np.abs(self._heat.sum(axis=1)).sum())
        return float(self._lost[1]) + gross * self._unit_mass

    @property
    def _heat(self) -> np.ndarray:
        """(2d, 2) what each face was given by bodies that left it at its temperature, since the tally began,
        in two parts, in units of the unit mass."""
        if self._rules is None:
            return np.zeros((2 * self._scene.dimension, 2))
        return self._sums.whole_parts(self._rules.heat, self._largest[1])

    @property
    def _loss(self) -> tuple[np.ndarray, np.ndarray]:
        """The energy that contacts of bodies (2,) and with walls (threads, 2) have taken, likewise."""
        counters = self._counters
        return counters.sums[self._layout.LOSS], self._sums.whole_parts(counters.wall_loss, self._largest[1])

    @property
    def time(self) -> float:
        """The time reached, at the end of a step."""
        return self._start + self._steps * self._engine.time_step

    def advance(self, until: float, most: int | None = None, log: EventLog | None = None) -> None:
        """Step to the last whole step not after `until` (to within 1e-9 of a step).

        Raises SceneError for what only the event-driven engine can do, count or record events, and for a time
        that is not within 2^53 steps.
        """
        if most is not None:
            raise SceneError("max_events", most, 'needs the "event" engine; this one knows steps only')
        if log is not None:
            raise SceneError("record_events", True, 'needs the "event" engine; this one knows steps only')
        steps = (until - self._start) / self._engine.time_step
        if not steps < _MOST_STEPS:
            rule = f"must be within {_MOST_STEPS:g} steps of {self._engine.time_step:g}"
            raise SceneError("until", until, rule)
        target = int(np.floor(steps * (1.0 + 4e-16) + 1e-9))
        if target > self._steps:
            if self._threads is not None:
                from numba import config, set_num_threads

                set_num_threads(min(self._threads, config.NUMBA_NUM_THREADS))
            self._pairs = self._kernels.run_steps(
                self._bodies, self._space, self._partition, self._cells, self._pairs, self._gravity,
                self._inset, self._rules, self._law, self._step, target - self._steps, self._engine.rewind,
                self._engine.passes, self._watch, self._counters, self._threads,
            )  # fmt: skip
            self._steps = target
            layout, counts = self._layout, self._counters.counts
            found = (int(counts[n]) for n in (layout.COLLISIONS, layout.LATE, layout.PASSED))
            check_late(self._engine, self.time, *found)

    @property
    def state(self) -> State:
        """All bodies at the present time, in float64 whatever the precision."""
        state = replace(
            self._reference,
            time=self.time,
            positions=self._by_body(self._bodies.positions, float),
            velocities=self._by_body(self._bodies.velocities, float),
            images=self._bodies.images.T.astype(self._reference.images.dtype),
        )
        if self._rules:
            tell_inner(state, self._scene, self._law, self._rules.surfaces, self._unit_mass)
        return state

    @property
    def tally(self) -> Tally:
        """What was counted since the last `reset_tally`."""
        layout, counts, sums = self._layout, self._counters.counts, self._counters.sums
        extremes = self._counters.extremes
        impulse = self._sums.whole_parts(self._counters.wall_impulse.sum(axis=0), self._largest[0])
        return Tally(
            time=(self._steps - self._since) * self._engine.time_step,
            collisions=int(counts[layout.COLLISIONS]),
            wall_hits=self._counters.wall_hits.sum(axis=0),
            wall_impulse=impulse.sum(axis=-1) * self._unit_mass,
            wall_energy=self._heat.sum(axis=1) * self._unit_mass,
            virial_sum=self._sums.net(sums[layout.VIRIAL]) * self._unit_mass,
            pair_tests=int(counts[layout.PAIR_TESTS]),
            box_visits=int(counts[layout.BOX_VISITS]),
            worst_contact=float(extremes[layout.WORST]),
            steps=self._steps - self._since,
            overlaps_left=int(counts[layout.OVERLAPS_LEFT]),
            deepest_overlap=float(extremes[layout.DEEPEST]),
            multiple_contacts=int(counts[layout.MULTIPLE]),
            rebuilds=int(counts[layout.REBUILDS]),
            dissipated_energy=self._sums.net(*self._loss) * self._unit_mass,
        )

    def checkpoint(self) -> dict[str, np.ndarray]:
        """Everything that a continuation to the same bits needs."""
        bodies = self._bodies
        return {
            "steps": np.array(self._steps),
            "since": np.array(self._since),
            "lost": self._lost.copy(),
            "positions": self._by_body(bodies.positions, self._real),
            "velocities": self._by_body(bodies.velocities, self._real),
            "images": bodies.images.T.copy(),
            "slots": bodies.index.copy(),
            **({} if self._cells is None else {"origin": self._cells.origin.copy()}),
            **{key: array.copy() for key, array in changing(self._rules, self._law).items()},
            "reach": self._watch.reach.copy(),
            **{key: np.array(value) for key, value in self._counters._asdict().items()},
        }

    def restore(self, parts: dict[str, np.ndarray]) -> None:
        """Go on from a checkpoint of the same scene and engine."""
        self._place(*(parts[key] for key in ("slots", "positions", "velocities", "images")))
        if self._cells is not None and parts["reach"][self._layout.SPENT] < np.inf:
            self._list_from(parts["origin"])
        self._watch.reach[...] = parts["reach"]
        for key in ("counts", "sums", "extremes", "wall_hits", "wall_impulse", "wall_loss"):
            getattr(self._counters, key)[...] = parts[key]
        for key, array in changing(self._rules, self._law).items():
            array[...] = parts[key]
        self._steps, self._since = int(parts["steps"]), int(parts["since"])
        self._lost = parts["lost"].copy()

    def _list_from(self, origin: np.ndarray) -> None:
        """Make the list again that was made when bodies were at `origin` (d, N), by slot."""
        now = self._bodies.positions.copy()
        self._bodies.positions[...] = origin
        self._pairs = self._kernels.make_list(
            self._bodies, self._space, self._cells, self._pairs, self._watch, self._counters, self._threads
        )
        self._bodies.positions[...] = now
