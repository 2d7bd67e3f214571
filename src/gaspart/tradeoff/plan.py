"""The cheapest engine and run for an accuracy of any observable of any steady scene, from pilot runs.

A run of a measured time t is off by at most |bias| + 1.96 sqrt(noise / t) in 95 % of all runs, relatively.
The noise and the processor time of a unit of time come from pilots; the bias is bounded by theory
(`gaspart.tradeoff.candidates`), and raised where two engines' pilots differ by more.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from gaspart.analysis.pairs import MOST_FRAMES
from gaspart.analysis.run import EQUILIBRATION
from gaspart.engines import Engine
from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.scene.validation import number
from gaspart.tradeoff import PILOT_SECONDS
from gaspart.tradeoff.accuracy import Accuracy
from gaspart.tradeoff.advice import ACCURACIES
from gaspart.tradeoff.candidates import Candidate, candidates
from gaspart.tradeoff.pilot import Pilot, require_defined, run_pilot, speed_of
from gaspart.tradeoff.steady import require_steady, temperature_scatter
from gaspart.tradeoff.table import EQUILIBRATION as EQUILIBRATED
from gaspart.tradeoff.table import LEAST, QUANTILE
from gaspart.tradeoff.target import Target, tidy
from gaspart.trajectory.recipe import Recipe
from gaspart.trajectory.until import Until

_WORTH = 3.0
"""How many times as cheap as the first engine one must be to have a pilot of its own."""
_DIFFERS = 2.5
"""Standard errors by which two pilots differ if one is biased more than theory says."""
_FRAMES = 384
"""Of a run: 288 independent intervals give an error 17 degrees of freedom, and 15 are required."""
_PREPARED = 5.0
"""Processor seconds until pilots begin that are not taken from theirs."""
_LONGEST = 4.0
"""The longest duration of a run with `--until` over the predicted one: two examinations, and an error that
chance made too small in the pilot."""
_SETTLED = 2.0
"""The part of a run that is not measured, over the time in which the energy came to its mean in the pilot."""
_CROSSINGS = 10.0
"""How often a particle crosses a container with walls at least in a run."""
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

    target: Target
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
        return self.target.declared.power * temperature_scatter(self.target.scene)

    @property
    def longest_interval(self) -> float:
        """Between frames: of diffusion by its lags; of an observable that they sample that of the pilot,
        whose noise is known."""
        declared = self.target.declared
        if declared.samples == "paths":
            return self.target.span[0]
        sampled = declared.form == "curve" and declared.samples != "structure"
        return min(one.interval for one in self.pilots) if sampled else math.inf

    @property
    def recipe(self) -> Recipe:
        """The run to make: until it is accurate where that can be asked, else of a fixed duration."""
        best, target = self.best, self.target
        scene, engine, correlations = target.scene, best.candidate.engine, None
        duration, interval = best.duration, min(best.duration / _FRAMES, self.longest_interval)
        interval = float(f"{interval:.3g}")
        if target.correlated:
            duration, interval, correlations = target.schedule(engine, duration)
        elif quantum := engine.resolved(scene).quantum:
            engine = engine.resolved(scene)
            interval = max(1, round(interval / quantum)) * quantum
        until = None
        if target.declared.ends_runs and self.affordable:
            relative = float(f"{0.99 * (self.accuracy - best.bias) / QUANTILE:.3g}")
            longest = max(_LONGEST * duration, *(one.duration for one in self.pilots))
            longest = min(longest, target.span[1])
            asked = Accuracy(target.observable, relative, face=target.face)
            until = Until((asked,), at_most=float(f"{longest:.2g}"))
        fixed = None if until else tidy(max(1, round(duration / interval)) * interval)
        return Recipe(
            scene, engine, 1, fixed, interval,
            displacements=target.needs_paths, correlations=correlations, until=until,
            pairs=target.declared.needs == "pairs",
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
    measure`; of the pressure on one wall as `pressure:x low`.

    budget: processor time in seconds of the run; if it does not suffice, the most accurate run within it is
    advised. pilot_seconds: of all pilots together; up to half of it goes to what comes before them, if that
    takes more than 5 s, as to compress particles.
    announce(text): is called before each pilot.

    Raises SceneError for a scene without a steady state, and for an observable that it does not have, or of
    which the pilots are too short to say anything.
    """
    low, high = ACCURACIES
    target, begun = Target.named(scene, observable), time.process_time()
    accuracy = number("accuracy", accuracy, f"must be from {low:g} to {high:g}", least=low, most=high)
    if budget is not None:
        budget = number("budget", budget, "must be positive", above=0.0)
    pilot_seconds = number("pilot", pilot_seconds, "must be positive", above=0.0)
    require_steady(scene)
    timed, refused = _timed(target, accuracy, announce)
    spent = time.process_time() - begun
    left = min(1.0, max(0.5, 1.0 - (spent - _PREPARED) / pilot_seconds))
    pilots = _run_pilots(target, timed, pilot_seconds, left, announce)
    biases = {one.engine: one.bias for one, _ in timed}
    measured = [one for one in pilots if 0.0 < one.accuracy < math.inf]
    faithful = [one for one in measured if biases[one.engine] < accuracy] or measured
    if not faithful:
        rule = f"{pilots[0].rule or 'does not change in the pilot run'}; allow longer pilots"
        if target.observable == "pressure" and not target.face:
            rule += f", or state a wall, as in pressure:{scene.container.walls[0]}"
        raise SceneError("observable", observable, rule)
    longest = max(faithful, key=lambda one: one.measured)

    def limits(engine: Engine, speed: float) -> tuple[float, float]:
        affordable = math.inf if budget is None else budget / speed
        most = min(affordable, _longest(target, longest), target.span[1])
        return _least(target, engine, longest), most

    options = [
        _option(one, speed, _bias(one, measured), longest, accuracy, limits(one.engine, speed))
        for one, speed in timed
    ]
    options.sort(key=lambda one: (max(one.half_width, accuracy * (1.0 + 1e-9)), one.seconds))
    reached = options[0].half_width <= accuracy * (1.0 + 1e-6)
    return Plan(target, accuracy, tuple(options), refused, longest.value, tuple(pilots), reached)


def _timed(
    target: Target, accuracy: float, announce: Announce
) -> tuple[list[tuple[Candidate, float]], dict[str, str]]:
    """The candidates with their processor times of a unit of time, and why other engines are none. Raises
    SceneError if there is none, and for an observable that the scene does not have."""
    able, refused = candidates(target, accuracy)
    if able:
        require_defined(target)
    timed = []
    for one in able:
        announce(f"timing the {one.engine.title} engine")
        try:
            timed.append((one, speed_of(target, one.engine)))
        except SceneError as error:  # as of particles from which the engine cannot start
            refused[one.name] = f"{error.key}: {error.rule}"
    if not timed:
        rule = f"no engine runs this scene: {'; '.join(refused.values())}"
        raise SceneError("engine", ", ".join(refused), rule)
    return timed, refused


def _run_pilots(
    target: Target, timed: list[tuple[Candidate, float]], seconds: float, left: float, announce: Announce
) -> list[Pilot]:
    """A pilot of the first engine, and of the cheapest one if that is much cheaper; left: see `run_pilot`."""
    chosen = timed[:1]
    cheapest = min(timed, key=lambda one: one[1])
    if cheapest[1] * _WORTH < timed[0][1]:
        chosen.append(cheapest)
    pilots = []
    for one, speed in chosen:
        announce(f"a pilot run, {one.engine.title} engine, {left * seconds / len(chosen):.2g} s")
        pilots.append(run_pilot(target, one.engine, seconds / len(chosen), speed, left))
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


def _longest(target: Target, pilot: Pilot) -> float:
    """The longest duration that is of use: what is of positions is of a number of frames, and those of the
    pilot say how much each of them contributes; more time between them is not known to help."""
    if target.declared.samples != "structure":
        return math.inf
    frames = pilot.measured / pilot.interval
    return pilot.measured * _FRAMES / (frames / math.ceil(frames / MOST_FRAMES))


def _least(target: Target, engine: Engine, pilot: Pilot) -> float:
    """The shortest duration: what the table equilibrates and measures at least, crossings of a container with
    walls, the time in which the pilot came to its steady state, and the steps between frames; with
    correlations the frames that give an error."""
    scene, frequency = target.scene, target.frequency
    collisions = (EQUILIBRATED + LEAST) / frequency if frequency > 0.0 else 0.0
    crossings = 0.0 if all(scene.container.periodic) else _CROSSINGS * target.crossing
    settled = _SETTLED * pilot.settled / EQUILIBRATION
    if target.correlated:
        sampled = target.schedule(engine, 0.0)[0]
    else:
        sampled = _FRAMES * (engine.resolved(scene).quantum or 0.0)
    return max(collisions, crossings, settled, sampled)
