"""Advice for whole grids: `engine: auto` of a config, and what a config costs."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from gaspart import theory
from gaspart.errors import SceneError
from gaspart.tradeoff import speed, table

if TYPE_CHECKING:
    from gaspart.point import Point
    from gaspart.scene import Scene
    from gaspart.tradeoff.advice import Gas

WANTED = ("accuracy", "observable")
"""Keys of a point that go with `engine: auto`."""


def chosen(settings: dict, scene: Scene, where: str) -> dict:
    """The settings of a point with `engine: auto`, with those of the engine that it stands for.

    The choice is that of the table's machine, so that a config means the same everywhere. A length is set
    only if none is given. Raises SceneError.
    """
    from gaspart.tradeoff.advice import SETTLING, advise

    if "accuracy" not in settings:
        raise SceneError(f"{where}.accuracy", None, "is required with engine: auto")
    try:
        found = advise(
            scene, settings.get("observable", "Z"), settings["accuracy"], speed_of=speed.as_measured
        )
    except SceneError as error:
        raise error.inside(where) from None
    engine = found.setting.engine
    made = {key: value for key, value in settings.items() if key not in WANTED} | {"engine": engine.name}
    if engine.name == "step":
        made |= {"time_step": engine.time_step, "precision": engine.precision}
    if not {"collisions_per_body", "duration", "steps"} & set(settings):
        made["collisions_per_body"] = math.ceil(found.collisions_per_body)
        made.setdefault("replicas", found.replicas)
        made.setdefault("equilibration", SETTLING)
    return made


def predict(path: str) -> list[str]:
    """Lines that tell the core-hours of each experiment of a config, and of all, on this machine.

    A config beside `config.yaml` is laid over that, as the workflow does. Raises SceneError.
    """
    from gaspart import grid
    from gaspart.config import checked

    lines, total, unknown = [], 0.0, []
    with checked(path) as config:
        for experiment in config["experiments"]:
            costs = [_seconds(point) for point in grid.points(config, experiment)]
            known = [seconds for seconds in costs if seconds is not None]
            if len(known) < len(costs):
                unknown.append(experiment)
                continue
            total += sum(known)
            lines.append(f"{experiment:28s} {sum(known) / 3600.0:10.4f} core-hours")
    lines.append(f"{'all of them':28s} {total / 3600.0:10.4f} core-hours")
    if unknown:
        rule = "not predicted (other jobs, or scenes whose collisions no theory counts)"
        lines.append(f"{rule}: {', '.join(unknown)}")
    return lines


def _seconds(point: Point) -> float | None:
    """Processor time of a point's simulations, from theory's contacts; None where neither is known."""
    from gaspart import grid
    from gaspart.tradeoff.advice import plain_gas

    if point.job != "simulate":
        return None
    scene = grid.scene(point)
    try:
        gas = plain_gas(scene)
    except SceneError:
        return None
    engine = grid.engine(point)
    # Where discs or spheres freeze, the pressure stays as it is: so nearly does the number of contacts.
    densest = theory.HIGHEST_PACKING_FRACTION[gas.dimension]
    fluid = replace(gas, packing_fraction=min(gas.packing_fraction, densest))
    contacts = 0.5 * gas.count * fluid.collision_rate * grid.schedule(point).duration * point.replicas
    if engine.name == "event":
        each = table.seconds(gas.dimension, gas.packing_fraction, "event")
        return contacts * each * _speed(gas, "event", "float64")
    step = engine.time_step * gas.thermal_speed / gas.diameter
    known = [made for precision, made in table.steps(gas.dimension) if precision == "float64"]
    nearest = min(known, key=lambda one: abs(math.log(one / step)))
    each = table.seconds(gas.dimension, gas.packing_fraction, "step", "float64", nearest)
    # Shorter steps than any in the table cost in proportion to their number.
    return (
        contacts * each * max(1.0, nearest / step) * _speed(gas, "step", "float64")
        if math.isfinite(each)
        else None
    )


def _speed(gas: Gas, engine: str, precision: str) -> float:
    """By powers of ten of the number of bodies, so that few sizes are timed."""
    return speed.factor(gas.dimension, engine, precision, 10 ** round(math.log10(max(gas.count, 10))))
