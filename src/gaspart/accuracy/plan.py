"""The cheapest engine and run for an accuracy of any observable of any steady scene, from pilot runs.

A run of a measured time t is off by at most |bias| + 1.96 sqrt(noise / t) in 95 % of all runs, relatively.
The noise and the processor time of a unit of time come from pilots; the bias is bounded by theory
(`gaspart.accuracy.candidates`), and raised where two engines' pilots differ by more.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from gaspart.accuracy import PILOT_SECONDS
from gaspart.accuracy.advice import ACCURACIES
from gaspart.accuracy.candidates import Candidate
from gaspart.accuracy.pilot import Pilot
from gaspart.accuracy.scatter import Scatter, start_scatter
from gaspart.accuracy.steady import require_steady
from gaspart.accuracy.table import EQUILIBRATION as EQUILIBRATED
from gaspart.accuracy.table import LEAST, QUANTILE
from gaspart.accuracy.target import Target, tidy
from gaspart.accuracy.trials import Announce, Trials
from gaspart.analysis.pairs import MOST_FRAMES
from gaspart.analysis.run import EQUILIBRATION
from gaspart.engines import Engine
from gaspart.keys.values import number
from gaspart.scene.scene import Scene
from gaspart.trajectory.recipe import Recipe
from gaspart.trajectory.until import Requirement, Until

_FRAMES = 384
"""Of a run: 288 independent intervals give an error 17 degrees of freedom, and 15 are required."""
_LONGEST = 4.0
"""The longest duration of a run with `--until` over the predicted one: two examinations, and an error that
chance made too small in the pilot."""
_SETTLED = 2.0
"""The part of a run that is not measured, over the time in which the energy came to its mean in the pilot."""
_CROSSINGS = 10.0
"""How often a particle crosses a container with walls at least in a run."""


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
    accuracy within the budget; differing: pilots that differ from that of the exact engine by more than their
    bounds; places: of a curve, how many the pilots know, of which the accuracy is, and how many there are."""

    target: Target
    accuracy: float
    options: tuple[Option, ...]
    refused: dict[str, str]
    value: float
    pilots: tuple[Pilot, ...]
    affordable: bool
    differing: tuple[Pilot, ...] = ()
    places: tuple[int, int] = (1, 1)

    @property
    def best(self) -> Option:
        """The option to take."""
        return self.options[0]

    @property
    def scatter(self) -> Scatter:
        """Of the observable from run to run by that of the energy at the start, beyond the interval."""
        return start_scatter(self.target)

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
            asked = Requirement(target.observable, relative, face=target.face)
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
    advised. pilot_seconds: of the two pilots that most scenes have, or of the only one; up to half of it goes
    to what comes before them, if that takes more than 5 s, as to compress particles. More is needed where a
    third engine turns out to be the best, and by a pilot in a transient, which is continued.
    announce(text): is called before each pilot.

    Raises SceneError for a scene without a steady state, and for an observable that it does not have, or of
    which the pilots are too short to say anything.
    """
    low, high = ACCURACIES
    target = Target.named(scene, observable)
    accuracy = number("accuracy", accuracy, f"must be from {low:g} to {high:g}", least=low, most=high)
    if budget is not None:
        budget = number("budget", budget, "must be positive", above=0.0)
    pilot_seconds = number("pilot", pilot_seconds, "must be positive", above=0.0)
    require_steady(scene)
    trials = Trials(target, accuracy, pilot_seconds, announce)
    trials.begin()
    options = _options(trials, budget)
    while not trials.has_pilot(options[0].candidate.engine):  # none is advised without one
        best = options[0].candidate
        found = trials.make(best)
        if not found.measured:
            trials.refuse(best, found.rule)
        options = _options(trials, budget)
    reached = options[0].half_width <= accuracy * (1.0 + 1e-6)
    pilots = tuple(trials.pilots)
    reference = trials.reference
    places = reference.component.places if reference.component else (1, 1)
    shown = trials.refused, reference.value, pilots, reached, trials.differing, places
    return Plan(target, accuracy, tuple(options), *shown)


def _options(trials: Trials, budget: float | None) -> list[Option]:
    """What each candidate needs, the best first. Raises SceneError if no pilot has measured the
    observable."""
    target, accuracy, longest = trials.target, trials.accuracy, trials.reference
    options = []
    for one, speed in trials.speeds.items():
        affordable = math.inf if budget is None else budget / speed
        most = min(affordable, _longest(target, longest), target.span[1])
        limits = _least(target, one.engine, longest), most
        options.append(_option(one, speed, trials.bias(one), longest, accuracy, limits))
    return sorted(options, key=lambda one: (max(one.half_width, accuracy * (1.0 + 1e-9)), one.seconds))


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
