"""Short run of a scene, which predicts its cost and the noise of an observable.

A pilot is stored in the folder `pilots` of the cache, and reused for the same request.
"""

from __future__ import annotations

import hashlib
import json
import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from gaspart.accuracy.conditions import Conditions, measured_conditions
from gaspart.accuracy.estimates import Component, components, of_face
from gaspart.accuracy.option import candidates, suitable_engines
from gaspart.accuracy.target import SEED, Target
from gaspart.analysis.observables import KEPT, TOO_SHORT
from gaspart.analysis.run import EQUILIBRATION, open_run
from gaspart.engines import Engine, engine_to_dict, reference_engine
from gaspart.engines.engine import Candidate
from gaspart.errors import SceneError, SimulationError
from gaspart.kernels.compile.cache import cache_directory
from gaspart.kernels.compile.policy import source_digest
from gaspart.simulation import Simulation
from gaspart.state.given import state_at_time_zero
from gaspart.trajectory.last_state import last_state
from gaspart.trajectory.reading import open_trajectory
from gaspart.trajectory.recipe import Recipe
from gaspart.trajectory.run import WriteOptions, extend, record
from gaspart.trajectory.run_options import tallies_to_json

if TYPE_CHECKING:
    from pathlib import Path

    import xarray as xr

    from gaspart.trajectory.correlator import Correlations


_PROBE = 0.15
"""Processor seconds that the speed is measured for, at least."""
_TIMED = 4
"""Duration of a timed run with correlations, in longest lags."""
_BRIEF, _TRIED = 1e-3, 24
"""The length of a run that shows whether there is an observable, in crossings of the container, and its
frames."""
_UNKNOWN_YET = *TOO_SHORT, "particles at rest", "sample_interval"
"""Keys of errors that a longer run may not have."""
_SAME = 1e-6
"""Part of a kinetic energy that is rounding."""
_USUAL, _RANGE = 2.0, 5.0
"""Standard deviations within which a start is like a steady run, and which that does not go beyond."""
_CONTINUED = 2
"""Maximum number of times that a pilot in a transient is doubled in length."""


@dataclass(frozen=True)
class Pilot:
    """Results of a short run of an engine.

    speed : CPU seconds per unit of time.
    seconds : CPU time of the pilot, 0 if it was stored before.
    component : the least accurate component, None if the observable could not be measured, for the reason in
        `rule`.
    counted : this component without the impulses that the run has stored, None if the run has stored none.
    interval : time between frames.
    settled : time from which the run is steady (`settling_time`).
    path : file, None for a run that failed.
    """

    engine: Engine
    speed: float
    seconds: float = 0.0
    component: Component | None = None
    counted: Component | None = None
    interval: float = math.inf
    settled: float = 0.0
    rule: str = ""
    path: Path | None = None

    @property
    def measured(self) -> float:
        """The time that the observable is of, 0 where it was not measured."""
        return self.component.time if self.component else 0.0

    @property
    def duration(self) -> float:
        """Duration of the run, with its discarded part; 0 if nothing was measured."""
        return self.measured / (1.0 - EQUILIBRATION)

    @property
    def value(self) -> float:
        """Value of the component."""
        return self.component.value if self.component else math.nan

    @property
    def accuracy(self) -> float:
        """Relative standard error of the component."""
        return self.component.accuracy if self.component else math.inf


def speed_of(target: Target, engine: Engine) -> float:
    """Measure the CPU seconds per unit of a scene's time.

    The run takes a fraction of a second after its kernels were compiled. Raises SceneError for a scene that
    the engine does not model.
    """
    if target.correlated:  # samples take longer than what happens between them
        return _speed_of_sampling(target, engine)
    tallies = target.tallies(engine)
    simulation = Simulation(target.scene, engine, SEED, initial=target.start, tallies=tallies)
    quantum = simulation.engine.quantum
    stretch = quantum or 1e-3 * target.crossing
    simulation.advance(duration=4.0 * stretch)  # compiles
    while True:
        before, start = simulation.time, time.process_time()
        simulation.advance(duration=stretch * 1.0000001)
        took = time.process_time() - start
        if took >= _PROBE:
            return took / (simulation.time - before)
        stretch *= min(16.0, max(2.0, 1.2 * _PROBE / max(took, 1e-6)))


def _speed_of_sampling(target: Target, engine: Engine) -> float:
    """Measure the speed of a run with correlations by two short runs; the first one compiles."""
    took, correlations = math.inf, target.correlations(engine)
    interval = correlations.lags * correlations.interval
    with TemporaryDirectory() as folder:
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
    """Run a target with a schedule: duration, time between frames, correlations.

    Pilots store `displacements`, which serve other observables too.
    """
    duration, interval, correlations = scheduled
    recipe = Recipe(
        target.scene, engine, SEED, duration, interval, initial=target.start, correlations=correlations,
        **{**target.contents(engine), "displacements": displacements},
    )  # fmt: skip
    return record(recipe, path, WriteOptions(overwrite=True, keep_checkpoint=True))


def require_defined(target: Target) -> None:
    """Raise SceneError for an observable that a scene does not have, however long its run.

    The observable is measured in a very short run.
    """
    if target.correlated:  # what these need, engines state
        return
    interval = _BRIEF * target.crossing / _TRIED
    with TemporaryDirectory() as folder:
        path = _make(f"{folder}/brief.nc", target, reference_engine(), (_TRIED * interval, interval, None))
        with open_trajectory(path) as trajectory:
            _estimate(trajectory, target)


def _estimate(trajectory: xr.Dataset, target: Target) -> dict[str, Component] | str:
    """Return the components of an observable, or the reason if the run is too short.

    Raises SceneError for an observable that the scene does not have.
    """
    try:
        estimates = components(trajectory, target.observable)
    except SceneError as error:
        rule = f"{error.key}: {error.rule}"
        if error.key not in _UNKNOWN_YET:
            raise SceneError("observable", target.name, rule) from None
        return rule
    return {name: component for name, component in estimates.items() if of_face(name, target.face)}


def run_pilot(target: Target, engine: Engine, seconds: float, speed: float, fraction: float = 1.0) -> Pilot:
    """Make and measure a run of about a given number of CPU seconds.

    speed : result of `speed_of`.
    fraction : fraction of the seconds that remains, unless a pilot was stored.

    A pilot in a transient is continued, to four times its length at most. An observable that needs a longer
    run is not measured. Raises SceneError for an observable that the scene does not have.
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
    blank = Pilot(engine, speed, took, None, None, float(frames[1] - frames[0]), settled, path=path)
    if settled > EQUILIBRATION * frames[-1]:
        result = f"is not steady yet at the time {frames[-1]:.3g}"
    if isinstance(result, str):
        return replace(blank, rule=result)
    plain = None if isinstance(counted, str) else _worst(counted)
    return replace(blank, component=_worst(result), counted=plain)


def _worst(estimates: dict[str, Component]) -> Component:
    """Return the least accurate component."""
    return max(estimates.values(), key=lambda component: component.accuracy)


def _equilibrate(path: Path) -> float:
    """Return the `settling_time` of a pilot, and continue the pilot until it is steady.

    The run is steady if the settling time is within the discarded part.
    """
    for last in (False,) * _CONTINUED + (True,):
        with open_trajectory(path) as trajectory:
            settled, end = settling_time(trajectory), float(trajectory["time"][-1])
        if last or settled <= EQUILIBRATION * end:
            break
        extend(path, 2.0 * end, WriteOptions(keep_checkpoint=True))
    return settled


def settling_time(trajectory: xr.Dataset) -> float:
    """Return the time from which a run is steady.

    After the settling time two conditions hold for the kinetic energy, and for the mean position of the
    particles along each axis with walls. They have reached their means of the second half, and they never
    leave the range of the second half again.
    """
    with open_run(trajectory, 0.0, sheared=True) as run:
        velocities, masses = run.peculiar, run.masses[run.moving]
        series = [np.einsum("tnd,tnd,n->t", velocities, velocities, masses)]
        positions = run.positions[:, run.moving].mean(axis=1)
        series += [positions[:, k] for k in range(run.dimension) if not run.periodic[k]]
        return max(float(run.time[_settled_at(values)]) for values in series)


def _settled_at(series: np.ndarray) -> int:
    """Return the number of the frame from which a series (T,) is steady."""
    later = series[len(series) // 2 :]
    beyond = series - later.mean()
    scatter = max(float(later.std()), _SAME * abs(float(later.mean())))
    at_start = abs(beyond[0]) <= _USUAL * scatter
    reached = 1 if at_start else max(1, int(np.argmax(beyond * beyond[0] <= 0.0)))
    far = np.flatnonzero(np.abs(beyond) > _RANGE * scatter)
    return min(len(series) - 1, max(reached, int(far[-1]) + 1 if far.size else 0))


def _digest(target: Target, engine: Engine, seconds: float) -> str:
    """Return the digest of a pilot's content.

    Runs of one kind, which store the same data, serve other observables too.
    """
    kind = "motion" if target.correlated else target.declared.samples
    if target.declared.needs in KEPT:
        kind = target.declared.needs
    kept = tallies_to_json(target.tallies(engine))
    content = [target.scene.to_dict(), engine_to_dict(engine), kind, kept, seconds, source_digest()]
    return hashlib.sha256(json.dumps(content).encode()).hexdigest()[:24]


# The candidates of a scene with their speeds, and the pilots that show what they are like.


DIFFERS = 2.5
"""Standard errors by which two pilots differ if one is biased more than theory says."""
_CERTAIN = 1.96
"""Standard errors of a difference that are added to it for a bound on a bias."""
_PREPARED = 5.0
"""Processor seconds until pilots begin that are not taken from theirs."""
Announce: TypeAlias = Callable[[str], None]


@dataclass
class Trials:
    """Speeds and pilots of the engines for a target.

    seconds : CPU time for all pilots.
    speeds : CPU time of a unit of time by candidate.
    refused : reasons why other engines are rejected.
    pilots : pilots made so far, the exact engine's first.
    target : if a pilot has a steady state, runs start from it.
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
        """Find the candidates and make the pilot of the exact engine.

        The pilot takes half the time if another engine may be cheaper. Raises SceneError if no engine runs
        the scene, and for an observable that the scene does not have.
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
        """Make one more pilot, with a part of the CPU time.

        A third and a fourth one have less time.
        """
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
        """Make a pilot of the cheapest accurate engine if the exact engine's has measured nothing."""
        able = [
            candidate
            for candidate in self.speeds
            if candidate.bias < self.accuracy and not self.has_pilot(candidate.engine)
        ]
        if able and not self.known:
            self.make(min(able, key=lambda candidate: self.speeds[candidate]))

    def refuse(self, candidate: Candidate, rule: str) -> None:
        """Reject a candidate for a reason."""
        self.refused[candidate.engine.timed_as] = rule
        del self.speeds[candidate]

    def has_pilot(self, engine: Engine) -> bool:
        """Return True if an engine has a pilot."""
        return any(pilot.engine == engine for pilot in self.pilots)

    def bias(self, candidate: Candidate) -> float:
        """Return the bound on a candidate's bias, from theory or from its pilot.

        The pilot's bound is its difference from the exact engine's pilot.
        """
        own = [pilot for pilot in self.known if pilot.engine == candidate.engine]
        return raised_bias(candidate, own[0], self.known) if own else candidate.bias

    @property
    def known(self) -> list[Pilot]:
        """The pilots that have measured the observable."""
        return [pilot for pilot in self.pilots if 0.0 < pilot.accuracy < math.inf]

    @property
    def differing(self) -> tuple[Pilot, ...]:
        """Pilots that differ from the exact engine's by more than their bounds."""
        pairs = ((pilot, self._candidate(pilot.engine)) for pilot in self.known)
        return tuple(
            pilot for pilot, candidate in pairs if candidate and self.bias(candidate) > candidate.bias
        )

    @property
    def reference(self) -> Pilot:
        """Longest pilot of an engine that is accurate enough, or otherwise of any engine.

        Raises SceneError if the observable was not measured.
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
        """Return the noise of the observable in a run by an engine.

        If the engine stores impulses, it is the noise in a pilot with impulses, otherwise the noise of
        counts. Raises SceneError as `reference`.
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
        """Measure the speeds of candidates; reject a candidate that cannot start."""
        for candidate in able:
            self.announce(f"timing the {candidate.engine.title} engine")
            try:
                self.speeds[candidate] = speed_of(self.target, candidate.engine)
            except SceneError as error:  # as of particles from which the engine cannot start
                self.refused[candidate.engine.timed_as] = f"{error.key}: {error.rule}"

    def _settle(self, pilot: Pilot) -> None:
        """Start the continuation from the end of a pilot, if its file contains the state."""
        try:
            state = state_at_time_zero(self.target.scene, last_state(pilot.path or ""))
        except SceneError:  # as of a piston
            return
        self.target = replace(self.target, settled=state)

    def _no_engine(self) -> SceneError:
        rule = f"no engine runs this scene: {'; '.join(self.refused.values())}"
        return SceneError("engine", ", ".join(self.refused), rule)


def raised_bias(candidate: Candidate, own: Pilot, pilots: list[Pilot]) -> float:
    """Raise the bound on a candidate's bias to its difference from the exact engine.

    The difference of its pilot from the pilot of the exact engine counts, with its error, if it is
    significant.
    """
    exact = [pilot for pilot in pilots if pilot.engine.reference]
    if candidate.engine.reference or not exact:
        return candidate.bias
    difference = abs(own.value / exact[0].value - 1.0)
    error = math.hypot(own.accuracy, exact[0].accuracy)
    if difference <= candidate.bias + DIFFERS * error:
        return candidate.bias
    return difference + _CERTAIN * error
