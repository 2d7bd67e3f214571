"""Cost of a run: counted operations, and measured time.

The number of operations is the same on every machine.

All timings start from the same state. Repeated timings of an engine therefore do exactly the same work, and
differ only by disturbances. Engines with different partitions are timed alternately, in alternating order, so
that a machine that slows down favours none of them. Runs on several cores are timed in wall-clock time,
because CPU time does not distinguish waiting from work.

The planning of a workflow imports this module, so slow imports are made inside functions.
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

A timed run may record all events and discard them, tally the stress, or run as several copies on other cores.
"""
_NONE: Mapping[str, Any] = MappingProxyType({})
COUNTED = ("steps", "collisions", "wall_hits", "pair_tests", "box_visits", "crossings")


def engines(point: Point) -> list[Engine]:
    """Return the timed engines, without the engines of the rival."""
    return point.engines


def arguments(point: Point) -> dict:
    """Return the arguments of `measure_cost`."""
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
    """Return the rival's scene and engines, which are timed alternately with a point's, or None. The rival
    has the point's settings except for the settings in `without`.
    """
    if "without" not in point.settings:
        return None
    settings = {key: value for key, value in point.settings.items() if key not in point.settings["without"]}
    rival = replace(point, settings=settings)
    return {"scene": rival.scene, "engines": rival.engines}


class _Run(NamedTuple):
    """Timed run of an engine from a state of a scene, with some of `EXTRAS`."""

    scene: Scene
    state: State
    engine: Engine
    extras: Mapping[str, Any]

    @property
    def copies(self) -> int:
        """Number of simultaneous runs."""
        return self.extras.get("copies", 1)

    @property
    def cores(self) -> int:
        """Number of cores on which the runs execute."""
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
    """Time an interval of a gas `samples` times, with each of the engines. `equilibration` and `interval`:
    times in the scene's unit. `extras`: a selection of `EXTRAS`, with their values. `rival`: another `scene`
    and `engines`, timed alternately with these and without extras; they are the last partitions. Engines
    without a time step use the scene's default. Returns a dataset over ``partition`` (the engines, in their
    order) and ``repeat``. ``seconds`` and ``wall_seconds`` (partition, repeat) are times of the advance
    alone: CPU time of all threads, and wall-clock time. Times for filling the container, setup and
    compilation are left out. Over ``partition`` are the number of ``cores`` in use, the total number of
    ``boxes``, ``boxes_per_side`` (of the first axis; both are 0 if the engine chooses them), ``duration`` (in
    the scene's time), the counts of the tally, and ``bits``, a digest of the final state and of the sums over
    collisions. Attributes are count, dimension, radius, side (first axis), packing_fraction, engine, search
    (event-driven), model (DSMC) or time_step, extras, and cores, the number that kernels may use on this
    machine. If a run needs more cores than this, all engines run once, for their counts and bits, and all
    times are NaN. Raises SceneError. Raises SimulationError if the counts or the bits of a repeat or a copy
    differ from the first run.
    """
    from numba import config

    # The state is made with the shortest step, because overlaps left by a longer step would cost time with a
    # shorter step.
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
    """Measure CPU and wall-clock time (2, runs, repeats), and the counts of each run. Runs alternate. Raises
    SimulationError if the counts differ between repeats.
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
    """Return the state from which all timings start. No partition or search method changes any bit of this
    state.
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
        # This loads the kernels, and the first step accesses all memory.
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
    """Return the counts of a tally, and a digest of the particles and of the sums. The sums are over
    collisions.
    """
    import numpy as np

    tally, state = dynamics.tally, dynamics.state
    digest = hashlib.sha256(np.array([tally.virial_sum, tally.dissipated_energy]).tobytes())
    for part in (tally.wall_impulse, state.positions, state.velocities, state.spins, state.images):
        digest.update(np.ascontiguousarray(part).tobytes())
    counts = {name: int(np.sum(getattr(tally, name))) for name in COUNTED}
    return {"duration": tally.time, **counts, "bits": digest.hexdigest()}


def _sides(engine: Engine, dimension: int) -> tuple[int, ...]:
    """Return the number of boxes along each axis; 0 if the engine chooses the boxes itself."""
    settings = engine_to_dict(engine)
    if settings.get("search", "boxes") not in ("automatic", "boxes"):
        return (1,) * dimension
    sides = settings.get("boxes_per_side") or 0
    return sides if isinstance(sides, tuple) else (sides,) * dimension
