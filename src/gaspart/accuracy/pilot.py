"""A short run of a scene, from which its cost and the noise of an observable are extrapolated.

A pilot is kept in the folder `pilots` of the cache, and reused where the same is asked again.
"""

from __future__ import annotations

import hashlib
import json
import math
import time
from dataclasses import dataclass, replace
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np

from gaspart.accuracy.estimates import Component, components, of_face
from gaspart.accuracy.target import SEED, Target
from gaspart.analysis.observables import KEPT, TOO_SHORT
from gaspart.analysis.run import EQUILIBRATION, open_run
from gaspart.engines import Engine, engine_to_dict, reference_engine
from gaspart.errors import SceneError, SimulationError
from gaspart.kernels.compile.cache import cache_directory
from gaspart.kernels.compile.policy import source_digest
from gaspart.simulation import Simulation
from gaspart.state.optional_tallies import tally_to_dict
from gaspart.trajectory.reading import open_trajectory
from gaspart.trajectory.recipe import Recipe
from gaspart.trajectory.run import WriteOptions, extend, record

if TYPE_CHECKING:
    from pathlib import Path

    import xarray as xr

    from gaspart.trajectory.correlator import Correlations

_PROBE = 0.15
"""Processor seconds that the speed is measured for, at least."""
_TIMED = 4
"""Longest lags, likewise of a run with correlations."""
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
"""How often a pilot is made twice as long while it is in a transient."""


@dataclass(frozen=True)
class Pilot:
    """What a short run of an engine has shown.

    speed: processor seconds per unit of time; seconds: that the pilot took, 0 if it was kept from before;
    component: the one that is known worst, None where the observable could not be measured, for the reason in
    `rule`; counted: the same without the impulses that the run has kept, None if it has none; interval:
    between frames; settled: the time from which on the run is steady (`settling_time`); path: its file, None
    of a run that failed.
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
        """Of the run, with what was not measured, 0 likewise."""
        return self.measured / (1.0 - EQUILIBRATION)

    @property
    def value(self) -> float:
        """Of that component."""
        return self.component.value if self.component else math.nan

    @property
    def accuracy(self) -> float:
        """Its relative standard error."""
        return self.component.accuracy if self.component else math.inf


def speed_of(target: Target, engine: Engine) -> float:
    """Processor seconds per unit of a scene's time, from a run of a fraction of a second after its kernels
    were compiled. Raises SceneError for a scene that the engine does not model."""
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
    """The same of a run with correlations, by two short ones, of which the first compiles."""
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
    """Run a target as scheduled: duration, time between frames, correlations. displacements: kept by pilots,
    which serve other observables too."""
    duration, interval, correlations = scheduled
    recipe = Recipe(
        target.scene, engine, SEED, duration, interval,
        displacements=displacements, correlations=correlations,
        pairs=target.declared.needs == "pairs", initial=target.start, tallies=target.tallies(engine),
    )  # fmt: skip
    return record(recipe, path, WriteOptions(overwrite=True, keep_checkpoint=True))


def require_defined(target: Target) -> None:
    """Raise SceneError for an observable that a scene does not have, however long its run: by measuring it in
    a very short one."""
    if target.correlated:  # what these need, engines state
        return
    interval = _BRIEF * target.crossing / _TRIED
    with TemporaryDirectory() as folder:
        path = _make(f"{folder}/brief.nc", target, reference_engine(), (_TRIED * interval, interval, None))
        with open_trajectory(path) as trajectory:
            _measured(trajectory, target)


def _measured(trajectory: xr.Dataset, target: Target) -> dict[str, Component] | str:
    """The components of an observable, or why the run is too short for it. Raises SceneError for one that the
    scene does not have."""
    try:
        found = components(trajectory, target.observable)
    except SceneError as error:
        rule = f"{error.key}: {error.rule}"
        if error.key not in _UNKNOWN_YET:
            raise SceneError("observable", target.name, rule) from None
        return rule
    return {name: one for name, one in found.items() if of_face(name, target.face)}


def run_pilot(target: Target, engine: Engine, seconds: float, speed: float, left: float = 1.0) -> Pilot:
    """A run of about so many processor seconds, measured; speed: as from `speed_of`; left: the part of the
    seconds that there is time for, unless a pilot was kept. One that is in a transient is continued, to four
    times its length at most. An observable that it is too short for is not measured. Raises SceneError for
    one that the scene does not have."""
    scheduled = target.schedule(engine, left * seconds / speed)
    folder = cache_directory() / "pilots" / _digest(target, engine, seconds)
    folder.mkdir(parents=True, exist_ok=True)
    path, start = folder / "run.nc", time.process_time()
    kept = path.exists()
    try:
        if not kept:
            _make(path, target, engine, scheduled)
        settled = _steadied(path)
    except SimulationError as error:
        return Pilot(engine, speed, rule=str(error))
    took = 0.0 if kept else time.process_time() - start
    with open_trajectory(path) as trajectory:
        frames = trajectory["time"].values
        found = _measured(trajectory, target)
        counted = _measured(trajectory.assign_attrs(tallies="[]"), target) if target.tallies(engine) else ""
    blank = Pilot(engine, speed, took, None, None, float(frames[1] - frames[0]), settled, path=path)
    if settled > EQUILIBRATION * frames[-1]:
        found = f"is not steady yet at the time {frames[-1]:.3g}"
    if isinstance(found, str):
        return replace(blank, rule=found)
    plain = None if isinstance(counted, str) else _worst(counted)
    return replace(blank, component=_worst(found), counted=plain)


def _worst(found: dict[str, Component]) -> Component:
    """The component that is known worst."""
    return max(found.values(), key=lambda one: one.accuracy)


def _steadied(path: Path) -> float:
    """The `settling_time` of a pilot, which is continued while it is not within the part that is not
    measured."""
    for last in (False,) * _CONTINUED + (True,):
        with open_trajectory(path) as trajectory:
            settled, end = settling_time(trajectory), float(trajectory["time"][-1])
        if last or settled <= EQUILIBRATION * end:
            break
        extend(path, 2.0 * end, WriteOptions(keep_checkpoint=True))
    return settled


def settling_time(trajectory: xr.Dataset) -> float:
    """The time from which on a run is steady: when the kinetic energy, and the mean place of the particles
    along each axis with walls, have reached their means of the second half, and have left the range of that
    for the last time."""
    with open_run(trajectory, 0.0, sheared=True) as run:
        velocities, masses = run.peculiar, run.masses[run.moving]
        series = [np.einsum("tnd,tnd,n->t", velocities, velocities, masses)]
        places = run.positions[:, run.moving].mean(axis=1)
        series += [places[:, k] for k in range(run.dimension) if not run.periodic[k]]
        return max(float(run.time[_settled_at(one)]) for one in series)


def _settled_at(series: np.ndarray) -> int:
    """The number of the frame from which on a series (T,) is steady."""
    later = series[len(series) // 2 :]
    beyond = series - later.mean()
    scatter = max(float(later.std()), _SAME * abs(float(later.mean())))
    at_start = abs(beyond[0]) <= _USUAL * scatter
    reached = 1 if at_start else max(1, int(np.argmax(beyond * beyond[0] <= 0.0)))
    far = np.flatnonzero(np.abs(beyond) > _RANGE * scatter)
    return min(len(series) - 1, max(reached, int(far[-1]) + 1 if far.size else 0))


def _digest(target: Target, engine: Engine, seconds: float) -> str:
    """Of what a pilot is: runs of one kind, which keep the same, serve other observables too."""
    kind = "motion" if target.correlated else target.declared.samples
    if target.declared.needs in KEPT:
        kind = target.declared.needs
    kept = [tally_to_dict(tally) for tally in target.tallies(engine)]
    content = [target.scene.to_dict(), engine_to_dict(engine), kind, kept, seconds, source_digest()]
    return hashlib.sha256(json.dumps(content).encode()).hexdigest()[:24]
