"""A short run of a scene, from which its cost and the noise of an observable are extrapolated.

A pilot is kept in the folder `pilots` of the cache, and reused where the same is asked again.
"""

from __future__ import annotations

import hashlib
import json
import math
import time
from dataclasses import dataclass
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np

from gaspart.analysis.diffusion import LINEAR_FROM
from gaspart.analysis.motion import MOST_FRAMES
from gaspart.analysis.names import FLUXES, MOTION, PAIRS, PATHS
from gaspart.analysis.run import EQUILIBRATION, measured
from gaspart.engines import Engine, engine_to_dict
from gaspart.engines.dsmc.rates import rates
from gaspart.errors import SceneError, SimulationError
from gaspart.kernels.compile.cache import cache_directory
from gaspart.kernels.compile.policy import source_digest
from gaspart.scene.scene import Scene
from gaspart.simulation import Simulation
from gaspart.tradeoff.estimates import Component, components
from gaspart.tradeoff.reached import TOO_SHORT, bound
from gaspart.trajectory.correlator import Correlations
from gaspart.trajectory.reading import open_trajectory
from gaspart.trajectory.run import run

if TYPE_CHECKING:
    import xarray as xr

DIFFUSION = "D", "mutual_diffusion"
CORRELATED = *FLUXES, *MOTION
"""Those of a run with correlations."""
SEED = 0
_PROBE = 0.15
"""Processor seconds that the speed is measured for, at least."""
_TIMED = 4
"""Longest lags, likewise of a run with correlations."""
_FRAMES = 48, 512
_HELD = 20_000_000
"""Numbers that the frames of a pilot hold, at most, unless there are only few frames."""
_SAME = 1e-6
"""Part of a kinetic energy that is rounding."""
_LAGS = {**dict.fromkeys(FLUXES, 100), **dict.fromkeys(MOTION, 40)}
"""Of correlations, in samples: up to ten collisions of a particle."""
_LONGEST_LAG = 10.0
_LEAST_FRAMES = 24
"""Of a run with correlations: three quarters of them give an error."""


@dataclass(frozen=True)
class Pilot:
    """What a short run of an engine has shown.

    speed: processor seconds per unit of time; seconds: that the pilot took, 0 if it was kept from before;
    component: the one that is known worst, None where the observable could not be measured, for the reason in
    `rule`; interval: between frames; settled: the time of the first frame after the start at
    which the kinetic energy reaches its mean of the second half.
    """

    engine: Engine
    speed: float
    seconds: float = 0.0
    component: Component | None = None
    interval: float = math.inf
    settled: float = 0.0
    rule: str = ""

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

    def length(self, accuracy: float) -> float:
        """The measured time with which the upper bound of the error is so small, as of a run `until`
        accurate; inf if none is."""
        if not self.component or not self.accuracy < math.inf or not accuracy > 0.0:
            return math.inf
        room = accuracy * self.component.scale / bound(self.component.freedom)
        part = 0.5 * self.component.spectrum / room**2
        return part + math.sqrt(part**2 + self.component.stored / room**2)

    def reaches(self, time: float) -> float:
        """The inverse: that bound after a measured time, relative."""
        if not self.component or not self.accuracy < math.inf:
            return math.inf
        return self.component.error(time) / self.component.scale * bound(self.component.freedom)


def speed_of(scene: Scene, engine: Engine, observable: str) -> float:
    """Processor seconds per unit of a scene's time, from a run of a fraction of a second after its kernels
    were compiled. Raises SceneError for a scene that the engine does not model."""
    if observable in CORRELATED:  # samples take longer than what happens between them
        return _speed_of_sampling(scene, engine, observable)
    simulation = Simulation(scene, engine, SEED)
    quantum = simulation.engine.quantum
    stretch = quantum or 1e-3 * crossing(scene)
    simulation.advance(duration=4.0 * stretch)  # compiles
    while True:
        before, start = simulation.time, time.process_time()
        simulation.advance(duration=stretch * 1.0000001)
        took = time.process_time() - start
        if took >= _PROBE:
            return took / (simulation.time - before)
        stretch *= min(16.0, max(2.0, 1.2 * _PROBE / max(took, 1e-6)))


def _speed_of_sampling(scene: Scene, engine: Engine, observable: str) -> float:
    """The same of a run with correlations, by two short ones, of which the first compiles."""
    took, correlations = math.inf, correlations_of(scene, engine, observable)
    interval = correlations.lags * correlations.interval
    with TemporaryDirectory() as folder:
        for name in ("first.nc", "second.nc"):
            start = time.process_time()
            run(
                scene, engine, SEED, _TIMED * interval, interval, f"{folder}/{name}",
                displacements=observable in PATHS, correlations=correlations,
            )  # fmt: skip
            took = time.process_time() - start
    return took / (_TIMED * interval)


def crossing(scene: Scene) -> float:
    """The time in which a particle crosses the shortest side of the container."""
    squares = [
        kind.temperature / kind.mass if kind.temperature else (kind.speed or 0.0) ** 2
        for kind in scene.species
    ]
    squares += [sum(v * v for v in particle.velocity) for particle in scene.particles]
    squares += [getattr(face, "temperature", None) or 0.0 for face in scene.faces.values()]
    if scene.gravity:
        squares.append(max(map(abs, scene.gravity)) * min(scene.container.lengths))
    fastest = math.sqrt(max(squares))
    if not fastest > 0.0:
        raise SceneError("temperature", 0.0, "advice is for moving particles")
    return min(scene.container.lengths) / fastest


def run_pilot(scene: Scene, engine: Engine, observable: str, seconds: float, speed: float) -> Pilot:
    """A run of about so many processor seconds, measured; speed: as from `speed_of`. An observable that it is
    too short for is not measured. Raises SceneError for one that the scene does not have."""
    duration, interval, correlations = schedule(scene, engine, observable, seconds / speed)
    kinds = {"fluxes": FLUXES, "motion": MOTION, "pairs": PAIRS}
    kind = next((kind for kind, names in kinds.items() if observable in names), "")
    folder = cache_directory() / "pilots" / _digest(scene, engine, kind, seconds)
    folder.mkdir(parents=True, exist_ok=True)
    took, path = 0.0, folder / "run.nc"
    if not path.exists():
        start = time.process_time()
        try:
            run(
                scene, engine, SEED, duration, interval, path,
                displacements=True, correlations=correlations, pairs=observable in PAIRS, overwrite=True,
            )  # fmt: skip
        except SimulationError as error:
            return Pilot(engine, speed, rule=str(error))
        took = time.process_time() - start
    with open_trajectory(path) as trajectory:
        try:
            found, settled = components(trajectory, observable), _settled(trajectory)
        except SceneError as error:
            rule = f"{error.key}: {error.rule}"
            if error.key not in TOO_SHORT:
                raise SceneError("observable", observable, rule) from None
            return Pilot(engine, speed, took, rule=rule)
    worst = max(found.values(), key=lambda one: one.accuracy)
    return Pilot(engine, speed, took, worst, interval, settled)


def _settled(trajectory: xr.Dataset) -> float:
    """See `Pilot`."""
    with measured(trajectory, 0.0, sheared=True) as run:
        velocities = run.peculiar
        energy = np.einsum("tnd,tnd,n->t", velocities, velocities, run.masses[run.moving])
        later = energy[len(energy) // 2 :]
        beyond = energy - later.mean()
        reached = (np.abs(beyond) <= _SAME * later.mean()) | (beyond * beyond[0] <= 0.0)
        return float(run.time[max(1, int(np.argmax(reached)))])


def schedule(
    scene: Scene, engine: Engine, observable: str, length: float
) -> tuple[float, float, Correlations | None]:
    """Duration, time between frames and correlations of a run of about a length."""
    least, most = _FRAMES
    longest_interval, longest = span(scene, observable)
    length = min(length, longest)
    frames = int(np.clip(_HELD // max(1, 3 * scene.count * scene.dimension), least, most))
    if observable in CORRELATED:
        return _correlated(scene, engine, observable, length)
    interval = min(length / frames, longest_interval)
    frames = math.ceil(length / interval * (1.0 - 1e-9))
    if quantum := engine.resolved(scene).quantum:
        interval = max(1, round(interval / quantum)) * quantum
    return frames * interval, interval, None


def span(scene: Scene, observable: str) -> tuple[float, float]:
    """The longest time between frames and the longest run from which an observable is measured without loss:
    of diffusion by the lags of its slope, and by the number of frames that are correlated."""
    frequency = rates(scene, dense=True).frequency
    if observable not in DIFFUSION or not frequency > 0.0:
        return math.inf, math.inf
    interval = 0.5 * LINEAR_FROM / frequency
    return interval, interval * MOST_FRAMES / (1.0 - EQUILIBRATION)


def correlations_of(scene: Scene, engine: Engine, observable: str) -> Correlations:
    """Those that an observable needs. Raises SceneError for a scene whose particles do not collide."""
    found, lags = rates(scene, dense=True).frequency, _LAGS[observable]
    if not found > 0.0:
        raise SceneError("observable", observable, "needs particles that collide")
    sample = float(f"{_LONGEST_LAG / lags / found:.1g}")
    if quantum := engine.resolved(scene, sample).quantum:
        sample = tidy(max(1, round(sample / quantum)) * quantum)
    return Correlations(sample, lags, stress=observable in FLUXES)


def _correlated(
    scene: Scene, engine: Engine, observable: str, length: float
) -> tuple[float, float, Correlations]:
    """The same with correlations, whose longest lag frames are apart or more."""
    correlations = correlations_of(scene, engine, observable)
    sample = correlations.interval
    per_frame = max(correlations.lags, round(length / sample / _FRAMES[0]))
    interval = tidy(per_frame * sample)
    return tidy(max(_LEAST_FRAMES, round(length / interval)) * interval), interval, correlations


def tidy(multiple: float) -> float:
    """A multiple without its rounding error, which a command would show."""
    return float(f"{multiple:.12g}")


def _digest(scene: Scene, engine: Engine, kind: str, seconds: float) -> str:
    content = [scene.to_dict(), engine_to_dict(engine), kind, seconds, source_digest()]
    return hashlib.sha256(json.dumps(content).encode()).hexdigest()[:24]
