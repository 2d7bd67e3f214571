"""Engine and schedule of a point of a grid.

Planning a workflow reads every point of every grid, so slow imports are made inside functions.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from gaspart import engines as known_engines
from gaspart.engines.engine import required
from gaspart.errors import SceneError
from gaspart.reproduction.points.keys import ENGINES, LENGTHS, SCANS
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.points.point_scene import check_scene, extents, scene
from gaspart.scene.validation import LARGEST, SMALLEST

if TYPE_CHECKING:
    from gaspart.engines import Engine

_MOST_INTERVALS = 2.0**53  # above, float64 does not distinguish their numbers


@dataclass(frozen=True)
class Schedule:
    """When a run is sampled, in the scene's time; the first ``equilibration_frames`` frames are dropped."""

    duration: float
    sample_interval: float
    equilibration_frames: int
    samples: int

    @property
    def equilibration(self) -> float:
        """The time before the measurement."""
        return self.equilibration_frames * self.sample_interval


def check_run(point: Point) -> None:
    """Refuse settings of an engine and a length that contradict each other, with SceneError; the cheap part,
    without a scene."""
    settings, where = point.settings, f"experiments.{point.experiment}"
    check_scene(point)
    engine = settings.get("engine", "event")
    kind = known_engines.ENGINES[engine]
    for key in required(kind):
        if key not in settings:
            raise SceneError(f"{where}.{key}", None, f"must be given with engine: {engine}")
    for key in {key: None for keys in ENGINES.values() for key in keys}:
        if key in settings and key not in ENGINES[engine]:
            raise SceneError(f"{where}.{key}", settings[key], f"has no meaning with engine: {engine}")
    if "boxes_per_side" in settings and "boxes_per_body" in settings:
        raise SceneError(f"{where}.boxes_per_body", settings["boxes_per_body"], "excludes boxes_per_side")
    lengths = [key for key in LENGTHS if key in settings]
    if len(lengths) != 1:
        raise SceneError(where, lengths, f"exactly one of {', '.join(LENGTHS)} must be given")
    if lengths == ["steps"] and "time_step" not in settings:
        raise SceneError(f"{where}.steps", settings["steps"], f"has no meaning with engine: {engine}")


def engine(point: Point) -> Engine:
    """The point's engine. Raises SceneError."""
    check_run(point)
    name = point.settings.get("engine", "event")
    chosen = {key: point.settings[key] for key in ENGINES[name] if key in point.settings}
    count, radius, lengths = extents(point)
    if "boxes_per_body" in chosen:
        chosen["boxes_per_side"] = boxes_per_side(chosen.pop("boxes_per_body"), count, radius, lengths)
    given = chosen.get("boxes_per_side", 1)
    sides = tuple(given) if isinstance(given, (list, tuple)) else (given,) * len(lengths)
    if len(sides) != len(lengths):
        raise SceneError("boxes_per_side", given, "must be one number, or one per axis")
    for length, boxes in zip(lengths, sides, strict=True):
        if boxes > 1 and length / boxes < 2.0 * radius:  # found before any job starts
            rule = f"boxes must not be narrower than the largest diameter, {2.0 * radius:g}"
            raise SceneError("boxes_per_side", given, rule)
    return known_engines.ENGINES[name](**chosen)


def engines(point: Point) -> list:
    """The engines that a ``measure_cost`` or ``compare`` job runs in turn: the point's own, or one for each
    value of its scan (``scan_boxes_per_side``, ``scan_boxes_per_body`` or ``scan_time_steps``; the same
    partition is timed once).

    Raises SceneError.
    """
    settings = point.settings
    given = [key for key in SCANS if key in settings]
    if not given:
        return [engine(point)]
    where = f"experiments.{point.experiment}.{given[0]}"
    if given == ["scan_time_steps"]:
        own: Any = engine(point)
        if own.quantum is None:
            raise SceneError(where, settings[given[0]], f"has no meaning with engine: {own.name}")
        return [replace(own, time_step=step) for step in settings[given[0]]]
    if len(given) > 1 or "boxes_per_side" in settings or "boxes_per_body" in settings:
        raise SceneError(where, settings[given[0]], "a scan excludes every other choice of boxes")
    if not settings[given[0]]:
        raise SceneError(where, settings[given[0]], "must not be empty")
    partitions = settings[given[0]]
    if given[0] == "scan_boxes_per_body":
        partitions = [boxes_per_side(per_body, *extents(point)) for per_body in partitions]
    own = engine(replace(point, settings={**settings, "boxes_per_side": 1}))
    return [replace(own, boxes_per_side=partition) for partition in dict.fromkeys(partitions)]


def boxes_per_side(per_body: float, count: int, radius: float, lengths: tuple[float, ...]) -> tuple[int, ...]:
    """(d,) boxes per axis: nearly cubic ones, ``per_body`` for each particle, none smaller than a
    diameter."""
    edge = (math.prod(lengths) / (per_body * count)) ** (1.0 / len(lengths))
    return tuple(max(1, min(round(length / edge), int(length / (2.0 * radius)))) for length in lengths)


def schedule(point: Point) -> Schedule:
    """Duration and sampling of a point's runs, in the scene's time.

    The length is divided into ``samples`` intervals (whole time steps with the step engine); the
    equilibration, rounded up to complete intervals, precedes it.
    """
    check_run(point)
    settings, where = point.settings, f"experiments.{point.experiment}"
    unit = next(key for key in LENGTHS if key in settings)
    scale = _unit_of_time(point, unit)
    samples = settings.get("samples", 1)
    interval = settings[unit] * scale / samples
    if not SMALLEST <= interval <= LARGEST:
        rule = f"makes a sample interval of {interval:g}, which must be from {SMALLEST:g} to {LARGEST:g}"
        raise SceneError(f"{where}.{unit}", settings[unit], rule)
    if "time_step" in settings:
        step = settings["time_step"]
        interval = step * max(1, round(interval / step))
    before = settings.get("equilibration", 0) * scale / interval
    if not before < _MOST_INTERVALS:
        rule = f"makes {before:g} sample intervals, which must be less than {_MOST_INTERVALS:g}"
        raise SceneError(f"{where}.equilibration", settings["equilibration"], rule)
    dropped = math.ceil(before * (1.0 - 1e-12))
    return Schedule(interval * (dropped + samples), interval, dropped, samples)


def _unit_of_time(point: Point, unit: str) -> float:
    """The scene's time in one ``unit`` of length; for collisions per particle, from Enskog's rate."""
    if unit == "duration":
        return 1.0
    if unit == "steps":
        return point.settings["time_step"]
    from gaspart import theory

    key, given = f"experiments.{point.experiment}.collisions_per_body", point.settings[unit]
    gas = scene(point).gas
    if gas is None:
        rule = "is known only for one species of smooth particles without gravity or obstacles; give duration"
        raise SceneError(key, given, rule)
    if not gas.temperature > 0.0:
        raise SceneError(key, given, "needs a temperature or a speed above zero")
    try:
        rate = theory.collision_rate(**gas.parameters)
    except ValueError as error:
        raise SceneError(key, given, f"cannot be turned into a time: {error}") from None
    if not 0.0 < rate < math.inf:
        raise SceneError(key, given, f"cannot be turned into a time: the collision rate is {rate:g}")
    return 1.0 / float(rate)
