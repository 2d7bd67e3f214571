"""Engine with its settings for a scene, and the cost of a run with this engine.

The relative error of a run with measured time t is its standard error sqrt(variance(t)) plus the full bound
on the bias. The engine computes the bound on its bias from theory or from measurements. Noise and CPU time
come from a pilot run, or from the table, which stores results of earlier pilots.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass

from gaspart import theory
from gaspart.accuracy.advisers import adviser_of, candidate_engines, timed_as
from gaspart.accuracy.estimates import Component
from gaspart.accuracy.of_engine import AccuracyRequest, Candidate
from gaspart.accuracy.table import EQUILIBRATION as EQUILIBRATED
from gaspart.accuracy.table import LEAST
from gaspart.accuracy.target import Target
from gaspart.analysis.observables import OBSERVABLES, require_modelled
from gaspart.analysis.run import EQUILIBRATION
from gaspart.engines import Engine
from gaspart.errors import SceneError
from gaspart.scene.facts import Gas
from gaspart.scene.scene import Scene
from gaspart.theory.conditions import Conditions
from gaspart.trajectory.recipe import MOST_REPLICAS

WORTH = 1.5
"""Another engine is preferred to the exact engine if the cost of the exact engine is at least this many times
higher.
"""
_PER_EQUILIBRATION = 10.0  # smallest ratio of a replica's length to its equilibration


@dataclass(frozen=True)
class Option:
    """Candidate engine with the cost of an accurate run.

    bias : upper bound of the relative systematic error, from theory and from pilots.
    noise : noise of the observable.
    speed : CPU seconds per unit of time.
    accuracy : requested accuracy.
    least, most : durations of the shortest run, and of the longest run that is useful and within the budget.
    settling : minimum time before the measurement begins.
    discarded : minimum fraction of a run before the measurement begins.
    """

    candidate: Candidate
    bias: float
    noise: Component
    speed: float
    accuracy: float
    least: float = 0.0
    most: float = math.inf
    settling: float = 0.0
    discarded: float = EQUILIBRATION

    @property
    def engine(self) -> Engine:
        """Engine with its settings."""
        return self.candidate.engine

    @property
    def measured(self) -> float:
        """Measured time for the requested accuracy, or the maximum time; inf if out of reach."""
        return max(0.0, min(self._length(self.accuracy), self.part(self.most)))

    @property
    def duration(self) -> float:
        """Duration of the run including its discarded part; inf if the accuracy is out of reach."""
        return self.whole(self.measured)

    @property
    def seconds(self) -> float:
        """CPU time of the run in seconds; inf if the accuracy is out of reach."""
        return self.duration * self.speed

    @property
    def error(self) -> float:
        """Relative standard error plus the bound on the bias; inf if no run is long enough."""
        measured = self.measured
        return self.bias + self.noise.reaches(measured) if math.isfinite(measured) else math.inf

    def cost(self, accuracy: float) -> float:
        """Compute the CPU seconds for an accuracy without a budget; inf if it cannot be reached."""
        return self.whole(self._length(accuracy)) * self.speed

    def whole(self, measured: float) -> float:
        """Compute the duration of a run from its measured part: a quarter, at least `settling`, is
        discarded.
        """
        return max(measured + self.settling, measured / (1.0 - self.discarded))

    def part(self, duration: float) -> float:
        """Compute the duration of the measured part of a run, the inverse of `whole`."""
        return min(duration - self.settling, (1.0 - self.discarded) * duration)

    def _length(self, accuracy: float) -> float:
        """Compute the measured time for an accuracy, at least the shortest allowed time."""
        return max(self.noise.length(accuracy - self.bias), self.part(self.least))


def fluid_option(
    gas: Gas,
    candidate: Candidate,
    each: float,
    noise: float,
    accuracy: float,
    value: float = 1.0,
    discarded: float = EQUILIBRATION,
) -> Option:
    """Return the option of an engine for a fluid, by the cost of a contact. `each`: CPU time per contact.
    `noise`: relative variance of the observable times the number of contacts. `value`: value of the
    observable. `discarded`: minimum fraction of a run before the measurement begins.
    """
    frequency = float(theory.collision_rate(**gas.parameters))
    contacts = 0.5 * gas.count * frequency  # per time
    spectrum = noise / contacts * value**2
    component = Component(value, value, LEAST / frequency, spectrum, freedom=math.inf)
    settling = EQUILIBRATED / frequency
    limits = settling + LEAST / frequency, math.inf, settling, discarded
    return Option(candidate, candidate.bias, component, each * contacts, accuracy, *limits)


def sort_by_cost(options: list[Option]) -> list[Option]:
    """Sort accurate options by cost, the others by accuracy; the exact engine first unless `WORTH` dearer."""

    def key(option: Option) -> tuple[float, float]:
        seconds = option.seconds * (1.0 if option.engine.reference else WORTH)
        return max(option.error, option.accuracy * (1.0 + 1e-9)), seconds

    return sorted(options, key=key)


def replicas_of(option: Option, longest: float) -> int:
    """Return the number of replicas among which the measured time is divided. The number is at most one
    replica per processor. Each replica must be much longer than its equilibration, at least as long as the
    shortest allowed run, and at most as long as `longest`.
    """
    if not math.isfinite(option.measured):
        return 1
    shortest = max(_PER_EQUILIBRATION * option.settling, option.part(option.least))
    shared = min(os.cpu_count() or 1, int(option.measured / shortest)) if shortest > 0.0 else 1
    return min(MOST_REPLICAS, max(1, shared, math.ceil(option.duration / longest)))


# Candidate engines for a scene. Each engine computes bounds on its own errors from theory.
#
# A bound is a relative error. Its name states the cause: the model (collision pairs drawn at random in cells)
# or the discretisation (time step, cells).


def suitable_engines(target: Target) -> tuple[list[Engine], dict[str, str]]:
    """Return the engines for a scene and an observable, the exact one first, and reasons for the others."""
    suitable, refused = [], {}
    for engine in candidate_engines():
        try:
            engine.check_features(target.scene)
            require_modelled(target.observable, target.scene, engine)
            suitable.append(engine)
        except SceneError as error:
            refused[timed_as(engine)] = f"{error.key}: {error.rule}"
    return suitable, refused


def candidates(
    target: Target, accuracy: float, conditions: Conditions
) -> tuple[list[Candidate], dict[str, str]]:
    """Return the `suitable_engines` with their settings, and the reason for each rejected engine. `accuracy`:
    requested accuracy of the observable, from which time steps are chosen. `conditions`: local conditions of
    the steady scene.
    """
    engines, refused = suitable_engines(target)
    request, proposals = make_request(target, accuracy, conditions), []
    for engine in engines:
        try:
            proposals.append(adviser_of(engine).candidate(request))
        except SceneError as error:
            refused[timed_as(engine)] = f"{error.key}: {error.rule}"
    return proposals, refused


def make_request(target: Target, accuracy: float, conditions: Conditions) -> AccuracyRequest:
    """Return the request to engines for an observable and an accuracy."""
    governed = depends_on_transport(target.scene, target.observable)
    presses = target.declared.of_impulses  # a force has the same relative error as a pressure
    observable = "pressure" if presses else target.observable
    return AccuracyRequest(observable, accuracy, conditions, target.face, governed, target.initial)


def depends_on_transport(scene: Scene, observable: str) -> bool:
    """Return True if an observable has lags, or the scene drives a flow of heat or momentum."""
    lost = scene.dissipates
    flows = len(scene.face_temperatures) > 1 or lost or bool(scene.sliding_faces)
    return OBSERVABLES[observable].memory or flows
