"""Z and the collision rate of all replicas of a periodic point; see `gaspart.analysis.series`."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gaspart.analysis import series
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import autocorrelation_time, average, correlated_mean
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.scene.gas import plain_gas


@dataclass(frozen=True)
class Series:
    """Values of the measured part of a run in each interval between its frames.

    z : (samples,), compressibility factor of each interval.
    rate : (samples,), collisions of one particle per time, times sigma sqrt(m / kT) (dimensionless), with kT
        = 2 E_cm / (d N).
    interval : time between frames.
    counters : (samples,) each, the counts of every interval, by name.
    speed : sqrt(<v^2> / d) in the container's frame.
    """

    z: np.ndarray
    rate: np.ndarray
    interval: float
    counters: dict[str, np.ndarray]
    speed: float


@dataclass(frozen=True)
class Pressure:
    """Z of all replicas of a point, with tests of blocks and replicas.

    chi_square : of the replicas about their mean, by their own errors, with replicas - 1 degrees of freedom.
    flat : True if all block errors had reached a plateau.
    correlation : longest integrated autocorrelation time, in intervals (1/2: independent).
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
    """Return the series of a run of a plain gas in a periodic container.

    Raises SceneError for any other scene.
    """
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
    """Average over replicas of equal length; errors of correlated series are added in quadrature."""
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
