"""The engines of a point."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from gaspart import engines
from gaspart.engines.engine import required
from gaspart.errors import SceneError
from gaspart.reproduction.points.point_keys import ENGINE_KEYS, SCANS

if TYPE_CHECKING:
    from gaspart.engines import Engine
    from gaspart.reproduction.points.point import Point


def engine(point: Point) -> Engine:
    """The engine that the settings describe. Raises SceneError."""
    return _made(point, point.settings)


def scanned(point: Point) -> list[Engine]:
    """The engine of a point, or, with a scan, one for each of its time steps or partitions; equal partitions
    are taken once. Parts of a step are of the one that the engine has in the scene. Raises SceneError."""
    settings = point.settings
    scans = [key for key in SCANS if key in settings]
    if not scans:
        return [point.engine]
    scan, values = scans[0], settings[scans[0]]
    if scans == ["scan_time_steps"]:
        single: Any = point.engine
        if single.quantum is None:
            raise point.refused(scan, f"has no meaning with engine: {single.name}")
        return [single.with_step(step) for step in values]
    if scans == ["scan_step_parts"]:
        whole: Any = point.engine.resolved(point.scene)
        if whole.quantum is None:
            raise point.refused(scan, f"has no meaning with engine: {whole.name}")
        return [whole.with_step(part * whole.time_step) for part in values]
    if len(scans) > 1 or "boxes_per_side" in settings or "boxes_per_particle" in settings:
        raise point.refused(scan, "a scan excludes every other choice of boxes")
    if not values:
        raise point.refused(scan, "must not be empty")
    if scan == "scan_boxes_per_particle":
        values = [boxes_per_side(per_particle, *point.extents) for per_particle in values]
    single = _made(point, {**settings, "boxes_per_side": 1})
    return [replace(single, boxes_per_side=partition) for partition in dict.fromkeys(values)]


def boxes_per_side(
    per_particle: float, count: int, radius: float, lengths: tuple[float, ...]
) -> tuple[int, ...]:
    """(d,) boxes per axis: nearly cubic ones, ``per_particle`` for each particle, none smaller than a
    diameter."""
    edge = (math.prod(lengths) / (per_particle * count)) ** (1.0 / len(lengths))
    return tuple(max(1, min(round(length / edge), int(length / (2.0 * radius)))) for length in lengths)


def _made(point: Point, settings: dict) -> Engine:
    """The engine of some settings, with the particles and the container of a point."""
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
        if boxes > 1 and length / boxes < 2.0 * radius:  # found before any job starts
            rule = f"boxes must not be narrower than the largest diameter, {2.0 * radius:g}"
            raise SceneError("boxes_per_side", partition, rule)
    return engines.ENGINES[name](**fields)


def _check(point: Point, name: str, settings: dict) -> None:
    """Refuse keys that the engine lacks or does not know."""
    for key in required(engines.ENGINES[name]):
        if key not in settings:
            raise point.refused(key, f"must be given with engine: {name}")
    for key in {key: None for keys in ENGINE_KEYS.values() for key in keys}:
        if key in settings and key not in ENGINE_KEYS[name]:
            raise point.refused(key, f"has no meaning with engine: {name}")
    if "boxes_per_side" in settings and "boxes_per_particle" in settings:
        raise point.refused("boxes_per_particle", "excludes boxes_per_side")
