"""The cost of a run: work that is counted, the same on every machine, and time that is measured.

Every timing starts from one and the same state, so the repeated timings of an engine are of exactly the
same work, and differ by what disturbs the clock alone; and engines that differ in their partition are timed
in turn, in alternating order, so that a machine that slows down favours none of them.

Planning reads this module, so slow imports are made inside functions.
"""

from __future__ import annotations

import math
import time
from collections.abc import Collection, Sequence
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

from gaspart.engines import engine_to_dict, reference_engine
from gaspart.errors import SimulationError
from gaspart.keys import COUNT, POSITIVE, TEXT, Kind, count, described, flag, listed
from gaspart.reproduction.jobs.data import PointData
from gaspart.reproduction.jobs.intervals import EQUILIBRATION_KEY, SCAN_TIME_STEPS, SLACK, intervals

if TYPE_CHECKING:
    from gaspart.engines import Engine
    from gaspart.reproduction.points.point import Point
    from gaspart.scene.scene import Scene
    from gaspart.state.state import State

RESULT = "counted work and timings, with nothing running beside them"
KEYS: dict[str, Kind] = {
    "equilibration": EQUILIBRATION_KEY,
    "samples": count(
        "number of timings, each of one of the intervals into which the length is divided", default=1
    ),
    "scan_boxes_per_side": listed(
        COUNT, "numbers of boxes per side that one job times in turn", default=None
    ),
    "scan_boxes_per_particle": listed(
        POSITIVE, "numbers of boxes per particle that one job times in turn", default=None
    ),
    "scan_time_steps": SCAN_TIME_STEPS,
    "scan_step_parts": listed(
        POSITIVE,
        "time steps that one job runs in turn, as parts of the engine's own in the scene",
        default=None,
    ),
    "record_events": flag("record all events; needs an engine that has them", default=False),
    "stress": flag("tally the stress tensor and the heat flux", default=False),
    "without": described(
        {"type": "array", "items": TEXT, "minItems": 1},
        "keys that a second scene and engine lack, which are timed in turn with the point's",
        default=None,
    ),
}
EXTRAS = ("record_events", "stress")
"""Keys of what is done besides: to write down all events, and forget them; to tally the stress."""
COUNTED = ("steps", "collisions", "wall_hits", "pair_tests", "box_visits", "crossings")


def engines(point: Point) -> list[Engine]:
    """The engines that are timed, but for those of the rival."""
    return point.engines


def arguments(point: Point) -> dict:
    """The arguments of `measure_cost`. Raises SceneError."""
    extras = [key for key in EXTRAS if point.settings.get(key)]
    if "record_events" in extras and not point.engine.records_events:
        raise point.refused("record_events", "has a meaning with job: measure_cost and engine: event only")
    if "stress" in extras:
        from gaspart.state.optional_tallies import StressTally  # which loads numpy

        point.engine.check_tally(StressTally(), point.scene)
    return {
        "scene": point.scene,
        "engines": point.engines,
        "seed": point.seed(),
        **intervals(point),
        "extras": extras,
        "rival": _rival(point),
    }


def _rival(point: Point) -> dict | None:
    """The scene and engines that are timed in turn with those of a point: the point's without the settings
    that `without` lists; None if there are none."""
    if "without" not in point.settings:
        return None
    settings = {key: value for key, value in point.settings.items() if key not in point.settings["without"]}
    rival = replace(point, settings=settings)
    return {"scene": rival.scene, "engines": rival.engines}


def measure_cost(
    scene: Scene,
    engines: Sequence[Engine],
    seed: tuple[int, ...],
    equilibration: float,
    interval: float,
    samples: int,
    extras: Collection[str] = (),
    rival: dict[str, Any] | None = None,
) -> PointData:
    """Time `samples` times, with each of the engines, the same interval of simulated time of the same gas.

    equilibration, interval: in the scene's time; extras: of `EXTRAS`; rival: another `scene` and `engines`,
    timed in turn with these and without extras: the last partitions.
    Engines without a step of their own take that of the scene.
    Returns a dataset over ``partition`` (the engines, in their order) and ``repeat``: ``seconds``
    (partition, repeat), processor time of the advance alone (filling the container, setting up and compiling
    are left out); over ``partition``: ``boxes`` in all, ``boxes_per_side`` (of the first axis; both 0 if the
    engine chooses itself), ``duration`` (scene's time) and the counts of the tally. Attributes: count,
    dimension, radius, side (first axis), packing_fraction, engine, search (event-driven), model (DSMC) or
    time_step, extras.

    Raises SceneError, and SimulationError if the counted work of a repeat differs from the first one's.
    """
    # By the shortest step: a longer one leaves overlaps, which would count against a shorter one.
    careful = min(engines, key=lambda engine: engine.quantum or 0.0)
    runs = []
    for made, chosen, also in [
        (scene, engines, extras),
        *([(rival["scene"], rival["engines"], ())] if rival else []),
    ]:
        start = _start(made, careful, seed, equilibration)
        runs += [(made, start, engine.resolved(made), also) for engine in chosen]
    seconds = [[0.0] * samples for _ in runs]
    counts: list[dict] = [{}] * len(runs)
    for repeat in range(samples):
        order = range(len(runs))
        for n in order if repeat % 2 == 0 else reversed(order):
            seconds[n][repeat], counted = _timed(*runs[n], interval)
            if not counts[n]:
                counts[n] = counted
            elif counted != counts[n]:
                raise SimulationError(f"the same run twice: counted {counts[n]}, then {counted}")
    columns = {name: ("partition", [counted[name] for counted in counts]) for name in counts[0]}
    sides = [_sides(engine, made.dimension) for made, _, engine, _ in runs]
    return PointData(
        {
            "seconds": (("partition", "repeat"), seconds, {"units": "s"}),
            "boxes": ("partition", [math.prod(side) for side in sides]),
            "boxes_per_side": ("partition", [side[0] for side in sides]),
            **columns,
        },
        attributes={**_attributes(scene, engines[0]), "extras": " ".join(extras)},
    )


def _attributes(scene: Scene, engine: Engine) -> dict:
    """The attributes of a dataset: the gas, and the first engine."""
    settings = engine_to_dict(engine)
    return {
        "count": scene.count,
        "dimension": scene.dimension,
        "radius": scene.largest_radius,
        "side": scene.container.lengths[0],
        "packing_fraction": scene.packing_fraction,
        "engine": engine.name,
        **{key: settings.get(key, "") for key in ("search", "model")},
        "time_step": engine.resolved(scene).quantum or 0.0,
    }


def _start(scene: Scene, engine: Engine, seed: tuple[int, ...], equilibration: float) -> State:
    """The state from which everything is timed. No partition or search changes a bit of it."""
    from gaspart.simulation import Simulation
    from gaspart.state.initial import initial_state

    if equilibration <= 0.0:
        return initial_state(scene, seed)
    usual = {item.name: item.default for item in fields(engine) if item.name in engine.neutral_settings}
    quick = replace(engine, **usual) if engine.equation == "exact" else reference_engine()
    simulation = Simulation(scene, quick, seed=seed)
    simulation.advance(duration=equilibration)
    return simulation.state.copy()


def _timed(
    scene: Scene, state: State, engine: Engine, extras: Collection[str], interval: float
) -> tuple[float, dict]:
    """Processor time of one interval, in s, and what was counted in it."""
    import numpy as np

    from gaspart.engines.event_log import EventLog
    from gaspart.state.optional_tallies import StressTally

    dynamics = engine.start(scene, state, tallies=[StressTally()] if "stress" in extras else [])
    log = EventLog(scene.dimension, scene.rough) if "record_events" in extras else None
    step = engine.quantum or 0.0
    # This loads the kernels, and the first step touches all memory.
    dynamics.advance(state.time + step * (1 + SLACK), log=log)
    dynamics.reset_tally()
    target = dynamics.time + interval + step * SLACK
    start = time.process_time()
    dynamics.advance(target, log=log)
    seconds = time.process_time() - start
    tally = dynamics.tally
    counted = {name: int(np.sum(getattr(tally, name))) for name in COUNTED}
    return seconds, {"duration": tally.time, **counted}


def _sides(engine: Engine, dimension: int) -> tuple[int, ...]:
    """Boxes along each axis; zeros if the engine chooses them itself."""
    settings = engine_to_dict(engine)
    if settings.get("search", "boxes") not in ("automatic", "boxes"):
        return (1,) * dimension
    given = settings.get("boxes_per_side") or 0
    return given if isinstance(given, tuple) else (given,) * dimension
