"""Duration and sampling of a point's runs.

Planning a workflow reads every point of every grid, so slow imports are made inside functions.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gaspart.errors import SceneError
from gaspart.keys.values import LARGEST, SMALLEST
from gaspart.reproduction.points.point_keys import LENGTHS

if TYPE_CHECKING:
    from gaspart.reproduction.points.point import Point
    from gaspart.scene.gas import Mixture

_MOST_INTERVALS = 2.0**53  # above, float64 does not distinguish their numbers
_SIZES = 64  # of a polydisperse gas, by which its collision rate is estimated


@dataclass(frozen=True)
class Schedule:
    """When a run is sampled, in the scene's time; the first ``equilibration_frames`` frames are dropped.

    samples_per_frame: where the run correlates more samples than it keeps frames.
    """

    duration: float
    sample_interval: float
    equilibration_frames: int
    samples: int
    samples_per_frame: int = 1

    @property
    def equilibration(self) -> float:
        """The time before the measurement."""
        return self.equilibration_frames * self.sample_interval


def schedule(point: Point) -> Schedule:
    """Duration and sampling of a point's runs, in the scene's time.

    The length is divided into ``samples`` intervals (whole time steps with the step engine); the
    equilibration, rounded up to complete intervals, precedes it, with ``frames`` to those between frames.
    """
    settings = point.settings
    lengths = [key for key in LENGTHS if key in settings]
    if len(lengths) != 1:
        rule = f"exactly one of {', '.join(LENGTHS)} must be given"
        raise SceneError(f"experiments.{point.experiment}", lengths, rule)
    (unit,) = lengths
    scale = _unit_of_time(point, unit)
    samples = settings.get("samples", 1)
    interval = settings[unit] * scale / samples
    if not SMALLEST <= interval <= LARGEST:
        rule = f"makes a sample interval of {interval:g}, which must be from {SMALLEST:g} to {LARGEST:g}"
        raise point.refused(unit, rule)
    if "time_step" in settings:
        step = settings["time_step"]
        interval = step * max(1, round(interval / step))
    before = settings.get("equilibration", 0) * scale / interval
    if not before < _MOST_INTERVALS:
        rule = f"makes {before:g} sample intervals, which must be less than {_MOST_INTERVALS:g}"
        raise point.refused("equilibration", rule)
    each, rest = divmod(samples, settings.get("frames", samples))
    if rest:
        raise point.refused("frames", f"must be a divisor of samples, {samples}")
    dropped = each * math.ceil(before / each * (1.0 - 1e-12))
    return Schedule(interval * (dropped + samples), interval, dropped, samples, each)


def _unit_of_time(point: Point, unit: str) -> float:
    """The scene's time in one ``unit`` of length; for collisions per particle, from Enskog's rate."""
    if unit == "duration":
        return 1.0
    if unit == "steps":
        if "time_step" not in point.settings:
            raise point.refused(unit, f"has no meaning with engine: {point.engine.name}")
        return point.settings["time_step"]
    from gaspart import theory

    key, given = f"experiments.{point.experiment}.collisions_per_particle", point.settings[unit]
    gas, mixture = point.scene.gas, point.scene.mixture
    if mixture is None:
        rule = "is known only for smooth particles without gravity or obstacles; give duration"
        raise SceneError(key, given, rule)
    if not mixture.temperature > 0.0:
        raise SceneError(key, given, "needs a temperature or a speed above zero")
    try:
        rate = theory.collision_rate(**gas.parameters) if gas else _mean_rate(mixture)
    except ValueError as error:
        raise SceneError(key, given, f"cannot be turned into a time: {error}") from None
    if not 0.0 < rate < math.inf:
        raise SceneError(key, given, f"cannot be turned into a time: the collision rate is {rate:g}")
    return 1.0 / float(rate)


def _mean_rate(mixture: Mixture) -> float:
    """The mean collision rate of its particles; of many sizes by a part of them."""
    from gaspart import theory

    few = mixture.thinned(_SIZES)
    rates = theory.mixture_collision_rates(*few.sizes, temperature=few.temperature, masses=few.masses)
    return math.fsum(rates.sum(axis=1) * few.counts) / sum(few.counts)  # by BLAS it depends on the processor
