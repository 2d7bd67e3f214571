"""Engines and schedule of a point."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from gaspart import engines
from gaspart.engines.engine import required_settings
from gaspart.errors import SceneError
from gaspart.keys.values import LARGEST, SMALLEST
from gaspart.reproduction.jobs.data import DIVIDED
from gaspart.reproduction.points import point_keys
from gaspart.reproduction.points.point_keys import ENGINE_KEYS, LENGTHS, SCANS

if TYPE_CHECKING:
    from gaspart.engines import Engine
    from gaspart.reproduction.points.point import Point
    from gaspart.scene.facts import Mixture
    from gaspart.scene.scene import Scene


def engine(point: Point) -> Engine:
    """Return the engine with the settings of a point."""
    return _made(point, point.settings)


def scan_engines(point: Point) -> list[Engine]:
    """Return the engine of a point, or an engine for each value of its scan. Scans are over time steps or
    partitions. If several values of the scan give the same partition, only one engine has it. A fractional
    step is a fraction of the engine's default step for the scene.
    """
    settings = point.settings
    scans = [key for key in SCANS if key in settings]
    if not scans:
        return [point.engine]
    scan, values = scans[0], settings[scans[0]]
    if scans == ["scan_time_steps"]:
        single: Any = point.engine
        if single.quantum is None:
            raise point.make_error(scan, f"has no meaning with engine: {single.name}")
        return [single.with_step(step) for step in values]
    if scans == ["scan_step_parts"]:
        resolved: Any = point.engine.for_scene(point.scene)
        if resolved.quantum is None:
            raise point.make_error(scan, f"has no meaning with engine: {resolved.name}")
        return [resolved.with_step(part * resolved.time_step) for part in values]
    if len(scans) > 1 or "boxes_per_side" in settings or "boxes_per_particle" in settings:
        raise point.make_error(scan, "a scan excludes every other choice of boxes")
    if not values:
        raise point.make_error(scan, "must not be empty")
    if scan == "scan_boxes_per_particle":
        values = [boxes_per_side(per_particle, *point.extents) for per_particle in values]
    single = _made(point, {**settings, "boxes_per_side": 1})
    return [replace(single, boxes_per_side=partition) for partition in dict.fromkeys(values)]


def boxes_per_side(
    per_particle: float, count: int, radius: float, lengths: tuple[float, ...]
) -> tuple[int, ...]:
    """Return the number of boxes along each axis (d,), with ``per_particle`` boxes per particle. Boxes are
    nearly cubic, and not smaller than a diameter.
    """
    edge = (math.prod(lengths) / (per_particle * count)) ** (1.0 / len(lengths))
    return tuple(max(1, min(round(length / edge), int(length / (2.0 * radius)))) for length in lengths)


def _made(point: Point, settings: dict) -> Engine:
    """Return the engine with given settings, for the particles and the container of a point."""
    name = settings.get("engine", "event")
    _check(point, name, settings)
    fields = {key: settings[key] for key in ENGINE_KEYS[name] if key in settings}
    count, radius, lengths = point.extents
    if "boxes_per_particle" in fields:
        fields["boxes_per_side"] = boxes_per_side(fields.pop("boxes_per_particle"), count, radius, lengths)
    partition = fields.get("boxes_per_side", 1)
    sides = tuple(partition) if isinstance(partition, (list, tuple)) else (partition,) * len(lengths)
    if len(sides) != len(lengths):
        raise SceneError("boxes_per_side", partition, "must be one number, or one per axis")
    for length, boxes in zip(lengths, sides, strict=True):
        if boxes > 1 and length / boxes < 2.0 * radius:  # errors are found before any job starts
            rule = f"boxes must not be narrower than the largest diameter, {2.0 * radius:g}"
            raise SceneError("boxes_per_side", partition, rule)
    return engines.ENGINES[name](**fields)


def _check(point: Point, name: str, settings: dict) -> None:
    """Raise SceneError for required keys that are missing, and for unknown keys."""
    for key in required_settings(engines.ENGINES[name]):
        if key not in settings:
            raise point.make_error(key, f"must be given with engine: {name}")
    for key in {key: None for keys in ENGINE_KEYS.values() for key in keys}:
        if key in settings and key not in ENGINE_KEYS[name]:
            raise point.make_error(key, f"has no meaning with engine: {name}")
    if "boxes_per_side" in settings and "boxes_per_particle" in settings:
        raise point.make_error("boxes_per_particle", "excludes boxes_per_side")


# The engine that `engine: auto` of a config selects.


def chosen(settings: dict, scene: Scene, where: str) -> dict:
    """Return the settings of a point with `engine: auto`, with the selected engine. The choice is made for
    the machine of the table, so that a config has the same meaning everywhere. A length is set only if the
    point has no length.
    """
    from gaspart.accuracy.advisers import adviser_of
    from gaspart.accuracy.plan import plan_from_table
    from gaspart.accuracy.table import EQUILIBRATION

    if "accuracy" not in settings:
        raise SceneError(f"{where}.accuracy", None, "is required with engine: auto")
    observable, accuracy = settings.get("observable", "Z"), settings["accuracy"]
    try:
        advice = plan_from_table(scene, observable, accuracy)
    except SceneError as error:
        raise error.inside(where) from None
    merged = {key: value for key, value in settings.items() if key not in point_keys.ENGINE_KEYS["auto"]}
    engine = advice.best.engine
    merged["engine"] = engine.name
    merged |= {name: getattr(engine, name) for name in adviser_of(engine).advised}
    if not point_keys.LENGTHS.keys() & settings.keys():
        merged["collisions_per_particle"] = math.ceil(advice.collisions_per_particle)
        merged.setdefault("replicas", advice.replicas)
        merged.setdefault("equilibration", EQUILIBRATION)
    return merged


# Duration and sampling of a point's runs. The planning of a workflow processes every point of every grid, so
# slow imports are made inside functions.


_MOST_INTERVALS = 2.0**53  # for larger numbers, float64 does not distinguish them
_SIZES = 64  # sizes of a polydisperse gas for the estimate of its collision rate


@dataclass(frozen=True)
class Schedule:
    """Schedule of the samples of a run, in the scene's time. The first ``equilibration_frames`` frames are
    discarded. `samples_per_frame` is set if the run correlates more samples than it stores frames.
    """

    duration: float
    sample_interval: float
    equilibration_frames: int
    samples: int
    samples_per_frame: int = 1

    @property
    def equilibration(self) -> float:
        """Time before the measurement."""
        return self.equilibration_frames * self.sample_interval


def schedule(point: Point) -> Schedule:
    """Return duration and sampling of a point's runs, in the scene's time. The length is divided into
    ``samples`` intervals. With the step engine, an interval has a whole number of time steps. The
    equilibration, rounded up to complete intervals, precedes it. If ``frames`` is set, the intervals are the
    intervals between frames.
    """
    settings = point.settings
    lengths = [key for key in LENGTHS if key in settings]
    if len(lengths) != 1:
        rule = f"exactly one of {', '.join(LENGTHS)} must be given"
        raise SceneError(f"experiments.{point.experiment}", lengths, rule)
    (unit,) = lengths
    scale = _unit_of_time(point, unit)
    samples = settings.get("samples", 1)
    interval = settings[unit] * scale / settings.get(DIVIDED, samples)
    if not SMALLEST <= interval <= LARGEST:
        rule = f"makes a sample interval of {interval:g}, which must be from {SMALLEST:g} to {LARGEST:g}"
        raise point.make_error(unit, rule)
    if "time_step" in settings:
        step = settings["time_step"]
        interval = step * max(1, round(interval / step))
    before = settings.get("equilibration", 0) * scale / interval
    if not before < _MOST_INTERVALS:
        rule = f"makes {before:g} sample intervals, which must be less than {_MOST_INTERVALS:g}"
        raise point.make_error("equilibration", rule)
    each, rest = divmod(samples, settings.get("frames", samples))
    if rest:
        raise point.make_error("frames", f"must be a divisor of samples, {samples}")
    dropped = each * math.ceil(before / each * (1.0 - 1e-12))
    return Schedule(interval * (dropped + samples), interval, dropped, samples, each)


def _unit_of_time(point: Point, unit: str) -> float:
    """Return the scene's time for a ``unit`` of length. For collisions per particle it is computed from
    Enskog's rate.
    """
    if unit == "duration":
        return 1.0
    if unit == "steps":
        if "time_step" not in point.settings:
            raise point.make_error(unit, f"has no meaning with engine: {point.engine.name}")
        return point.settings["time_step"]
    from gaspart import theory

    key, value = f"experiments.{point.experiment}.collisions_per_particle", point.settings[unit]
    gas, mixture = point.scene.gas, point.scene.mixture
    if mixture is None:
        rule = "is known only for smooth particles without gravity or obstacles; give duration"
        raise SceneError(key, value, rule)
    if not mixture.temperature > 0.0:
        raise SceneError(key, value, "needs a temperature or a speed above zero")
    try:
        rate = theory.collision_rate(**gas.parameters) if gas else _mean_rate(mixture)
    except ValueError as error:
        raise SceneError(key, value, f"cannot be turned into a time: {error}") from None
    if not 0.0 < rate < math.inf:
        raise SceneError(key, value, f"cannot be turned into a time: the collision rate is {rate:g}")
    return 1.0 / float(rate)


def _mean_rate(mixture: Mixture) -> float:
    """Compute the mean collision rate of the particles. If there are many sizes, a sample of them is used."""
    from gaspart import theory

    few = mixture.thin(_SIZES)
    rates = theory.mixture_collision_rates(*few.sizes, temperature=few.temperature, masses=few.masses)
    # a matrix product by BLAS would depend on the processor
    return math.fsum(rates.sum(axis=1) * few.counts) / sum(few.counts)
