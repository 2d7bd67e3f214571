"""Cost of a run: work that is counted, and time that is measured.

The work is the same on every machine.

Every timing starts from one and the same state, so the repeated timings of an engine are of exactly the same
work, and differ by disturbances of the clock alone; and engines that differ in their partition are timed
alternately, in alternating order, so that a machine that slows down favours none of them. Runs on several
cores are timed in wall-clock time: CPU time does not distinguish waiting from work.

Planning reads this module, so slow imports are made inside functions.
"""

from __future__ import annotations

import hashlib
import math
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from gaspart.engines import engine_to_dict, reference_engine
from gaspart.errors import SimulationError
from gaspart.keys import COUNT, POSITIVE, TEXT, Kind, count, describe, flag, list_of
from gaspart.reproduction.jobs.data import EQUILIBRATION_KEY, SCAN_TIME_STEPS, SLACK, PointData, intervals
from gaspart.state.tally import StressTally

if TYPE_CHECKING:
    import numpy as np

    from gaspart.engines import Engine
    from gaspart.engines.dynamics import Dynamics
    from gaspart.reproduction.points.point import Point
    from gaspart.scene.scene import Scene
    from gaspart.state.state import State

RESULT = "counted work and timings, with nothing running beside them"
KEYS: dict[str, Kind] = {
    "equilibration": EQUILIBRATION_KEY,
    "samples": count(
        "number of timings, each of one of the intervals into which the length is divided", default=1
    ),
    "scan_boxes_per_side": list_of(
        COUNT, "numbers of boxes per side that one job times in turn", default=None
    ),
    "scan_boxes_per_particle": list_of(
        POSITIVE, "numbers of boxes per particle that one job times in turn", default=None
    ),
    "scan_time_steps": SCAN_TIME_STEPS,
    "scan_step_parts": list_of(
        POSITIVE,
        "time steps that one job runs in turn, as parts of the engine's own in the scene",
        default=None,
    ),
    "record_events": flag("record all events; needs an engine that has them", default=False),
    "stress": flag("tally the stress tensor and the heat flux", default=False),
    "copies": count("equal runs at once, each in a thread of its own; times are those of all", default=1),
    "without": describe(
        {"type": "array", "items": TEXT, "minItems": 1},
        "keys that a second scene and engine lack, which are timed in turn with the point's",
        default=None,
    ),
}
EXTRAS = ("record_events", "stress", "copies")
"""Keys of additional work.

It is to write down all events, and forget them; to tally the stress; to do the same on other cores at once.
"""
_NONE: Mapping[str, Any] = MappingProxyType({})
COUNTED = ("steps", "collisions", "wall_hits", "pair_tests", "box_visits", "crossings")


def engines(point: Point) -> list[Engine]:
    """Return the engines that are timed, without those for the rival."""
    return point.engines


def arguments(point: Point) -> dict:
    """Return the arguments of `measure_cost`; raise SceneError."""
    extras = {key: point.settings[key] for key in EXTRAS if point.settings.get(key)}
    if "record_events" in extras and not point.engine.records_events:
        raise point.make_error("record_events", "has a meaning with job: measure_cost and engine: event only")
    if extras.get("copies", 1) > 1 and point.settings.get("threads", 1) > 1:
        raise point.make_error("copies", "are of runs with one thread each")
    if "stress" in extras:
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
    """Return the scene and engines that are timed alternately with a point's, or None.

    They are the point's without the settings that `without` lists.
    """
    if "without" not in point.settings:
        return None
    settings = {key: value for key, value in point.settings.items() if key not in point.settings["without"]}
    rival = replace(point, settings=settings)
    return {"scene": rival.scene, "engines": rival.engines}


class _Run(NamedTuple):
    """Timed run of an engine with some of `EXTRAS`, from a state of a scene."""

    scene: Scene
    state: State
    engine: Engine
    extras: Mapping[str, Any]

    @property
    def copies(self) -> int:
        """Number of runs that advance at once."""
        return self.extras.get("copies", 1)

    @property
    def cores(self) -> int:
        """On how many cores they run."""
        return self.copies * engine_to_dict(self.engine).get("threads", 1)


def measure_cost(
    scene: Scene,
    engines: Sequence[Engine],
    seed: tuple[int, ...],
    equilibration: float,
    interval: float,
    samples: int,
    extras: Mapping[str, Any] = _NONE,
    rival: dict[str, Any] | None = None,
) -> PointData:
    """Time an interval of one gas `samples` times, with each of the engines.

    equilibration, interval : in the scene's time.
    extras : some of `EXTRAS`, with their values.
    rival : another `scene` and `engines`, timed alternately with these and without extras: the last
        partitions. Engines without a step of their own take the scene's.

    Returns a dataset over ``partition`` (the engines, in their order) and ``repeat``: ``seconds`` and
    ``wall_seconds`` (partition, repeat), CPU time of all threads and wall-clock time of the advance alone
    (filling the container, setting up and compiling are left out); over ``partition``: ``cores`` used,
    ``boxes`` in all, ``boxes_per_side`` (of the first axis; both 0 if the engine chooses itself),
    ``duration`` (scene's time), the counts of the tally, and ``bits``, a digest of the final state and of the
    sums over collisions. Attributes: count, dimension, radius, side (first axis), packing_fraction, engine,
    search (event-driven), model (DSMC) or time_step, extras, and cores, the number that kernels may use here.
    Where a run would need more of them, all run once, for their counts and bits, and all times are NaN.

    Raises SceneError, and SimulationError if the counted work or the bits of a repeat, or of a copy, differ
    from the first one's.
    """
    from numba import config

    # By the shortest step: a longer one leaves overlaps, which would count against a shorter one.
    careful = min(engines, key=lambda engine: engine.quantum or 0.0)
    start = _start(scene, careful, seed, equilibration)
    runs = [_Run(scene, start, engine.for_scene(scene), extras) for engine in engines]
    if rival:
        rival_scene = rival["scene"]
        other = start if rival_scene == scene else _start(rival_scene, careful, seed, equilibration)
        runs += [
            _Run(rival_scene, other, rival_engine.for_scene(rival_scene), _NONE)
            for rival_engine in rival["engines"]
        ]
    available = config.NUMBA_NUM_THREADS
    possible = max(run.cores for run in runs) <= available
    times, counts = _in_turn(runs, interval, samples if possible else 1)
    processor, wall = times if possible else times * math.nan
    columns = {name: ("partition", [counted[name] for counted in counts]) for name in counts[0]}
    sides = [_sides(run.engine, run.scene.dimension) for run in runs]
    return PointData(
        {
            "seconds": (("partition", "repeat"), processor, {"units": "s"}),
            "wall_seconds": (("partition", "repeat"), wall, {"units": "s"}),
            "cores": ("partition", [run.cores for run in runs]),
            "boxes": ("partition", [math.prod(side) for side in sides]),
            "boxes_per_side": ("partition", [side[0] for side in sides]),
            **columns,
        },
        attributes={**_attributes(scene, engines[0]), "extras": " ".join(extras), "cores": available},
    )


def _in_turn(runs: Sequence[_Run], interval: float, repeats: int) -> tuple[np.ndarray, list[dict]]:
    """Measure CPU time and wall-clock time (2, runs, repeats), and the counts of each run.

    Raises SimulationError if the counts differ between repeats.
    """
    import numpy as np

    times = np.empty((2, len(runs), repeats))
    counts: list[dict] = [{}] * len(runs)
    for repeat in range(repeats):
        order = range(len(runs))
        for n in order if repeat % 2 == 0 else reversed(order):
            times[:, n, repeat], counted = _time(runs[n], interval)
            if not counts[n]:
                counts[n] = counted
            elif counted != counts[n]:
                raise SimulationError(f"the same run twice: counted {counts[n]}, then {counted}")
    return times, counts


def _attributes(scene: Scene, engine: Engine) -> dict:
    """Return the attributes of a dataset: the gas, and the first engine."""
    settings = engine_to_dict(engine)
    return {
        "count": scene.count,
        "dimension": scene.dimension,
        "radius": scene.largest_radius,
        "side": scene.container.lengths[0],
        "packing_fraction": scene.packing_fraction,
        "engine": engine.name,
        **{key: settings.get(key, "") for key in ("search", "model")},
        "time_step": engine.for_scene(scene).quantum or 0.0,
    }


def _start(scene: Scene, engine: Engine, seed: tuple[int, ...], equilibration: float) -> State:
    """Return the state from which everything is timed.

    No partition or search changes a bit of it.
    """
    from gaspart.simulation import Simulation
    from gaspart.state.initial import initial_state

    if equilibration <= 0.0:
        return initial_state(scene, seed)
    usual = {item.name: item.default for item in fields(engine) if item.name in engine.neutral_settings}
    quick = replace(engine, **usual) if engine.equation == "exact" else reference_engine()
    simulation = Simulation(scene, quick, seed=seed)
    simulation.advance(duration=equilibration)
    return simulation.state.copy()


def _time(run: _Run, interval: float) -> tuple[tuple[float, float], dict]:
    """Measure CPU time and wall-clock time of one interval, in s, and its counts."""
    from gaspart.engines.dynamics import EventLog

    scene, engine = run.scene, run.engine
    step = engine.quantum or 0.0
    copies = []
    for _ in range(run.copies):
        dynamics = engine.start(scene, run.state, tallies=[StressTally()] if "stress" in run.extras else [])
        log = EventLog(scene.dimension, scene.rough) if "record_events" in run.extras else None
        # This loads the kernels, and the first step touches all memory.
        dynamics.advance(run.state.time + step * (1 + SLACK), log=log)
        dynamics.reset_tally()
        copies.append((dynamics, dynamics.time + interval + step * SLACK, log))
    with ThreadPoolExecutor(run.copies) as pool:
        wall, processor = time.perf_counter(), time.process_time()
        others = [pool.submit(dynamics.advance, until, log=log) for dynamics, until, log in copies[1:]]
        dynamics, until, log = copies[0]
        dynamics.advance(until, log=log)
        for other in others:
            other.result()
        processor, wall = time.process_time() - processor, time.perf_counter() - wall
    counted, *beside = (_count(dynamics) for dynamics, *_ in copies)
    for other in beside:
        if other != counted:
            raise SimulationError(f"the same run twice at once: counted {counted}, and {other}")
    return (processor, wall), counted


def _count(dynamics: Dynamics) -> dict:
    """Return the counts of a tally, and a digest of the particles and of the sums.

    The sums are over collisions.
    """
    import numpy as np

    tally, state = dynamics.tally, dynamics.state
    digest = hashlib.sha256(np.array([tally.virial_sum, tally.dissipated_energy]).tobytes())
    for part in (tally.wall_impulse, state.positions, state.velocities, state.spins, state.images):
        digest.update(np.ascontiguousarray(part).tobytes())
    counts = {name: int(np.sum(getattr(tally, name))) for name in COUNTED}
    return {"duration": tally.time, **counts, "bits": digest.hexdigest()}


def _sides(engine: Engine, dimension: int) -> tuple[int, ...]:
    """Return boxes along each axis; zeros if the engine chooses them itself."""
    settings = engine_to_dict(engine)
    if settings.get("search", "boxes") not in ("automatic", "boxes"):
        return (1,) * dimension
    sides = settings.get("boxes_per_side") or 0
    return sides if isinstance(sides, tuple) else (sides,) * dimension
