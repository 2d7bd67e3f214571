"""From a config to the points of its grids, and from a point to what is to be run.

Planning a workflow reads every point of every grid, so nothing heavy is imported here before it is needed.

An *experiment* of the config holds ``point`` (defaults) and ``grid`` (a mapping from a key to the list of
its values, whose product is taken, or a list of such mappings, which are concatenated). A key that is null
counts as absent, so that a config merged over another can take a key back.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from importlib import import_module
from typing import TYPE_CHECKING, Any

from gaspart.errors import SceneError
from gaspart.point import Point, name_of
from gaspart.point_scene import check_scene, extents, scene
from gaspart.validation import LARGEST, SMALLEST

if TYPE_CHECKING:
    from gaspart.engines import EventDriven, TimeStepped
    from gaspart.matter import Species
    from gaspart.scene import Scene

LENGTHS = ("collisions_per_body", "duration", "steps")
ENGINE_KEYS = {
    "event": ("search", "boxes_per_side", "boxes_per_body"),
    "step": (
        "time_step",
        "boxes_per_side",
        "boxes_per_body",
        "near_boxes",
        "precision",
        "rewind",
        "passes",
        "skin",
        "threads",
    ),
}
WHOLE = ("dimension", "count", "samples", "steps", "attempts", "follow", "replicas", "passes", "threads")
"""Keys of whole numbers, which may be written 1e3."""
MOST_POINTS = 100_000
SCANS = ("scan_boxes_per_side", "scan_boxes_per_body", "scan_time_steps")


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
        """The time before the measured stretch."""
        return self.equilibration_frames * self.sample_interval


def points(config: dict, experiment: str) -> list[Point]:
    """All points of an experiment. Raises SceneError for an empty grid, or two points of one name."""
    block = config["experiments"][experiment]
    where = f"experiments.{experiment}"
    found: dict[str, Point] = {}
    varied = block.get("grid")
    for varying in _combinations({} if varied is None else varied, f"{where}.grid"):
        settings = {**block.get("point", {}), **varying}
        point = _chosen(
            Point(
                experiment=experiment,
                name=name_of(varying, f"{where}.grid"),
                job=block.get("job", "simulate"),
                settings={key: _plain(key, value) for key, value in settings.items() if value is not None},
                root=config.get("points", "results/points"),
                config_seed=config["seed"],
            )
        )
        if point.name in found:
            raise SceneError(f"{where}.grid", point.name, "every point of a grid must be different")
        found[point.name] = point
    return list(found.values())


def _plain(key: str, value: Any) -> Any:
    whole = key in WHOLE and isinstance(value, float) and value.is_integer()
    return int(value) if whole else value


def _chosen(point: Point) -> Point:
    """With the engine that `engine: auto` stands for. Raises SceneError."""
    where = f"experiments.{point.experiment}"
    if point.settings.get("engine") == "auto":
        # By name: only planning needs it, and what measures points, which have their engine then, does not
        # depend on the table.
        chosen = import_module("gaspart.tradeoff.grids").chosen
        return replace(point, settings=chosen(point.settings, scene(point), where))
    for key in ("accuracy", "observable"):
        if key in point.settings:
            raise SceneError(f"{where}.{key}", point.settings[key], "needs engine: auto")
    return point


def figure_points(config: dict, figure: str) -> list[Point]:
    """The points of all experiments that a figure names, in its order."""
    chosen = []
    for experiment in config["figures"][figure]["experiments"]:
        if experiment not in config["experiments"]:
            raise SceneError(f"figures.{figure}.experiments", experiment, "must be the name of an experiment")
        chosen += points(config, experiment)
    return chosen


def check(point: Point) -> None:
    """Refuse settings that contradict each other, with SceneError; the cheap part, needing no scene."""
    settings, where = point.settings, f"experiments.{point.experiment}"
    check_scene(point)
    if point.job == "fill":
        if "attempts" not in settings:
            raise SceneError(f"{where}.attempts", None, "is required with job: fill")
        return
    if point.job == "pack":
        if ("attempts" in settings) == (settings.get("arrangement") == "compressed"):
            rule = "is required with job: pack, unless the arrangement is compressed"
            raise SceneError(f"{where}.attempts", settings.get("attempts"), rule)
        return
    engine = settings.get("engine", "event")
    if engine == "step" and "time_step" not in settings:
        raise SceneError(f"{where}.time_step", None, "must be given with engine: step")
    for key in set().union(*ENGINE_KEYS.values()) - set(ENGINE_KEYS[engine]):
        if key in settings:
            raise SceneError(f"{where}.{key}", settings[key], f"has no meaning with engine: {engine}")
    if settings.get("record_events") and (point.job, engine) != ("measure_cost", "event"):
        rule = "has a meaning with job: measure_cost and engine: event only"
        raise SceneError(f"{where}.record_events", True, rule)
    if point.job == "compare" and engine != "step":
        raise SceneError(f"{where}.engine", engine, "must be step with job: compare")
    if "boxes_per_side" in settings and "boxes_per_body" in settings:
        raise SceneError(f"{where}.boxes_per_body", settings["boxes_per_body"], "excludes boxes_per_side")
    lengths = [key for key in LENGTHS if key in settings]
    if len(lengths) != 1:
        raise SceneError(where, lengths, f"exactly one of {', '.join(LENGTHS)} must be given")
    if lengths == ["steps"] and engine != "step":
        raise SceneError(f"{where}.steps", settings["steps"], f"has no meaning with engine: {engine}")


def engine(point: Point) -> EventDriven | TimeStepped:
    """The point's engine: ``EventDriven`` or ``TimeStepped``. Raises SceneError."""
    from gaspart.engines import EventDriven, TimeStepped

    check(point)
    name = point.settings.get("engine", "event")
    chosen = {key: point.settings[key] for key in ENGINE_KEYS[name] if key in point.settings}
    if isinstance(chosen.get("boxes_per_side"), list):
        chosen["boxes_per_side"] = tuple(chosen["boxes_per_side"])
    count, radius, lengths = extents(point)
    if "boxes_per_body" in chosen:
        chosen["boxes_per_side"] = boxes_per_side(chosen.pop("boxes_per_body"), count, radius, lengths)
    given = chosen.get("boxes_per_side", 1)
    sides = given if isinstance(given, tuple) else (given,) * len(lengths)
    if len(sides) != len(lengths):
        raise SceneError("boxes_per_side", given, "must be one number, or one per axis")
    for length, boxes in zip(lengths, sides, strict=True):
        if boxes > 1 and length / boxes < 2.0 * radius:  # told here already, before any job starts
            rule = f"boxes must not be narrower than the largest diameter, {2.0 * radius:g}"
            raise SceneError("boxes_per_side", given, rule)
    return EventDriven(**chosen) if name == "event" else TimeStepped(**chosen)


def engines(point: Point) -> list:
    """The engines that a ``measure_cost`` or ``compare`` job runs in turn: the point's own, or one for each
    value of its scan (``scan_boxes_per_side``, ``scan_boxes_per_body`` or ``scan_time_steps``; the same
    partition is timed once).

    Raises SceneError.
    """
    own, settings = engine(point), point.settings
    given = [key for key in SCANS if key in settings]
    if not given:
        return [own]
    where = f"experiments.{point.experiment}.{given[0]}"
    if given == ["scan_time_steps"]:
        if own.name != "step":
            raise SceneError(where, settings[given[0]], "has no meaning with engine: event")
        return [replace(own, time_step=step) for step in settings[given[0]]]
    if len(given) > 1 or "boxes_per_side" in settings or "boxes_per_body" in settings:
        raise SceneError(where, settings[given[0]], "a scan excludes every other choice of boxes")
    if not settings[given[0]]:
        raise SceneError(where, settings[given[0]], "must not be empty")
    partitions = settings[given[0]]
    if given[0] == "scan_boxes_per_body":
        partitions = [boxes_per_side(per_body, *extents(point)) for per_body in partitions]
    return [replace(own, boxes_per_side=partition) for partition in dict.fromkeys(partitions)]


def boxes_per_side(per_body: float, count: int, radius: float, lengths: tuple[float, ...]) -> tuple[int, ...]:
    """(d,) boxes per axis: nearly cubic ones, ``per_body`` for each body, none smaller than a diameter."""
    edge = (math.prod(lengths) / (per_body * count)) ** (1.0 / len(lengths))
    return tuple(max(1, min(round(length / edge), int(length / (2.0 * radius)))) for length in lengths)


def schedule(point: Point) -> Schedule:
    """Duration and sampling of a point's runs, whatever unit its length is given in.

    The length is divided into ``samples`` intervals (whole time steps with the step engine); the
    equilibration, rounded up to whole intervals, goes before it.
    """
    check(point)
    settings, where = point.settings, f"experiments.{point.experiment}"
    unit = next(key for key in LENGTHS if key in settings)
    scale = _unit_of_time(point, unit)
    samples = settings.get("samples", 1)
    interval = settings[unit] * scale / samples
    if not SMALLEST <= interval <= LARGEST:
        rule = f"makes a sample interval of {interval:g}, which must be from {SMALLEST:g} to {LARGEST:g}"
        raise SceneError(f"{where}.{unit}", settings[unit], rule)
    if settings.get("engine") == "step":
        step = settings["time_step"]
        interval = step * max(1, round(interval / step))
    before = settings.get("equilibration", 0) * scale / interval
    if not before < _MOST_INTERVALS:
        rule = f"makes {before:g} sample intervals, which must be less than {_MOST_INTERVALS:g}"
        raise SceneError(f"{where}.equilibration", settings["equilibration"], rule)
    dropped = math.ceil(before * (1.0 - 1e-12))
    return Schedule(interval * (dropped + samples), interval, dropped, samples)


def recipe(point: Point) -> dict:
    """All that the point's job needs, in plain values: what its result depends on, and nothing else."""
    check(point)
    made = {
        "scene": scene(point).to_dict(),
        "seeds": [list(point.seed(k)) for k in range(point.replicas)],
    }
    if point.job == "fill":
        return {**made, "attempts": point.settings["attempts"]}
    if point.job == "pack":
        return {**made, "attempts": point.settings.get("attempts")}
    from gaspart.engines import engine_to_dict

    times = schedule(point)
    follow, count = point.settings.get("follow"), extents(point)[0]
    if follow is not None and follow > count:
        raise SceneError(f"experiments.{point.experiment}.follow", follow, f"there are {count} bodies")
    if point.job in ("measure_cost", "compare"):
        recording = (
            {"record": point.settings.get("record_events", False)} if point.job == "measure_cost" else {}
        )
        return {
            **made,
            **recording,
            "engines": [engine_to_dict(chosen) for chosen in engines(point)],
            "equilibration": times.equilibration,
            "stretch": times.sample_interval,
            "repeats": times.samples,
        }
    if point.job == "echo":
        return {
            **made,
            "engine": engine_to_dict(engine(point)),
            "equilibration": times.equilibration,
            "interval": times.sample_interval,
            "samples": times.samples,
        }
    return {
        **made,
        "engine": engine_to_dict(engine(point)),
        "duration": times.duration,
        "sample_interval": times.sample_interval,
        "displacements": point.settings.get("displacements", False),
        "follow": follow,
    }


def _unit_of_time(point: Point, unit: str) -> float:
    """The scene's time in one ``unit`` of length; for collisions per body, from Enskog's rate."""
    if unit == "duration":
        return 1.0
    if unit == "steps":
        return point.settings["time_step"]
    from gaspart import theory

    key, given = f"experiments.{point.experiment}.collisions_per_body", point.settings[unit]
    kind = _only_species(scene(point))
    if kind is None:
        rule = "is known for one species of smooth bodies alone, without gravity or obstacles; give duration"
        raise SceneError(key, given, rule)
    count, radius, lengths = extents(point)
    dimension = len(lengths)
    temperature = kind.temperature
    if temperature is None:
        temperature = kind.mass * (kind.speed or 0.0) ** 2 / dimension
    if not temperature > 0.0:
        raise SceneError(key, given, "needs a temperature or a speed above zero")
    ball = (math.pi if dimension == 2 else 4.0 / 3.0 * math.pi) * radius**dimension
    fraction = count * ball / math.prod(lengths)
    try:
        rate = theory.collision_rate(fraction, dimension, 2.0 * radius, temperature, kind.mass)
    except ValueError as error:
        raise SceneError(key, given, f"cannot be turned into a time: {error}") from None
    if not 0.0 < rate < math.inf:
        raise SceneError(key, given, f"cannot be turned into a time: the collision rate is {rate:g}")
    return 1.0 / float(rate)


def _only_species(made: Scene) -> Species | None:
    """The species of a scene that holds nothing else; None if there is more to it."""
    from gaspart.scene import Scene

    kinds = made.species
    plain = Scene(made.container, kinds, centres_to_walls=made.centres_to_walls)
    return kinds[0] if len(kinds) == 1 and not kinds[0].fixed and made == plain else None


def _combinations(grid: Any, where: str) -> list[dict]:
    """The product of a mapping's lists; of a list of mappings, one after the other."""
    if isinstance(grid, list):
        if not grid:
            raise SceneError(where, grid, "must not be empty")
        return [combination for block in grid for combination in _combinations(block, where)]
    axes = {key: values if isinstance(values, list) else [values] for key, values in grid.items()}
    for key, values in axes.items():
        if not values:
            raise SceneError(f"{where}.{key}", values, "must not be empty")
    count = math.prod(map(len, axes.values()))
    if count > MOST_POINTS:
        raise SceneError(where, count, f"a grid may have {MOST_POINTS} points")
    return [dict(zip(axes, chosen, strict=True)) for chosen in itertools.product(*axes.values())]
