"""The cost of a config in core-hours, predicted from the measured speeds."""

from __future__ import annotations

import math
from dataclasses import replace

from gaspart import theory
from gaspart.accuracy import speed, table
from gaspart.reproduction.config import checked
from gaspart.reproduction.points.point import Point
from gaspart.scene.gas import Gas


def predict(path: str) -> list[str]:
    """Lines with the core-hours of each experiment of a config, and of all, on this machine.

    A config beside `config.yaml` is merged over that, as in the workflow. Raises SceneError.
    """
    lines, total, unknown = [], 0.0, []
    with checked(path) as (_, planned):
        for experiment, points in planned.items():
            costs = [_seconds(point) for point in points.values()]
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
    """Processor time of a point's simulations, from the theoretical number of contacts; None where it is
    unknown."""
    if point.job != "simulate":
        return None
    gas = point.scene.gas
    if gas is None or not gas.temperature > 0.0:
        return None
    engine = point.engine
    # Where discs or spheres freeze, the pressure is constant, and the number of contacts nearly so.
    densest = theory.HIGHEST_PACKING_FRACTION[gas.dimension]
    fluid = replace(gas, packing_fraction=min(gas.packing_fraction, densest))
    rate = float(theory.collision_rate(**fluid.parameters))
    contacts = 0.5 * gas.count * rate * point.schedule.duration * point.replicas
    step, fine = engine.timed_step(point.scene), 1.0
    known = [
        made for precision, made in table.steps(gas.dimension, engine.timed_as) if precision == "float64"
    ]
    nearest = step if not step else min(known, key=lambda one: abs(math.log(one / step)), default=step)
    if step and nearest > step:  # shorter steps than any in the table cost in proportion to their number
        fine = nearest / step
    each = fine * table.seconds(gas.dimension, gas.packing_fraction, engine.timed_as, "float64", nearest)
    return contacts * each * _speed(gas, engine.timed_as, "float64") if math.isfinite(each) else None


def _speed(gas: Gas, engine: str, precision: str) -> float:
    """Relative speed at the nearest power of ten of the number of particles, so that few sizes are timed."""
    return speed.factor(gas.dimension, engine, precision, 10 ** round(math.log10(max(gas.count, 10))))
