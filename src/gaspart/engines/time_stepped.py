"""The time-stepped engine (Frederickx & Meerts 2010), with the contact put right."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gaspart.engines.common import EventLog, masses_for_kernel
from gaspart.errors import SceneError
from gaspart.scene import Scene, number
from gaspart.state import State
from gaspart.tally import Tally

PRECISIONS = ("float64", "float32")
_BOXES_PER_BODY = 8.0  # near the optimum of figure ideal_boxes


@dataclass(frozen=True)
class TimeStepped:
    """Small steps; pairs that overlap after a step are put right.

    time_step: in the scene's time unit; boxes_per_side: a number, or one per axis, down to 1 (all pairs),
    by default about eight boxes per body; precision: "float64" or "float32"; rewind: collide pairs as they
    were at their contact (off: as they lie after the step, to measure what rewinding buys).
    """

    time_step: float
    boxes_per_side: int | tuple[int, ...] | None = None
    precision: str = "float64"
    rewind: bool = True

    name = "step"

    def __post_init__(self):
        step = number("time_step", self.time_step, "must be positive", above=0.0)
        object.__setattr__(self, "time_step", step)
        if self.precision not in PRECISIONS:
            raise SceneError("precision", self.precision, f"must be one of {PRECISIONS}")
        if not isinstance(self.rewind, bool):
            raise SceneError("rewind", self.rewind, "must be true or false")

    def start(self, scene: Scene, state: State, seed: int | tuple[int, ...] = 0) -> StepDynamics:
        """Set the engine up for a scene in a given state; nothing of it depends on `seed`."""
        return StepDynamics(self, scene, state)


class StepDynamics:
    """A scene under way; its time is a whole number of steps."""

    dissipated = 0.0

    def __init__(self, engine: TimeStepped, scene: Scene, state: State):
        from gaspart.boxes import make_boxes, sides_for, widest
        from gaspart.engines import step_kernels as kernels

        rough = scene.restitution is not None and not scene.restitution.smooth_and_elastic
        for key, value in (
            ("gravity", scene.gravity),
            ("restitution", scene.restitution if rough else None),
            ("walls", scene.walls or None),
            ("faces", scene.faces or None),
            ("fixed", True if np.isinf(state.masses).any() else None),
        ):
            if value is not None:
                raise SceneError(key, value, 'needs the "event" engine; this one knows none')
        for length, periodic in zip(scene.container.lengths, scene.container.periodic, strict=True):
            if periodic and length < 2 * widest(scene):
                rule = "the time-stepped engine needs periodic sides of two largest diameters"
                raise SceneError("lengths", scene.container.lengths, rule)
        self._kernels = kernels
        self._engine = engine
        self._scene = scene
        self._reference = state
        real = np.dtype(engine.precision).type
        per_side = engine.boxes_per_side or sides_for(scene, per_body=_BOXES_PER_BODY)
        boxes = make_boxes(scene, per_side, images=False)
        self._space = kernels.Space(
            tuple(real(length) for length in scene.container.lengths),
            scene.container.periodic,
            real(not scene.centres_to_walls),
        )
        self._bodies = kernels.Bodies(
            state.positions.astype(real),
            state.velocities.astype(real),
            state.images.copy(),
            state.radii.astype(real),
        )
        self._partition = kernels.Partition(
            boxes.per_side, boxes.widths.astype(real), boxes.strides, boxes.neighbour,
            at=np.zeros((state.count, 3), dtype=np.int64),
            head=np.empty(boxes.count, dtype=np.int32),
            following=np.empty(state.count, dtype=np.int32),
        )  # fmt: skip
        self._unit_mass, masses = masses_for_kernel(state.masses)
        self._masses = None if masses is None else masses.astype(real)
        self._step = real(engine.time_step)
        self._start, self._steps = state.time, 0
        self.reset_tally()

    def reset_tally(self) -> None:
        """Begin to count anew."""
        faces = 2 * self._scene.dimension
        self._counters = self._kernels.Counters(
            np.zeros(5, dtype=np.int64), np.zeros(3), np.zeros(faces, dtype=np.int64), np.zeros(faces)
        )
        self._since = self._steps

    @property
    def time(self) -> float:
        return self._start + self._steps * self._engine.time_step

    def advance(self, until: float, most: int | None = None, log: EventLog | None = None) -> None:
        """Step to the last whole step not after `until` (to within 1e-9 of a step).

        Raises SceneError for what only the event-driven engine can do: count or record events.
        """
        if most is not None:
            raise SceneError("max_events", most, 'needs the "event" engine; this one knows steps only')
        if log is not None:
            raise SceneError("record_events", True, 'needs the "event" engine; this one knows steps only')
        steps = (until - self._start) / self._engine.time_step
        target = int(np.floor(steps * (1.0 + 4e-16) + 1e-9))
        if target > self._steps:
            self._kernels.run_steps(
                self._bodies, self._space, self._partition, self._masses, self._step,
                target - self._steps, self._engine.rewind, self._counters,
            )  # fmt: skip
            self._steps = target

    @property
    def state(self) -> State:
        """All bodies at the present time, in float64 whatever the precision."""
        return replace(
            self._reference,
            time=self.time,
            positions=self._bodies.positions.astype(float),
            velocities=self._bodies.velocities.astype(float),
            images=self._bodies.images.copy(),
        )

    @property
    def tally(self) -> Tally:
        kernels, counters = self._kernels, self._counters
        return Tally(
            time=(self._steps - self._since) * self._engine.time_step,
            collisions=int(counters.counts[kernels.COLLISIONS]),
            wall_hits=counters.wall_hits.copy(),
            wall_impulse=counters.wall_impulse * self._unit_mass,
            wall_energy=np.zeros(len(counters.wall_impulse)),
            virial_sum=float(counters.sums[kernels.VIRIAL]) * self._unit_mass,
            pair_tests=int(counters.counts[kernels.PAIR_TESTS]),
            box_visits=int(counters.counts[kernels.BOX_VISITS]),
            worst_contact=float(counters.sums[kernels.WORST]),
            steps=self._steps - self._since,
            overlaps_left=int(counters.counts[kernels.OVERLAPS_LEFT]),
            deepest_overlap=float(counters.sums[kernels.DEEPEST]),
            multiple_contacts=int(counters.counts[kernels.MULTIPLE]),
        )

    def checkpoint(self) -> dict[str, np.ndarray]:
        """Everything that a continuation to the same bits needs."""
        parts = {"steps": self._steps, "since": self._since}
        for group in (self._bodies, self._counters):
            parts.update(group._asdict())
        return {key: np.array(value) for key, value in parts.items()}

    def restore(self, parts: dict[str, np.ndarray]) -> None:
        """Go on from a checkpoint of the same scene and engine."""
        for group in (self._bodies, self._counters):
            for key, array in group._asdict().items():
                array[...] = parts[key]
        self._steps, self._since = int(parts["steps"]), int(parts["since"])
