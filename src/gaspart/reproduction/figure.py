"""Parts of a figure, and what the modules of several figures need to measure."""

from __future__ import annotations

import hashlib
import json
import math
import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from gaspart.analysis import series
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import autocorrelation_time, average, correlated_mean, jackknife
from gaspart.keys import Kind
from gaspart.reproduction.points.point import Point
from gaspart.scene.facts import plain_gas
from gaspart.trajectory.reading import open_trajectory

SOURCE_C = "[source C]"
PARTICLES = {2: "discs", 3: "spheres"}
"""Names of the particles in each dimension."""
ENSKOG_LIMIT = 0.02
"""Largest packing fraction of a gas that counts as dilute."""


@dataclass(frozen=True)
class Parts:
    """The parts of a figure: the settings of its config entry, and three functions. measure(points, settings)
    returns the data set, claims(dataset) its claims, draw(dataset) the picture. `key` is the number of the
    panel that shows the finding; None if it is the whole picture.
    """

    settings: dict[str, Kind]
    measure: Callable[..., Any]
    claims: Callable[..., Iterable[Any]]
    draw: Callable[..., Any]
    key: int | None = 0


@cache
def load_module(module: str) -> ModuleType:
    """Return a module by its import name, or by its path, which ends in .py."""
    if not module.endswith(".py"):
        return import_module(module)
    spec = spec_from_file_location(module, module)
    assert spec is not None and spec.loader is not None
    sys.modules[module] = loaded = module_from_spec(spec)  # where dataclasses look for it
    spec.loader.exec_module(loaded)
    return loaded


def find_parts(module: str, name: str) -> Parts:
    """Return the parts of a figure, or of a kind of figures, in a module."""
    loaded = load_module(module)
    parts: Parts = loaded.FIGURES[name] if name in loaded.FIGURES else loaded.KINDS[name]
    return parts


def content_key(paths: Iterable[str | Path], *stated: Any) -> str:
    """Return a digest of files, in folders too, and values: an equal key means that nothing must be
    measured.
    """
    key = hashlib.sha256(json.dumps(stated).encode())
    for path in map(Path, paths):
        for file in sorted(path.rglob("*.nc")) if path.is_dir() else [path]:
            with file.open("rb") as content:
                key.update(hashlib.file_digest(content, "sha256").digest())
    return key.hexdigest()


class Blocks:
    """Averages over independent blocks; a call returns a function of the means with its jackknife error. Each
    block is a tuple of numbers or arrays, which are the arguments of the function.
    """

    def __init__(self, blocks: Iterable[tuple]) -> None:
        self._series = [np.array(series) for series in zip(*blocks, strict=True)]

    def __call__(self, function: Callable[..., Any]) -> Estimate:
        """Return a function of the means with its error."""
        value, error = jackknife(function, *self._series)
        return Estimate(value, error, len(self._series[0]) - 1)


# Measured part of the replicas of a point, and their time correlations.


def runs(point: Point, first: int | None = None) -> Iterator[Run]:
    """Yield the frames of each replica, after its equilibration or from frame `first` on. Each run is open
    until the next run is requested. Raises OSError for a file that cannot be read, and ValueError for the
    file of another point.
    """
    scene, schedule = point.scene, point.schedule
    before = schedule.equilibration_frames
    more = scene.gravity, scene.faces, scene.walls, scene.particles, scene.thermostat, scene.rough
    centred = not any(more) and all(kind.exact_temperature for kind in scene.species)
    kept = slice(before if first is None else first, None)
    for path in point.replica_paths:
        with open_trajectory(path) as trajectory:
            if trajectory.sizes["frame"] != before + schedule.samples + 1:
                raise ValueError(f"{path}: {trajectory.sizes['frame']} frames are not those of {point.path}")
            yield Run(scene, trajectory["time"].values[kept], trajectory.isel(frame=kept), centred)


def kurtosis(speeds: np.ndarray) -> np.ndarray:
    """Compute <u^4> / <u^2>^2 over the last axis (exact definition); 1 for equal speeds."""
    square = speeds**2
    return (square**2).mean(axis=-1) / square.mean(axis=-1) ** 2


# Z and the collision rate of all replicas of a periodic point; see `gaspart.analysis.series`.


@dataclass(frozen=True)
class Series:
    """Values of the measured part of a run in each interval between its frames.

    z : (samples,), compressibility factor of each interval.
    rate : (samples,), collisions of a particle per time, times sigma sqrt(m / kT) (dimensionless), with kT =
        2 E_cm / (d N).
    interval : time between frames.
    counters : (samples,) each, the counts of every interval, by name.
    speed : sqrt(<v^2> / d) in the frame of the container.
    """

    z: np.ndarray
    rate: np.ndarray
    interval: float
    counters: dict[str, np.ndarray]
    speed: float


@dataclass(frozen=True)
class Pressure:
    """Z of all replicas of a point, with tests of blocks and replicas.

    chi_square : chi-square of the replicas about their mean, with their own errors; it has (replicas - 1)
    degrees of freedom.
    flat : True if all block errors reached a plateau.
    correlation : longest integrated autocorrelation time, in intervals (1/2 for independent samples).
    collision_rate : see `Series.rate`.
    counters : sums over the replicas.
    """

    z: Estimate
    chi_square: float
    degrees_of_freedom: int
    flat: bool
    correlation: float
    collision_rate: Estimate
    counters: dict[str, float]


COUNTED = ("collisions", "pair_tests", "box_visits", "crossings", "steps")


def series_of(run: Run) -> Series:
    """Return the series of a run of a plain gas in a periodic container; SceneError otherwise."""
    gas = plain_gas(run.scene)
    thermal = math.sqrt(run.temperature * run.freedom / (gas.dimension * gas.count * gas.mass))
    energy = float(run.data["kinetic_energy"].mean())
    return Series(
        z=series.compressibility(run),
        rate=series.collision_rate(run) * gas.diameter / thermal,
        interval=run.interval,
        counters={name: run.increments(name) for name in COUNTED if name in run.data},
        speed=math.sqrt(2.0 * energy / (gas.dimension * gas.count * gas.mass)),
    )


def pressure(point: Point) -> Pressure:
    """Return Z and the collision rate of a periodic point, from all its replicas."""
    return combine([series_of(run) for run in runs(point)])


def combine(replicas: list[Series]) -> Pressure:
    """Average over replicas of equal length; add errors of correlated series in quadrature."""
    means = [correlated_mean(series.z) for series in replicas]
    z = average([mean.estimate for mean in means])
    deviations = [(mean.estimate - z.value).deviation for mean in means]
    return Pressure(
        z=z,
        chi_square=float(np.sum(np.square(deviations))),
        degrees_of_freedom=len(replicas) - 1,
        flat=all(mean.flat for mean in means),
        correlation=max(autocorrelation_time(series.z) for series in replicas),
        collision_rate=average([correlated_mean(series.rate).estimate for series in replicas]),
        counters=totals(replicas),
    )


def totals(replicas: list[Series]) -> dict[str, float]:
    """Compute the sums of the counters over all replicas, by name."""
    return {
        name: float(sum(series.counters[name].sum() for series in replicas)) for name in replicas[0].counters
    }
