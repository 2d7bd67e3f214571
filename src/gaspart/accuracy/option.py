"""An engine with its settings for a scene, and what a run with it costs.

The relative error of a run of a measured time t is its standard error sqrt(variance(t)) and, in full, the
bound on its bias. The bias is bounded by the engine, from theory or from measurements; noise and processor
time are those of a pilot run, or of the table, which has those of pilots that were kept.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass

from gaspart.accuracy.conditions import Conditions
from gaspart.accuracy.estimates import Component
from gaspart.accuracy.target import Target
from gaspart.analysis.observables import OBSERVABLES, require_modelled
from gaspart.analysis.run import EQUILIBRATION
from gaspart.engines import Engine, offered
from gaspart.engines.engine import Asked, Candidate
from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.trajectory.recipe import MOST_REPLICAS

WORTH = 1.5
"""Cost of the exact engine, divided by that of another engine, from which on the other one is preferred."""
_PER_EQUILIBRATION = 10.0  # smallest ratio of a replica's length to its equilibration


@dataclass(frozen=True)
class Option:
    """What a candidate needs for an accuracy.

    bias: the bound on its systematic error, by pilots too; noise: of the observable; speed: processor seconds
    per unit of time; accuracy: the wanted one; least, most: durations of the shortest run, and of the longest
    that is of use and within the budget; settling: the time before anything is measured, at least.
    """

    candidate: Candidate
    bias: float
    noise: Component
    speed: float
    accuracy: float
    least: float = 0.0
    most: float = math.inf
    settling: float = 0.0

    @property
    def engine(self) -> Engine:
        """With its settings."""
        return self.candidate.engine

    @property
    def measured(self) -> float:
        """The measured time for the wanted accuracy, or the longest one; inf if it is never reached."""
        return max(0.0, min(self._length(self.accuracy), self.part(self.most)))

    @property
    def duration(self) -> float:
        """Of the run, with what is not measured, inf likewise."""
        return self.whole(self.measured)

    @property
    def seconds(self) -> float:
        """Of processor time, inf likewise."""
        return self.duration * self.speed

    @property
    def error(self) -> float:
        """Relative standard error that the run reaches, with the bound on its bias; inf likewise."""
        measured = self.measured
        return self.bias + self.noise.reaches(measured) if math.isfinite(measured) else math.inf

    def cost(self, accuracy: float) -> float:
        """Processor seconds for an accuracy, without a budget; inf if it is never reached."""
        return self.whole(self._length(accuracy)) * self.speed

    def whole(self, measured: float) -> float:
        """The duration of a run with so long a measured part: a quarter of it is not measured, by default,
        and the time of settling never."""
        return max(measured + self.settling, measured / (1.0 - EQUILIBRATION))

    def part(self, duration: float) -> float:
        """The inverse: the measured part of a duration."""
        return min(duration - self.settling, (1.0 - EQUILIBRATION) * duration)

    def _length(self, accuracy: float) -> float:
        """The measured time for an accuracy, of a run that is not too short."""
        return max(self.noise.length(accuracy - self.bias), self.part(self.least))


def ordered(options: list[Option]) -> list[Option]:
    """Sort the best first: the cheapest of those that reach the accuracy, or else the most accurate one.

    The exact engine is preferred unless another one is `WORTH` times as cheap.
    """

    def key(one: Option) -> tuple[float, float]:
        seconds = one.seconds * (1.0 if one.engine.reference else WORTH)
        return max(one.error, one.accuracy * (1.0 + 1e-9)), seconds

    return sorted(options, key=key)


def replicas_of(option: Option, longest: float) -> int:
    """How many runs share the measured time: one for each processor, if each is much longer than its
    equilibration and no shorter than a run may be, and so many that none is longer than `longest`."""
    if not math.isfinite(option.measured):
        return 1
    shortest = max(_PER_EQUILIBRATION * option.settling, option.part(option.least))
    shared = min(os.cpu_count() or 1, int(option.measured / shortest)) if shortest > 0.0 else 1
    return min(MOST_REPLICAS, max(1, shared, math.ceil(option.duration / longest)))


# The engines that could run a scene, each with bounds on its errors from theory, which it states itself.
#
# A bound is relative and names what makes the error: the model (pairs drawn in cells instead of pairs that
# touch) or the discretisation (time step, cells).


def suited(target: Target) -> tuple[list[Engine], dict[str, str]]:
    """The engines that model a scene and an observable, the reference first, and why each other does not, by
    its name in the table."""
    made, refused = [], {}
    for engine in offered():
        try:
            engine.check_features(target.scene)
            require_modelled(target.observable, target.scene, engine)
            made.append(engine)
        except SceneError as error:
            refused[engine.timed_as] = f"{error.key}: {error.rule}"
    return made, refused


def candidates(
    target: Target, accuracy: float, conditions: Conditions
) -> tuple[list[Candidate], dict[str, str]]:
    """The `suited` engines with their settings, and why each other is none. accuracy: of the observable, for
    which time steps are chosen; conditions: of the steady scene."""
    engines, refused = suited(target)
    asked, made = asked_of(target, accuracy, conditions), []
    for engine in engines:
        try:
            made.append(engine.candidate(asked))
        except SceneError as error:
            refused[engine.timed_as] = f"{error.key}: {error.rule}"
    return made, refused


def asked_of(target: Target, accuracy: float, conditions: Conditions) -> Asked:
    """What engines are asked for."""
    governed = transported(target.scene, target.observable)
    presses = target.declared.of_impulses  # a force has the relative errors of a pressure
    observable = "pressure" if presses else target.observable
    return Asked(
        observable, accuracy, conditions, target.face, governed, target.initial,
        memory=conditions.memory, points=conditions.of_points(observable, target.face),
    )  # fmt: skip


def transported(scene: Scene, observable: str) -> bool:
    """Whether transport coefficients govern an observable: those of lags, and any where something drives a
    flow of heat or of momentum."""
    lost = scene.dissipates
    flows = len(scene.face_temperatures) > 1 or lost or bool(scene.sliding_faces)
    return OBSERVABLES[observable].memory or flows
