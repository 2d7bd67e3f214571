"""The cheapest engine and run for an accuracy of any observable of any steady scene.

Scenes in the table need no run (`plan_from_table`). For all other scenes pilot runs give the noise and the
CPU time of a unit of time (`plan_from_pilots`). Both functions return an `Option` for each engine, and the
plan uses the best option.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from gaspart import theory
from gaspart.accuracy import PILOT_SECONDS
from gaspart.accuracy import tabulated as known
from gaspart.accuracy.conditions import require_steady
from gaspart.accuracy.option import Option, replicas_of, sort_by_cost, suitable_engines
from gaspart.accuracy.pilot import Announce, Pilot, Trials
from gaspart.accuracy.scatter import Scatter, start_scatter
from gaspart.accuracy.table import EQUILIBRATION as EQUILIBRATED
from gaspart.accuracy.table import LEAST
from gaspart.accuracy.target import Target, rounded_to_12_digits
from gaspart.analysis import bulk
from gaspart.analysis.pairs import MOST_FRAMES
from gaspart.analysis.run import EQUILIBRATION
from gaspart.engines import Engine
from gaspart.keys.values import number
from gaspart.scene.gas import Gas
from gaspart.scene.scene import Scene
from gaspart.trajectory.recipe import MOST_REPLICAS, Recipe
from gaspart.trajectory.replicas import differ
from gaspart.trajectory.until import Requirement, Until

ACCURACIES = 1e-8, 1.0
"""The best relative accuracy that float64 sums and the table support, and the worst."""
_FRAMES = 384
"""Number of frames of a run: 288 independent intervals give an error 17 degrees of freedom, of 15 required.
"""
_LONGEST = 4.0
"""The longest duration of a run with `--until` over the predicted one: two examinations, and an error that
chance made too small in the pilot."""
_SETTLED = 2.0
"""The part of a run that is not measured, over the time in which the energy came to its mean in the pilot."""
_CROSSINGS = 10.0
"""Minimum number of times that a particle crosses a container with walls in a run."""
_OF_STARTS = 0.5
"""Scatter of the mean of replicas by their starts, divided by the accuracy, beyond which one run is made."""
_BULK = 4.0  # the finite size of a gas should cost no more than this part of the accuracy


@dataclass(frozen=True)
class Plan:
    """Advice for a scene.

    options : option of each engine, the best first.
    refused : reasons why other engines cannot run the scene, by their names in the table.
    value : value of the observable, by the pilots or by theory.
    replicas : number of runs that share the measured time.
    pilots : their results, none if the table has the answer.
    differing : pilots that differ from the pilot of the exact engine by more than their bounds.
    points : for a curve, the number of points that the pilots measured, to which the accuracy refers, and the
        number of all points.
    budget : CPU time of the run in s, if it is limited.
    """

    target: Target
    accuracy: float
    options: tuple[Option, ...]
    refused: dict[str, str]
    value: float
    replicas: int = 1
    pilots: tuple[Pilot, ...] = ()
    differing: tuple[Pilot, ...] = ()
    points: tuple[int, int] = (1, 1)
    budget: float | None = None

    @property
    def best(self) -> Option:
        """The option to take."""
        return self.options[0]

    @property
    def affordable(self) -> bool:
        """True if the best option reaches the accuracy within the budget."""
        return self.best.error <= self.accuracy * (1.0 + 1e-6)

    @property
    def scatter(self) -> Scatter:
        """Scatter of the observable from run to run by the initial energy, beyond the interval."""
        return start_scatter(self.target)

    @property
    def gas(self) -> Gas | None:
        """Fluid in a periodic container that the table describes; None for a plan by pilots."""
        return None if self.pilots else known.fluid_of(self.target.scene)

    @property
    def finite_size(self) -> tuple[float, float]:
        """Relative difference from an infinite gas, to first order, and a sufficient number of particles.

        For this number the difference is a quarter of the accuracy.
        """
        gas = known.fluid_of(self.target.scene)
        differing, power = getattr(bulk, f"finite_{self.target.declared.bulk}")(gas)
        return differing, gas.count * (abs(differing) * _BULK / self.accuracy) ** power

    @property
    def duration(self) -> float:
        """Duration of each run, with its discarded part."""
        return self.best.whole(self.best.measured / self.replicas)

    @property
    def runs(self) -> int:
        """Number of runs like the best option whose mean is accurate, if one run is not."""
        best = self.best
        noise, remaining = best.error - best.bias, self.accuracy - best.bias
        return math.ceil((noise / remaining) ** 2) if remaining > 0.0 and math.isfinite(noise) else 0

    @property
    def seconds(self) -> float:
        """CPU time of all replicas, with their discarded parts; inf if out of reach."""
        return self.replicas * self.duration * self.best.speed

    @property
    def collisions_per_particle(self) -> float:
        """Measured in each run, by the rate of theory."""
        gas = self.gas
        rate = float(theory.collision_rate(**gas.parameters)) if gas else self.target.frequency
        return self.best.measured / self.replicas * rate

    @property
    def longest_interval(self) -> float:
        """Maximum time between frames.

        For diffusion the interval follows from the lags. For an observable that frames sample, it is the
        interval of the pilot, whose noise is known.
        """
        declared = self.target.declared
        if declared.samples == "paths":
            return self.target.span[0]
        sampled = declared.form == "curve" and declared.samples != "structure"
        return min(pilot.interval for pilot in self.pilots) if sampled else math.inf

    @property
    def recipe(self) -> Recipe:
        """Recipe of the run to make, one of the replicas.

        The duration is fixed if the noise is in the table, or if the observable cannot end a run. Otherwise
        the run ends when it is accurate.
        """
        target, duration = self.target, self.duration
        scene, engine, correlations = target.scene, self.best.engine, None
        interval = float(f"{min(duration / _FRAMES, self.longest_interval):.3g}")
        if target.correlated:
            duration, interval, correlations = target.schedule(engine, duration)
        elif quantum := engine.for_scene(scene).quantum:
            engine = engine.for_scene(scene)
            interval = max(1, round(interval / quantum)) * quantum
        until = (
            self._until(duration) if self.pilots and target.declared.ends_runs and self.affordable else None
        )
        intervals = max(1, math.ceil(duration / interval - 1e-6))
        fixed = None if until else rounded_to_12_digits(intervals * interval)
        return Recipe(
            scene, engine, 1, fixed, interval, until=until, correlations=correlations,
            **target.contents(engine),
        )  # fmt: skip

    def _until(self, duration: float) -> Until:
        """Return the condition that ends a run of about a duration."""
        target = self.target
        remaining = self.accuracy - self.best.bias
        relative = float(f"{0.99 * remaining if self.best.bias else remaining:.3g}")
        longest = max(_LONGEST * duration, *(pilot.duration for pilot in self.pilots))
        longest = min(longest, target.span[1])
        requirement = Requirement(target.observable, relative, face=target.face)
        return Until((requirement,), at_most=float(f"{longest:.2g}"))


def plan(
    scene: Scene,
    observable: str,
    accuracy: float,
    budget: float | None = None,
    pilot_seconds: float = PILOT_SECONDS,
    announce: Announce = lambda text: None,
) -> Plan:
    """Find the cheapest run for a relative accuracy of an observable of `gaspart measure`.

    The observable may be the pressure on one wall, like `pressure:x low`.

    accuracy : standard error plus the bound on systematic errors, divided by the value; without these bounds
        this is the accuracy that `--until` requires.
    budget : CPU time of the run in seconds; if it does not suffice, the most accurate run within it is
        advised.
    pilot_seconds : for scenes and observables that the table does not cover, total CPU time of the pilots.
        Most scenes need two pilots. Up to half of this time is spent on the preparation if the preparation
        takes more than 5 s, for example to compress particles. More is needed where a third engine turns out
        to be the best, and by a pilot in a transient, which is continued.
    announce : function of a text, called before each pilot.

    Raises SceneError for a scene without a steady state, for an observable that is not defined in the scene,
    and for an observable for which the pilots are too short.
    """
    if known.is_tabulated(scene, observable):
        return plan_from_table(scene, observable, accuracy, budget)
    return plan_from_pilots(scene, observable, accuracy, budget, pilot_seconds, announce)


def plan_from_table(
    scene: Scene,
    observable: str,
    accuracy: float,
    budget: float | None = None,
) -> Plan:
    """Make a `plan` by the table; its times are for the machine of the table.

    Raises SceneError for anything that the table does not cover.
    """
    gas, target = known.tabulated_target(scene, observable)
    accuracy, budget = _check_arguments(accuracy, budget)
    engines, refused = suitable_engines(target)
    options = known.options_of(target, engines, accuracy, budget)
    able = {option.engine.timed_as for option in options}
    missing = (engine.timed_as for engine in engines if engine.timed_as not in able)
    refused |= dict.fromkeys(missing, "no setting is known to be as accurate at this density")
    replicas = replicas_of(options[0], target.span[1])
    value = known.value_of(gas, observable)
    return Plan(target, accuracy, tuple(options), refused, value, replicas, budget=budget)


def plan_from_pilots(
    scene: Scene,
    observable: str,
    accuracy: float,
    budget: float | None = None,
    pilot_seconds: float = PILOT_SECONDS,
    announce: Announce = lambda text: None,
) -> Plan:
    """Make a `plan` by pilot runs, even if the table covers the scene."""
    target = Target.from_name(scene, observable)
    accuracy, budget = _check_arguments(accuracy, budget)
    pilot_seconds = number("pilot", pilot_seconds, "must be positive", above=0.0)
    require_steady(scene)
    trials = Trials(target, accuracy, pilot_seconds, announce)
    trials.begin()
    options = _options(trials, budget)
    while not trials.has_pilot(options[0].engine):  # none is advised without one
        best = options[0].candidate
        pilot = trials.make(best)
        if not pilot.measured:
            trials.refuse(best, pilot.rule)
        options = _options(trials, budget)
    reference = trials.reference
    points = reference.component.points if reference.component else (1, 1)
    pilot_results = tuple(trials.pilots), trials.differing, points
    advice = Plan(
        target, accuracy, tuple(options), trials.refused, reference.value, 1, *pilot_results, budget
    )
    if not advice.affordable or not _can_share(target, advice.best.engine):
        return advice
    replicas = replicas_of(advice.best, target.span[1])
    of_starts = advice.scatter.value / math.sqrt(replicas)
    if advice.best.duration <= target.span[1] and of_starts > _OF_STARTS * accuracy:
        return advice  # one run has no scatter of starts
    return replace(advice, replicas=replicas)


def _check_arguments(accuracy: float, budget: float | None) -> tuple[float, float | None]:
    """Return the arguments if they are valid; raise SceneError otherwise."""
    low, high = ACCURACIES
    accuracy = number("accuracy", accuracy, f"must be from {low:g} to {high:g}", least=low, most=high)
    return accuracy, None if budget is None else number("budget", budget, "must be positive", above=0.0)


def _options(trials: Trials, budget: float | None) -> list[Option]:
    """Return an option for each candidate, the best first.

    Raises SceneError if no pilot has measured the observable.
    """
    target, longest = trials.target, trials.reference
    assert longest.component is not None
    options = []
    for candidate, cost in trials.speeds.items():
        affordable = math.inf if budget is None else budget / cost
        shared = MOST_REPLICAS if _can_share(target, candidate.engine) else 1
        most = min(affordable, _longest(target, longest), shared * target.span[1])
        limits = _least(target, candidate.engine, longest), most
        bias = trials.bias(candidate)
        noise = trials.noise(candidate.engine)
        options.append(Option(candidate, bias, noise, cost, trials.accuracy, *limits))
    return sort_by_cost(options)


def _can_share(target: Target, engine: Engine) -> bool:
    """Return True if replicas can share the measured time.

    These are runs that end when they are accurate and differ by their seeds. For other runs, the error would
    be the scatter of a few runs.
    """
    return target.declared.ends_runs and differ(target.scene, engine)


def _longest(target: Target, pilot: Pilot) -> float:
    """Return the longest duration that is of use.

    For an observable of positions the number of frames is limited. The frames of the pilot show how much each
    frame contributes; a longer time between frames is not known to improve this.
    """
    if target.declared.samples != "structure":
        return math.inf
    frames = pilot.measured / pilot.interval
    return pilot.measured * _FRAMES / (frames / math.ceil(frames / MOST_FRAMES))


def _least(target: Target, engine: Engine, pilot: Pilot) -> float:
    """Return the shortest duration of a run.

    The time covers the least equilibration and measurement of the table, crossings of a container with walls,
    the time in which the pilot became steady, and the steps between frames. With correlations it also covers
    the frames that are needed for an error.
    """
    scene, frequency = target.scene, target.frequency
    collisions = (EQUILIBRATED + LEAST) / frequency if frequency > 0.0 else 0.0
    crossings = 0.0 if scene.is_periodic else _CROSSINGS * target.crossing
    settled = _SETTLED * pilot.settled / EQUILIBRATION
    if target.correlated:
        sampled = target.schedule(engine, 0.0)[0]
    else:
        sampled = _FRAMES * (engine.for_scene(scene).quantum or 0.0)
    return max(collisions, crossings, settled, sampled)
