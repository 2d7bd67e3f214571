"""The cheapest engine and run for a requested accuracy, for any observable of a steady scene.

For scenes in the table no run is needed (`plan_from_table`). For all other scenes pilot runs measure the
noise and the CPU time per unit of simulated time (`plan_from_pilots`). Both functions compute an `Option` for
each engine, and the plan takes the best option.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from gaspart import theory
from gaspart.accuracy import PILOT_SECONDS
from gaspart.accuracy import tabulated as known
from gaspart.accuracy.advisers import timed_as
from gaspart.accuracy.conditions import require_steady
from gaspart.accuracy.option import Option, replicas_of, sort_by_cost, suitable_engines
from gaspart.accuracy.pilot import Announce, Pilot, Trials
from gaspart.accuracy.scatter import Scatter, start_scatter
from gaspart.accuracy.table import EQUILIBRATION as EQUILIBRATED
from gaspart.accuracy.table import LEAST
from gaspart.accuracy.target import Target, rounded_to_12_digits
from gaspart.analysis.pairs import MOST_FRAMES
from gaspart.analysis.run import EQUILIBRATION
from gaspart.engines import Engine
from gaspart.keys.values import number
from gaspart.scene.facts import Gas
from gaspart.scene.scene import Scene
from gaspart.theory import bulk
from gaspart.trajectory.recipe import MOST_REPLICAS, Recipe
from gaspart.trajectory.replicas import differ
from gaspart.trajectory.run_options import Requirement, Until

ACCURACIES = 1e-8, 1.0
"""Smallest and largest allowed relative accuracy; the smallest is the limit of float64 sums and of the table.
"""
_FRAMES = 384
"""Number of frames of a run: 288 independent intervals give an error with 17 degrees of freedom, and 15 are
required.
"""
_LONGEST = 4.0
"""Maximum duration of a run with `--until`, divided by the predicted duration. It allows for two
examinations, and for a pilot whose error was too small by chance.
"""
_SETTLED = 2.0
"""Discarded time of a run divided by the time in which the energy of the pilot reached its mean."""
_CROSSINGS = 10.0
"""Minimum number of times that a particle crosses a container with walls during a run."""
_OF_STARTS = 0.5
"""Scatter of the mean of replicas due to their starts, divided by the accuracy, above which a single run is
used.
"""
_BULK = 4.0  # largest finite-size error of a gas, as a fraction of the accuracy


@dataclass(frozen=True)
class Plan:
    """Recommended run for a scene, and the alternatives.

    options : one option per engine, the best first.
    refused : reason for each engine that cannot run the scene, by the engine's name in the table.
    value : value of the observable, from the pilots or from theory.
    replicas : number of replicas among which the measured time is divided.
    pilots : pilot runs, empty if the table contains the answer.
    differing : pilots that differ from the exact engine's pilot by more than the bounds on their biases.
    points : for a curve, the number of points that the pilots measured and the number of all points. The
        accuracy refers to the measured points.
    budget : limit of the CPU time of the run in s, if there is a limit.
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
        """Recommended option."""
        return self.options[0]

    @property
    def affordable(self) -> bool:
        """True if the best option reaches the accuracy within the budget."""
        return self.best.error <= self.accuracy * (1.0 + 1e-6)

    @property
    def scatter(self) -> Scatter:
        """Scatter of the observable between runs due to the initial energy, not part of the interval."""
        return start_scatter(self.target)

    @property
    def gas(self) -> Gas | None:
        """Fluid in a periodic container that the table covers; None for a plan from pilots."""
        return None if self.pilots else known.fluid_of(self.target.scene)

    @property
    def finite_size(self) -> tuple[float, float]:
        """Relative difference from an infinite gas, and the number of particles that makes it a quarter of
        the accuracy.
        """
        gas = known.fluid_of(self.target.scene)
        differing, power = getattr(bulk, f"finite_{self.target.declared.bulk}")(gas)
        return differing, gas.count * (abs(differing) * _BULK / self.accuracy) ** power

    @property
    def duration(self) -> float:
        """Duration of each run, including its discarded part."""
        return self.best.whole(self.best.measured / self.replicas)

    @property
    def runs(self) -> int:
        """Number of runs with the best option whose mean is accurate, if one run is not."""
        best = self.best
        noise, remaining = best.error - best.bias, self.accuracy - best.bias
        return math.ceil((noise / remaining) ** 2) if remaining > 0.0 and math.isfinite(noise) else 0

    @property
    def seconds(self) -> float:
        """CPU time of all replicas, including their discarded parts; inf if out of reach."""
        return self.replicas * self.duration * self.best.speed

    @property
    def collisions_per_particle(self) -> float:
        """Collisions per particle during the measured part of each run, from theory."""
        gas = self.gas
        rate = float(theory.collision_rate(**gas.parameters)) if gas else self.target.frequency
        return self.best.measured / self.replicas * rate

    @property
    def longest_interval(self) -> float:
        """Maximum time between frames. For a diffusion coefficient the interval follows from the lags. For an
        observable that is sampled at frames, the interval is the interval of the pilot, whose noise was
        measured.
        """
        declared = self.target.declared
        if declared.samples == "paths":
            return self.target.span[0]
        sampled = declared.form == "curve" and declared.samples != "structure"
        return min(pilot.interval for pilot in self.pilots) if sampled else math.inf

    @property
    def recipe(self) -> Recipe:
        """Recipe of the recommended run, one for all replicas. The duration is fixed if the noise comes from
        the table, or if the observable cannot end a run. Otherwise the run ends when it is accurate.
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
        """Return the condition that ends a run of about this duration."""
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
    """Find the cheapest run that measures an observable of `gaspart measure` to a relative accuracy. The
    observable may name one wall, such as `pressure:x low`. `accuracy`: relative accuracy: the standard error
    plus the bound on systematic errors, divided by the value. A run with `--until` requires this accuracy of
    its standard error alone. `budget`: CPU time of the run in seconds. If it does not suffice, the plan is
    the most accurate run within it. `pilot_seconds`: total CPU time of the pilots, for scenes and observables
    that the table does not cover. Most scenes need two pilots. If the preparation takes more than 5 s, for
    example to compress particles, it may use up to half of this time. The pilots take longer if a third
    engine turns out to be the best, or if a pilot in a transient is extended. `announce`: function that is
    called with a text before each pilot. Raises SceneError if the scene has no steady state, if the
    observable is undefined in the scene, or if the pilots are too short for the observable.
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
    """Make a `plan` from the table, with its machine's CPU times; SceneError if it does not cover
    the target.
    """
    gas, target = known.tabulated_target(scene, observable)
    accuracy, budget = _check_arguments(accuracy, budget)
    engines, refused = suitable_engines(target)
    options = known.options_of(target, engines, accuracy, budget)
    able = {timed_as(option.engine) for option in options}
    missing = (timed_as(engine) for engine in engines if timed_as(engine) not in able)
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
    """Make a `plan` from pilot runs, even if the table covers the scene."""
    target = Target.from_name(scene, observable)
    accuracy, budget = _check_arguments(accuracy, budget)
    pilot_seconds = number("pilot", pilot_seconds, "must be positive", above=0.0)
    require_steady(scene)
    trials = Trials(target, accuracy, pilot_seconds, announce)
    trials.begin()
    options = _options(trials, budget)
    while not trials.has_pilot(options[0].engine):  # no option is recommended without a pilot
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
        return advice  # a single run has no scatter between starts
    return replace(advice, replicas=replicas)


def _check_arguments(accuracy: float, budget: float | None) -> tuple[float, float | None]:
    """Return the arguments if they are valid; raise SceneError otherwise."""
    low, high = ACCURACIES
    accuracy = number("accuracy", accuracy, f"must be from {low:g} to {high:g}", least=low, most=high)
    return accuracy, None if budget is None else number("budget", budget, "must be positive", above=0.0)


def _options(trials: Trials, budget: float | None) -> list[Option]:
    """Return an option for each candidate, the best first; SceneError if no pilot measured the observable."""
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
    """Return True if the measured time can be divided among replicas. This requires runs that end when they
    are accurate and that differ in their seeds.
    """
    return target.declared.ends_runs and differ(target.scene, engine)


def _longest(target: Target, pilot: Pilot) -> float:
    """Return the longest useful duration. For an observable of positions the number of frames is limited. The
    pilot shows how much each frame contributes to the accuracy. A longer time between frames may not improve
    this.
    """
    if target.declared.samples != "structure":
        return math.inf
    frames = pilot.measured / pilot.interval
    return pilot.measured * _FRAMES / (frames / math.ceil(frames / MOST_FRAMES))


def _least(target: Target, engine: Engine, pilot: Pilot) -> float:
    """Return the shortest duration of a run. This time covers the minimum equilibration and measurement of
    the table, crossings of a container with walls, the time after which the pilot was steady, and the time
    steps between frames. With correlations it also covers the number of frames that an error estimate needs.
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
