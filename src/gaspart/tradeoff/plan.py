"""The cheapest engine and run for an accuracy of any observable of any steady scene, from pilot runs.

A run of a measured time t is off by at most |bias| + 1.96 sqrt(noise / t) in 95 % of all runs, relatively.
The noise and the processor time of a unit of time come from pilots; the bias is bounded by theory
(`gaspart.tradeoff.candidates`), and raised where two engines' pilots differ by more.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from gaspart.analysis.names import CURVES, PAIRS, PATHS, known
from gaspart.analysis.pairs import MOST_FRAMES
from gaspart.analysis.run import EQUILIBRATION
from gaspart.engines import Engine
from gaspart.engines.dsmc.rates import rates
from gaspart.errors import SceneError
from gaspart.scene.faces import LeesEdwards, Vibrating
from gaspart.scene.scene import Scene
from gaspart.scene.validation import number
from gaspart.tradeoff import PILOT_SECONDS
from gaspart.tradeoff.advice import ACCURACIES, at_temperature, is_driven, temperature_scatter
from gaspart.tradeoff.candidates import STRUCTURE, Candidate, candidates
from gaspart.tradeoff.pilot import (
    CORRELATED,
    DIFFUSION,
    Pilot,
    crossing,
    run_pilot,
    schedule,
    span,
    speed_of,
    tidy,
)
from gaspart.tradeoff.table import EQUILIBRATION as EQUILIBRATED
from gaspart.tradeoff.table import LEAST, QUANTILE
from gaspart.trajectory.recipe import Recipe
from gaspart.trajectory.until import OBSERVABLES, Accuracy, Until

_WORTH = 3.0
"""How many times as cheap as the first engine one must be to have a pilot of its own."""
_DIFFERS = 2.5
"""Standard errors by which two pilots differ if one is biased more than theory says."""
_FRAMES = 384
"""Of a run: 288 independent intervals give an error 17 degrees of freedom, and 15 are required."""
_LONGEST = 4.0
"""The longest duration of a run with `--until` over the predicted one: two examinations, and an error that
chance made too small in the pilot."""
_SETTLED = 2.0
"""The part of a run that is not measured, over the time in which the energy came to its mean in the pilot."""
_CROSSINGS = 10.0
"""How often a particle crosses a container with walls at least in a run."""
_POWERS = {
    **dict.fromkeys(("pressure", "temperature", "pressure_tensor", "vacf"), 1.0),
    **dict.fromkeys(("collision_rate", "pair_rates", "D", "mutual_diffusion", "msd", "speeds"), 0.5),
    **dict.fromkeys(("shear_viscosity", "bulk_viscosity", "thermal_conductivity"), 0.5),
}
"""The power of the temperature that observables grow with."""
Announce: TypeAlias = Callable[[str], None]


@dataclass(frozen=True)
class Option:
    """What a candidate needs. bias: the bound on its systematic error, by pilots too; duration: of the run,
    with its equilibration; seconds: of processor time; half_width: of the 95 % interval that this reaches,
    relative. Duration and seconds are infinite for an accuracy that it cannot reach."""

    candidate: Candidate
    speed: float
    bias: float
    duration: float
    seconds: float
    half_width: float


@dataclass(frozen=True)
class Plan:
    """The advice for a scene. options: of each engine, the best first; refused: why others cannot run it;
    value: of the observable by the pilots; pilots: their results; affordable: whether the best reaches the
    accuracy within the budget."""

    scene: Scene
    observable: str
    accuracy: float
    options: tuple[Option, ...]
    refused: dict[str, str]
    value: float
    pilots: tuple[Pilot, ...]
    affordable: bool

    @property
    def best(self) -> Option:
        """The option to take."""
        return self.options[0]

    @property
    def scatter(self) -> float:
        """Relative standard deviation of the observable from run to run by that of the energy, beyond the
        interval."""
        return _POWERS.get(self.observable, 0.0) * temperature_scatter(self.scene)

    @property
    def longest_interval(self) -> float:
        """Between frames: of diffusion by its lags; of an observable that they sample that of the pilot,
        whose noise is known."""
        if self.observable in DIFFUSION:
            return span(self.scene, self.observable)[0]
        sampled = self.observable in CURVES and self.observable not in STRUCTURE
        return min(one.interval for one in self.pilots) if sampled else math.inf

    @property
    def recipe(self) -> Recipe:
        """The run to make: until it is accurate where that can be asked, else of a fixed duration."""
        best = self.best
        scene, engine, correlations = self.scene, best.candidate.engine, None
        duration, interval = best.duration, min(best.duration / _FRAMES, self.longest_interval)
        interval = float(f"{interval:.3g}")
        if self.observable in CORRELATED:
            duration, interval, correlations = schedule(scene, engine, self.observable, duration)
        elif quantum := engine.resolved(scene).quantum:
            engine = engine.resolved(scene)
            interval = max(1, round(interval / quantum)) * quantum
        until = None
        if self.observable in OBSERVABLES and self.affordable:
            relative = (self.accuracy - best.bias) / QUANTILE
            asked = Accuracy(self.observable, float(f"{0.99 * relative:.3g}"))
            longest = max(_LONGEST * duration, *(one.duration for one in self.pilots))
            longest = min(longest, span(scene, self.observable)[1])
            until = Until((asked,), at_most=float(f"{longest:.2g}"))
        fixed = None if until else tidy(max(1, round(duration / interval)) * interval)
        return Recipe(
            scene, engine, 1, fixed, interval,
            displacements=self.observable in PATHS, correlations=correlations, until=until,
            pairs=self.observable in PAIRS,
        )  # fmt: skip


def plan(
    scene: Scene,
    observable: str,
    accuracy: float,
    budget: float | None = None,
    pilot_seconds: float = PILOT_SECONDS,
    announce: Announce = lambda text: None,
) -> Plan:
    """The cheapest run for a relative accuracy, half of a 95 % interval, of an observable of `gaspart
    measure`.

    budget: processor time in seconds of the run; if it does not suffice, the most accurate run within it is
    advised. pilot_seconds: of all pilots together. announce(text): is called before each pilot.

    Raises SceneError for a scene without a steady state, and for an observable that it does not have, or of
    which the pilots are too short to say anything.
    """
    low, high = ACCURACIES
    known(observable)
    accuracy = number("accuracy", accuracy, f"must be from {low:g} to {high:g}", least=low, most=high)
    if budget is not None:
        budget = number("budget", budget, "must be positive", above=0.0)
    pilot_seconds = number("pilot", pilot_seconds, "must be positive", above=0.0)
    _require_steady(scene)
    able, refused = candidates(scene, observable, accuracy)
    if not able:
        rule = f"no engine runs this scene: {'; '.join(refused.values())}"
        raise SceneError("engine", ", ".join(refused), rule)
    speeds = []
    for one in able:
        announce(f"timing the {one.engine.title} engine")
        speeds.append(speed_of(scene, one.engine, observable))
    pilots = _run_pilots(scene, observable, list(zip(able, speeds, strict=True)), pilot_seconds, announce)
    biases = {one.engine: one.bias for one in able}
    measured = [one for one in pilots if 0.0 < one.accuracy < math.inf]
    faithful = [one for one in measured if biases[one.engine] < accuracy] or measured
    if not faithful:
        rule = f"{pilots[0].rule or 'does not change in the pilot run'}; allow longer pilots"
        raise SceneError("observable", observable, rule)
    longest = max(faithful, key=lambda one: one.measured)

    def limits(engine: Engine, speed: float) -> tuple[float, float]:
        affordable = math.inf if budget is None else budget / speed
        return _least(scene, engine, observable, longest), min(
            affordable, _longest(observable, longest), span(scene, observable)[1]
        )

    options = [
        _option(one, speed, _bias(one, measured), longest, accuracy, limits(one.engine, speed))
        for one, speed in zip(able, speeds, strict=True)
    ]
    options.sort(key=lambda one: (max(one.half_width, accuracy * (1.0 + 1e-9)), one.seconds))
    reached = options[0].half_width <= accuracy * (1.0 + 1e-6)
    return Plan(scene, observable, accuracy, tuple(options), refused, longest.value, tuple(pilots), reached)


def _require_steady(scene: Scene) -> None:
    """Refuse an empty scene, and one that cools or heats: its observables depend on the time."""
    if not scene.count:
        raise SceneError("count", 0, "advice is for a gas: the scene is empty")
    law = scene.restitution
    if law is not None and law.dissipative and not is_driven(scene):
        rule = "loses energy that nothing returns: there is no steady state to measure; give a duration"
        raise SceneError("restitution.normal", law.normal, rule)
    heats = scene.thermostat is not None or any(
        isinstance(face, Vibrating | LeesEdwards) for face in scene.faces.values()
    )
    if heats and not (law is not None and law.dissipative) and not at_temperature(scene):
        rule = "nothing takes the energy that the scene is given: there is no steady state; give a duration"
        raise SceneError("restitution", None, rule)


def _run_pilots(
    scene: Scene,
    observable: str,
    timed: list[tuple[Candidate, float]],
    seconds: float,
    announce: Announce,
) -> list[Pilot]:
    """A pilot of the first engine, and of the cheapest one if that is much cheaper."""
    chosen = timed[:1]
    cheapest = min(timed, key=lambda one: one[1])
    if cheapest[1] * _WORTH < timed[0][1]:
        chosen.append(cheapest)
    pilots = []
    for one, speed in chosen:
        announce(f"a pilot run, {one.engine.title} engine, {seconds / len(chosen):.2g} s")
        pilots.append(run_pilot(scene, one.engine, observable, seconds / len(chosen), speed))
    return pilots


def _bias(candidate: Candidate, measured: list[Pilot]) -> float:
    """The bound on a candidate's bias: that of theory, or what its pilot differs by from the exact
    engine's."""
    own = [one for one in measured if one.engine == candidate.engine]
    exact = [one for one in measured if one.engine.name == "event"]
    if candidate.engine.name == "event" or not own or not exact:
        return candidate.bias
    difference = abs(own[0].value / exact[0].value - 1.0)
    error = math.hypot(own[0].accuracy, exact[0].accuracy)
    if difference <= candidate.bias + _DIFFERS * error:
        return candidate.bias
    return difference + QUANTILE * error


def _option(
    candidate: Candidate,
    speed: float,
    bias: float,
    pilot: Pilot,
    accuracy: float,
    limits: tuple[float, float] = (0.0, math.inf),
) -> Option:
    """What a candidate needs for an accuracy, with the noise of a pilot, or reaches within limits of the
    duration."""
    least, most = ((1.0 - EQUILIBRATION) * limit for limit in limits)
    measured = min(max(pilot.length((accuracy - bias) / QUANTILE), least), most)
    if not math.isfinite(measured):
        return Option(candidate, speed, bias, math.inf, math.inf, math.inf)
    duration = measured / (1.0 - EQUILIBRATION)
    half_width = bias + QUANTILE * pilot.reaches(measured)
    return Option(candidate, speed, bias, duration, duration * speed, half_width)


def _longest(observable: str, pilot: Pilot) -> float:
    """The longest duration that is of use: what is of positions is of a number of frames, and those of the
    pilot say how much each of them contributes; more time between them is not known to help."""
    if observable not in STRUCTURE:
        return math.inf
    frames = pilot.measured / pilot.interval
    return pilot.measured * _FRAMES / (frames / math.ceil(frames / MOST_FRAMES))


def _least(scene: Scene, engine: Engine, observable: str, pilot: Pilot) -> float:
    """The shortest duration: what the table equilibrates and measures at least, crossings of a container with
    walls, the time in which the pilot came to its steady state, and the steps between frames; with
    correlations the frames that give an error."""
    frequency = rates(scene, dense=True).frequency
    collisions = (EQUILIBRATED + LEAST) / frequency if frequency > 0.0 else 0.0
    crossings = 0.0 if all(scene.container.periodic) else _CROSSINGS * crossing(scene)
    settled = _SETTLED * pilot.settled / EQUILIBRATION
    if observable in CORRELATED:
        sampled = schedule(scene, engine, observable, 0.0)[0]
    else:
        sampled = _FRAMES * (engine.resolved(scene).quantum or 0.0)
    return max(collisions, crossings, settled, sampled)
