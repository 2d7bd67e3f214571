"""Short run of a scene that predicts the cost and the noise of a longer run.

Pilots are stored in the folder `pilots` of the cache, and reused for an identical request.
"""

from __future__ import annotations

import hashlib
import json
import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from gaspart.accuracy.advisers import timed_as
from gaspart.accuracy.conditions import measured_conditions
from gaspart.accuracy.estimates import Component, components, of_face
from gaspart.accuracy.of_engine import Candidate
from gaspart.accuracy.option import candidates, suitable_engines
from gaspart.accuracy.target import SEED, Target
from gaspart.analysis.observables import KEPT, TOO_SHORT
from gaspart.analysis.run import EQUILIBRATION, open_run
from gaspart.engines import Engine, engine_to_dict, reference_engine
from gaspart.errors import SceneError, SimulationError
from gaspart.interruption import scratch_folder
from gaspart.kernels.compile.cache import cache_directory
from gaspart.kernels.compile.sources import source_digest
from gaspart.simulation import Simulation
from gaspart.state.given import state_at_time_zero
from gaspart.theory.conditions import Conditions
from gaspart.trajectory.export import last_state
from gaspart.trajectory.reading import open_trajectory
from gaspart.trajectory.recipe import Recipe
from gaspart.trajectory.run import WriteOptions, extend, record
from gaspart.trajectory.run_options import tallies_to_json

if TYPE_CHECKING:
    from pathlib import Path

    import xarray as xr

    from gaspart.trajectory.correlator import Correlations


_PROBE = 0.15
"""Minimum CPU time of a speed measurement in seconds."""
_TIMED = 4
"""Duration of a timed run with correlations, in units of the longest lag."""
_BRIEF, _TRIED = 1e-3, 24
"""Length, in crossings of the container, and number of frames of a run that only tests if an observable is
defined.
"""
_UNKNOWN_YET = *TOO_SHORT, "particles at rest", "sample_interval"
"""Keys of the error messages that may not occur in a longer run."""
_SAME = 1e-6
"""Relative change of the kinetic energy that is attributed to rounding."""
_USUAL, _RANGE = 2.0, 5.0
"""Deviations from the steady mean, in standard deviations: limit for a start that is already steady, and
limit that a steady run does not exceed.
"""
_CONTINUED = 2
"""Maximum number of times that a pilot in a transient is doubled in length."""


@dataclass(frozen=True)
class Pilot:
    """Results of a short run with one engine.

    speed : CPU seconds per unit of time.
    seconds : CPU time of the pilot, 0 if it was already stored.
    components : components of the observable by name; empty if the observable could not be measured, with the
        reason in `rule`.
    counted : the least accurate component measured without the stored impulses; None if the run stores no
        impulses.
    interval : time between frames.
    settled : time after which the run is steady (`settling_time`).
    path : trajectory file, None for a run that failed.
    """

    engine: Engine
    speed: float
    seconds: float = 0.0
    components: dict[str, Component] = field(default_factory=dict)
    counted: Component | None = None
    interval: float = math.inf
    settled: float = 0.0
    rule: str = ""
    path: Path | None = None

    @property
    def component(self) -> Component | None:
        """Least accurate component, or None."""
        return _worst(self.components) if self.components else None

    @property
    def measured(self) -> float:
        """Duration of the measured part of the run; 0 if nothing was measured."""
        return self.component.time if self.component else 0.0

    @property
    def duration(self) -> float:
        """Duration of the run including its discarded part; 0 if nothing was measured."""
        return self.measured / (1.0 - EQUILIBRATION)

    @property
    def main(self) -> str:
        """Name of the largest component in units of its scale, and of these the least accurate one."""
        sizes = {
            name: (abs(part.value) / part.scale if part.scale > 0.0 else 0.0, part.accuracy)
            for name, part in self.components.items()
        }
        return max(sizes, key=lambda name: sizes[name])

    @property
    def value(self) -> float:
        """Value of the main component."""
        return self.components[self.main].value if self.components else math.nan

    @property
    def accuracy(self) -> float:
        """Relative standard error of the least accurate component."""
        return self.component.accuracy if self.component else math.inf


def speed_of(target: Target, engine: Engine) -> float:
    """Measure CPU seconds per unit of simulated time; SceneError if the engine cannot simulate the scene."""
    if target.correlated:  # sampling takes longer than the simulation between samples
        return _speed_of_sampling(target, engine)
    tallies = target.tallies(engine)
    simulation = Simulation(target.scene, engine, SEED, initial=target.start, tallies=tallies)
    quantum = simulation.engine.quantum
    stretch = quantum or 1e-3 * target.crossing
    simulation.advance(duration=4.0 * stretch)  # compiles the kernels
    while True:
        before, start = simulation.time, time.process_time()
        simulation.advance(duration=stretch * 1.0000001)
        took = time.process_time() - start
        if took >= _PROBE:
            return took / (simulation.time - before)
        stretch *= min(16.0, max(2.0, 1.2 * _PROBE / max(took, 1e-6)))


def _speed_of_sampling(target: Target, engine: Engine) -> float:
    """Measure the speed of a run with correlations by two short runs. The first run compiles the kernels."""
    took, correlations = math.inf, target.correlations(engine)
    interval = correlations.lags * correlations.interval
    with scratch_folder() as folder:
        for name in ("first.nc", "second.nc"):
            start = time.process_time()
            scheduled = _TIMED * interval, interval, correlations
            _make(f"{folder}/{name}", target, engine, scheduled, target.needs_paths)
            took = time.process_time() - start
    return took / (_TIMED * interval)


def _make(
    path: str | Path,
    target: Target,
    engine: Engine,
    scheduled: tuple[float, float, Correlations | None],
    displacements: bool = True,
) -> Path:
    """Run a target with a schedule; it stores `displacements`, which other observables need too."""
    duration, interval, correlations = scheduled
    recipe = Recipe(
        target.scene, engine, SEED, duration, interval, initial=target.start, correlations=correlations,
        **{**target.contents(engine), "displacements": displacements},
    )  # fmt: skip
    return record(recipe, path, WriteOptions(overwrite=True, keep_checkpoint=True))


def require_defined(target: Target) -> None:
    """Raise SceneError, by a very short run, for an observable that is undefined for any run of a scene."""
    if target.correlated:  # the engines state these requirements
        return
    interval = _BRIEF * target.crossing / _TRIED
    with scratch_folder() as folder:
        path = _make(f"{folder}/brief.nc", target, reference_engine(), (_TRIED * interval, interval, None))
        with open_trajectory(path) as trajectory:
            _estimate(trajectory, target)


def _estimate(trajectory: xr.Dataset, target: Target) -> dict[str, Component] | str:
    """Return the components, or why the run is too short; SceneError if the observable is undefined."""
    try:
        estimates = components(trajectory, target.observable)
    except SceneError as error:
        rule = f"{error.key}: {error.rule}"
        if error.key not in _UNKNOWN_YET:
            raise SceneError("observable", target.name, rule) from None
        return rule
    return {name: component for name, component in estimates.items() if of_face(name, target.face)}


def run_pilot(target: Target, engine: Engine, seconds: float, speed: float, fraction: float = 1.0) -> Pilot:
    """Run a pilot of about the given CPU time, and measure the observable. `speed`: result of `speed_of`.
    `fraction`: fraction of the CPU time that remains after preparation, unless a stored pilot is reused. A
    pilot in a transient is extended to at most four times its length. If the observable needs a longer run,
    the pilot has no measured value. Raises SceneError if the observable is undefined in the scene.
    """
    scheduled = target.schedule(engine, fraction * seconds / speed)
    folder = cache_directory() / "pilots" / _digest(target, engine, seconds)
    folder.mkdir(parents=True, exist_ok=True)
    path, start = folder / "run.nc", time.process_time()
    kept = path.exists()
    try:
        if not kept:
            _make(path, target, engine, scheduled)
        settled = _equilibrate(path)
    except SimulationError as error:
        return Pilot(engine, speed, rule=str(error))
    took = 0.0 if kept else time.process_time() - start
    with open_trajectory(path) as trajectory:
        frames = trajectory["time"].values
        result = _estimate(trajectory, target)
        counted = _estimate(trajectory.assign_attrs(tallies="[]"), target) if target.tallies(engine) else ""
    blank = Pilot(engine, speed, took, {}, None, float(frames[1] - frames[0]), settled, path=path)
    if settled > EQUILIBRATION * frames[-1]:
        result = f"is not steady yet at the time {frames[-1]:.3g}"
    if isinstance(result, str):
        return replace(blank, rule=result)
    plain = None if isinstance(counted, str) else _worst(counted)
    return replace(blank, components=result, counted=plain)


def _worst(estimates: dict[str, Component]) -> Component:
    """Return the least accurate component."""
    return max(estimates.values(), key=lambda component: component.accuracy)


def _equilibrate(path: Path) -> float:
    """Return the `settling_time` of a pilot, extended until it lies within the discarded part."""
    for last in (False,) * _CONTINUED + (True,):
        with open_trajectory(path) as trajectory:
            settled, end = settling_time(trajectory), float(trajectory["time"][-1])
        if last or settled <= EQUILIBRATION * end:
            break
        extend(path, 2.0 * end, WriteOptions(keep_checkpoint=True))
    return settled


def settling_time(trajectory: xr.Dataset) -> float:
    """Return the time after which a run is steady. The test uses the kinetic energy and the mean position of
    the particles along each axis with walls. Each of these series has reached its mean over the second half
    of the run, and from then on stays within the range of the second half.
    """
    with open_run(trajectory, 0.0, sheared=True) as run:
        velocities, masses = run.peculiar, run.masses[run.moving]
        series = [np.einsum("tnd,tnd,n->t", velocities, velocities, masses)]
        positions = run.positions[:, run.moving].mean(axis=1)
        series += [positions[:, k] for k in range(run.dimension) if not run.periodic[k]]
        return max(float(run.time[_settled_at(values)]) for values in series)


def _settled_at(series: np.ndarray) -> int:
    """Return the index of the frame after which a series (T,) is steady."""
    later = series[len(series) // 2 :]
    beyond = series - later.mean()
    scatter = max(float(later.std()), _SAME * abs(float(later.mean())))
    at_start = abs(beyond[0]) <= _USUAL * scatter
    reached = 1 if at_start else max(1, int(np.argmax(beyond * beyond[0] <= 0.0)))
    far = np.flatnonzero(np.abs(beyond) > _RANGE * scatter)
    return min(len(series) - 1, max(reached, int(far[-1]) + 1 if far.size else 0))


def _digest(target: Target, engine: Engine, seconds: float) -> str:
    """Return a hash of a pilot's content, shared by observables that need the same stored data."""
    kind = "motion" if target.correlated else target.declared.samples
    if target.declared.needs in KEPT:
        kind = target.declared.needs
    kept = tallies_to_json(target.tallies(engine))
    content = [target.scene.to_dict(), engine_to_dict(engine), kind, kept, seconds, source_digest()]
    return hashlib.sha256(json.dumps(content).encode()).hexdigest()[:24]


# Candidate engines of a scene with their speeds, and their pilot runs.


DIFFERS = 2.5
"""Difference between two pilots, in standard errors, beyond which the bias exceeds its theoretical bound."""
_CERTAIN = 1.96
"""Number of standard errors that is added to a difference of pilots to bound a bias."""
_PREPARED = 5.0
"""CPU seconds of preparation that are not subtracted from the time of pilots."""
Announce: TypeAlias = Callable[[str], None]


@dataclass
class Trials:
    """Speeds and pilots of all candidate engines for a target.

    seconds : CPU time for all pilots.
    speeds : CPU time per unit of simulated time, by candidate.
    refused : reason for each rejected engine.
    pilots : pilots so far; the pilot of the exact engine is first.
    target : state from which later runs start, if a pilot reached a steady state.
    """

    target: Target
    accuracy: float
    seconds: float
    announce: Announce
    speeds: dict[Candidate, float] = field(default_factory=dict)
    refused: dict[str, str] = field(default_factory=dict)
    pilots: list[Pilot] = field(default_factory=list)
    _begun: float = field(default_factory=time.process_time)

    def begin(self) -> None:
        """Find the candidates and run the pilot of the exact engine. This pilot takes half of the CPU time if
        another engine may be cheaper. Raises SceneError if no engine can simulate the scene, or if the
        observable is undefined in the scene.
        """
        engines, self.refused = suitable_engines(self.target)
        if not engines or not engines[0].reference:
            raise self._no_engine()
        exact = Candidate(reference_engine())
        require_defined(self.target)
        conditions = self.target.conditions
        if conditions is not None and conditions.axis is None:
            self._time(self._able(conditions))
            exact_speed = self.speeds.get(exact, math.inf)
            cheaper = any(
                speed < exact_speed
                for candidate, speed in self.speeds.items()
                if candidate.bias < self.accuracy
            )
            self.make(exact, 0.5 if cheaper else 1.0)
            self._ask_another()
            return
        self._time([exact])
        rivals = len(engines) > 1 and self.target.declared.samples != "structure"
        pilot = self.make(exact, 0.5 if rivals else 1.0)
        if pilot.path is None:
            rule = f"the pilot of the {exact.engine.title} engine failed: {pilot.rule}"
            raise SceneError("observable", self.target.name, rule)
        if conditions is None:
            conditions = measured_conditions(self.target.scene, pilot.path)
        self._settle(pilot)
        self._time(self._able(conditions))
        self._ask_another()

    def make(self, candidate: Candidate, part: float = 0.5) -> Pilot:
        """Run another pilot with a fraction of the CPU time. The third and the fourth pilot get less time."""
        if candidate not in self.speeds:
            raise self._no_engine()
        spent = 0.0 if self.pilots else time.process_time() - self._begun
        fraction = min(1.0, max(0.5, 1.0 - (spent - _PREPARED) / self.seconds))
        seconds, engine = part * self.seconds / max(1, len(self.pilots)), candidate.engine
        self.announce(f"a pilot run, {engine.title} engine, {fraction * seconds:.2g} s")
        pilot = run_pilot(self.target, engine, seconds, self.speeds[candidate], fraction)
        self.pilots.append(pilot)
        return pilot

    def _ask_another(self) -> None:
        """Run a pilot of the cheapest accurate engine if the exact engine's pilot measured nothing."""
        able = [
            candidate
            for candidate in self.speeds
            if candidate.bias < self.accuracy and not self.has_pilot(candidate.engine)
        ]
        if able and not self.known:
            self.make(min(able, key=lambda candidate: self.speeds[candidate]))

    def refuse(self, candidate: Candidate, rule: str) -> None:
        """Reject a candidate with a reason."""
        self.refused[timed_as(candidate.engine)] = rule
        del self.speeds[candidate]

    def has_pilot(self, engine: Engine) -> bool:
        """Return True if an engine has a pilot."""
        return any(pilot.engine == engine for pilot in self.pilots)

    def bias(self, candidate: Candidate) -> float:
        """Return the bound on a candidate's bias, from theory or its pilot's difference from the
        exact one.
        """
        own = [pilot for pilot in self.known if pilot.engine == candidate.engine]
        return raised_bias(candidate, own[0], self.known) if own else candidate.bias

    @property
    def known(self) -> list[Pilot]:
        """Pilots that measured the observable."""
        return [pilot for pilot in self.pilots if 0.0 < pilot.accuracy < math.inf]

    @property
    def differing(self) -> tuple[Pilot, ...]:
        """Pilots that differ from the exact engine's pilot by more than the bounds on their biases."""
        pairs = ((pilot, self._candidate(pilot.engine)) for pilot in self.known)
        return tuple(
            pilot for pilot, candidate in pairs if candidate and self.bias(candidate) > candidate.bias
        )

    @property
    def reference(self) -> Pilot:
        """Longest pilot of an accurate engine, otherwise of any; SceneError if none measured the
        observable.
        """
        accurate = [pilot for pilot in self.known if self._is_accurate(pilot)] or self.known
        if accurate:
            return max(accurate, key=lambda pilot: pilot.measured)
        target = self.target
        rule = f"{self.pilots[0].rule or 'does not change in the pilot run'}; allow longer pilots"
        if target.declared.of_impulses and not target.face:
            rule += f", or state a wall, as in {target.observable}:{target.scene.container.walls[0]}"
        raise SceneError("observable", target.observable, rule)

    def noise(self, engine: Engine) -> Component:
        """Return the noise of the observable in a run with an engine. It comes from a pilot with impulses if
        the engine stores them.
        """
        with_impulses = [pilot for pilot in self.known if pilot.counted]
        if with_impulses and self.target.tallies(engine):
            component = max(with_impulses, key=lambda pilot: pilot.measured).component
        else:
            component = self.reference.counted or self.reference.component
        assert component is not None
        return component

    def _is_accurate(self, pilot: Pilot) -> bool:
        candidate = self._candidate(pilot.engine)
        return candidate is not None and self.bias(candidate) < self.accuracy

    def _candidate(self, engine: Engine) -> Candidate | None:
        return next((candidate for candidate in self.speeds if candidate.engine == engine), None)

    def _able(self, conditions: Conditions) -> list[Candidate]:
        able, refused = candidates(self.target, self.accuracy, conditions)
        self.refused |= refused
        return able

    def _time(self, able: list[Candidate]) -> None:
        """Measure the speeds of candidates, and reject each candidate that cannot start."""
        for candidate in able:
            self.announce(f"timing the {candidate.engine.title} engine")
            try:
                self.speeds[candidate] = speed_of(self.target, candidate.engine)
            except SceneError as error:  # for example, particles from which the engine cannot start
                self.refused[timed_as(candidate.engine)] = f"{error.key}: {error.rule}"

    def _settle(self, pilot: Pilot) -> None:
        """Start later runs from the end of a pilot, if its file contains the final state."""
        try:
            state = state_at_time_zero(self.target.scene, last_state(pilot.path or ""))
        except SceneError:  # for example, a piston
            return
        self.target = replace(self.target, settled=state)

    def _no_engine(self) -> SceneError:
        rule = f"no engine runs this scene: {'; '.join(self.refused.values())}"
        return SceneError("engine", ", ".join(self.refused), rule)


def raised_bias(candidate: Candidate, own: Pilot, pilots: list[Pilot]) -> float:
    """Raise the bound on a candidate's bias to its measured difference from the exact engine. The difference
    between the pilots of the two engines in the same component counts, including its error, if it is
    significant.
    """
    exact = [pilot for pilot in pilots if pilot.engine.reference]
    if candidate.engine.reference or not exact or exact[0].main not in own.components:
        return candidate.bias
    mine, reference = (pilot.components[exact[0].main] for pilot in (own, exact[0]))
    difference = abs(mine.value - reference.value) / reference.scale
    error = math.hypot(mine.accuracy, reference.accuracy)
    if difference <= candidate.bias + DIFFERS * error:
        return candidate.bias
    return difference + _CERTAIN * error
