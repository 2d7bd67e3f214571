r"""Pressure of a periodic run by the collisional virial, and the rate of its collisions.

Periodic boundaries have no walls, so the momentum through a plane is taken from the virial theorem: with
impulses :math:`\Delta p` exchanged at the distance :math:`\Delta r`,

.. math:: Z = \frac{P V}{N k_B T} = 1 + \frac{\sum |\Delta r \cdot \Delta p|}{d\, N k_B T\, t} .

The total momentum of a periodic scene is conserved, and the temperature is that of the motion about it:
:math:`N - 1` velocities are independent, so :math:`k_B T = 2 E_\mathrm{cm} / (d (N - 1))`, with
:math:`E_\mathrm{cm} = E - |\sum m v|^2 / (2 \sum m)`. The value of Z for finite N: a pair at contact gives
:math:`|\Delta p| \propto |v_n|` at a rate :math:`\propto |v_n|`, so the sum grows with
:math:`\langle v_n^2 \rangle`, v_n one component of :math:`v_1 - v_2`. That is linear in the energy (fixing
the energy changes nothing), and with zero total momentum
:math:`\langle v_1 \cdot v_2 \rangle = -\langle v^2 \rangle / (N - 1)`, hence
:math:`\langle v_n^2 \rangle = 2 k_B T / m` with this T. So :math:`Z_N - 1` is that of the canonical
ensemble of N particles, whose distance from the infinite system is known to first order in 1/N
(``gaspart.theory.finite_size_correction(..., ensemble="canonical")``). The remainder is of order
:math:`1/N^2`, and terms that fall exponentially with the side over the correlation length.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import autocorrelation_time, average, correlated_mean
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.scene.gas import plain_gas


@dataclass(frozen=True)
class Series:
    """What the measured part of a run gives in each interval between its frames.

    z: (samples,) compressibility factor of each interval between frames; rate: (samples,) collisions of one
    particle per time, times sigma sqrt(m / kT) (dimensionless), with kT = 2 E_cm / (d N); interval: time
    between frames; counters: (samples,) each, the counts of every interval, by name; speed: sqrt(<v^2> / d)
    in the container's frame.
    """

    z: np.ndarray
    rate: np.ndarray
    interval: float
    counters: dict[str, np.ndarray]
    speed: float


@dataclass(frozen=True)
class Pressure:
    """Z of all replicas of a point, and whether blocks and replicas agree about it.

    chi_square: of the replicas about their mean, by their own errors, with replicas - 1 degrees of freedom;
    flat: all block errors had reached a plateau; correlation: longest integrated autocorrelation time, in
    intervals (1/2: independent). collision_rate: see `Series.rate`. counters: sums over the replicas.
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
    """That of a run of a plain gas in a periodic container. Raises SceneError for any other scene."""
    gas = plain_gas(run.scene)
    count, mass, dimension, time = gas.count, gas.mass, gas.dimension, run.interval
    drift = run.data["velocities"][0].values.astype(float).mean(axis=0)
    energy = float(run.data["kinetic_energy"].mean())
    counters = {name: run.increments(name) for name in COUNTED if name in run.data}
    about_centre = energy - 0.5 * mass * count * (drift @ drift)
    temperature = 2.0 * about_centre / (dimension * (count - 1))
    scale = gas.diameter * math.sqrt(mass / (2.0 * about_centre / (dimension * count)))
    return Series(
        z=1.0 + run.increments("virial_sum") / (dimension * count * temperature * time),
        rate=2.0 * counters["collisions"] / (count * time) * scale,
        interval=time,
        counters=counters,
        speed=math.sqrt(2.0 * energy / (dimension * count * mass)),
    )


def pressure(point: Point) -> Pressure:
    """Z and the collision rate of a periodic point, from all its replicas. See the module for the formula."""
    return combine([series_of(run) for run in runs(point)])


def combine(replicas: list[Series]) -> Pressure:
    """Mean over replicas of equal length; the errors are those of correlated series, in quadrature."""
    means = [correlated_mean(one.z) for one in replicas]
    z = average([mean.estimate for mean in means])
    deviations = [(mean.estimate - z.value).deviation for mean in means]
    return Pressure(
        z=z,
        chi_square=float(np.sum(np.square(deviations))),
        degrees_of_freedom=len(replicas) - 1,
        flat=all(mean.flat for mean in means),
        correlation=max(autocorrelation_time(one.z) for one in replicas),
        collision_rate=average([correlated_mean(one.rate).estimate for one in replicas]),
        counters=totals(replicas),
    )


def totals(replicas: list[Series]) -> dict[str, float]:
    """Sums of the counters over all replicas, by name."""
    return {name: float(sum(one.counters[name].sum() for one in replicas)) for name in replicas[0].counters}
