"""Errors of time stepping: each setting is compared with an exact run from the same state.

The exact run is event-driven.

Both engines start from the same equilibrium snapshot, and run for the same short time, about one collision
per particle. If a step detects every contact, both runs are equal except for rounding. Their difference is
therefore due only to missed, spurious or wrong contacts. Its noise comes from these few contacts, instead of
from all contacts. (In long runs, the noise of 1e8 collisions hides errors of 0.01 %.)

The planning of a workflow imports this module, so slow imports are made inside functions.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from gaspart.engines import EventDriven, TimeStepped
from gaspart.errors import SceneError
from gaspart.keys import Kind, count
from gaspart.reproduction.jobs.data import EQUILIBRATION_KEY, SCAN_TIME_STEPS, SLACK, PointData, intervals

if TYPE_CHECKING:
    from gaspart.engines import Engine
    from gaspart.reproduction.points.point import Point
    from gaspart.scene.scene import Scene
    from gaspart.state.state import State

RESULT = "time-stepped runs beside exact ones from the same states"
KEYS: dict[str, Kind] = {
    "equilibration": EQUILIBRATION_KEY,
    "samples": count(
        "number of initial states, at the ends of the intervals into which the length is divided", default=1
    ),
    "scan_time_steps": SCAN_TIME_STEPS,
}
LEAST_STEPS = 4
"""Minimum number of steps of a run, so that the initial state without overlaps has no effect."""
_LISTED = 0.25  # collisions per particle in the part of a run in which single particles are compared
_LISTED_STEPS = 64  # a longer part adds time but little information


def engines(point: Point) -> list[Engine]:
    """Return the time-stepped engines that are compared with the exact engine."""
    return point.engines


def arguments(point: Point) -> dict:
    """Return the arguments of `compare`."""
    if point.engine.name != "step":
        raise point.make_error("engine", "must be step with job: compare")
    return {"scene": point.scene, "engines": point.engines, "seed": point.seed(), **intervals(point)}


def compare(
    scene: Scene,
    engines: Sequence[TimeStepped],
    seed: tuple[int, ...],
    equilibration: float,
    interval: float,
    samples: int,
) -> PointData:
    """Run the time-stepped `engines` and the event-driven engine from equal states of a gas. There are
    `samples` states at time intervals `interval`. Each run takes one interval, rounded to whole steps, and at
    least `LEAST_STEPS`. `equilibration` and `interval` are in the scene's time. The dimensions of the result
    are ``setting`` (the engines) and ``snapshot``. Both runs have ``collisions``; ``virial``, the sum of
    |dr.dp|; and ``memory``, sum v(0).v(t) / sum v(0)^2. Names of the exact run have the prefix ``exact_``.
    The exact run also has ``z``. The time-stepped run also has the relative ``energy_drift``,
    ``deepest_overlap`` divided by the contact distance, and ``pair_tests``. The first part of a run is
    compared with the list of exact events. ``missed`` counts particles that a step should have changed but
    did not (or too late). ``made_up`` counts particles that a step changed but should not have. ``listed`` is
    the number of events in the list. These are NaN if the part has too many steps. Over ``setting`` are
    ``time_step``, ``steps``, and ``refused``, 1 if the engine rejects the step; then all other values are
    NaN.
    """
    import numpy as np

    from gaspart.simulation import Simulation

    exact = Simulation(scene, EventDriven(), seed=seed)
    exact.advance(duration=equilibration)
    rows: list[list[dict]] = [[] for _ in engines]
    for _ in range(samples):
        state, references = exact.state.copy(), {}
        for row, engine in zip(rows, engines, strict=True):
            steps = max(LEAST_STEPS, round(interval / engine.time_step))
            duration = steps * engine.time_step
            if duration not in references:
                references[duration] = _run(scene, EventDriven(), state, duration)
            row.append(_pair(scene, engine, state, steps, references[duration]))
        exact.advance(duration=interval)
    names = rows[0][0]
    table = {
        name: (("setting", "snapshot"), np.array([[pair[name] for pair in row] for row in rows], dtype=float))
        for name in names
    }
    steps = [max(LEAST_STEPS, round(interval / engine.time_step)) for engine in engines]
    return PointData(
        {
            **table,
            "time_step": ("setting", [engine.time_step for engine in engines]),
            "steps": ("setting", steps),
            "refused": ("setting", [int(np.isnan(row[0]["collisions"])) for row in rows]),
        },
        attributes={
            "count": scene.count,
            "dimension": scene.dimension,
            "radius": scene.largest_radius,
            "packing_fraction": scene.packing_fraction,
            "precision": engines[0].precision,
            "rewind": int(engines[0].rewind),
            "passes": engines[0].passes,
        },
    )


def _run(scene: Scene, engine: Engine, state: State, duration: float) -> dict:
    """Run an engine from a state for a time, and return its results."""
    from gaspart.state.tally import compressibility_factor

    dynamics = engine.start(scene, state)
    dynamics.advance(state.time + duration)
    tally, after = dynamics.tally, dynamics.state
    memory = float((state.velocities * after.velocities).sum() / (state.velocities**2).sum())
    virial, time = tally.virial_sum, tally.time
    return {
        "collisions": tally.collisions,
        "virial": virial,
        "memory": memory,
        "z": float(compressibility_factor(virial, state.count, state.dimension, state.temperature, time)),
        "energy_drift": after.kinetic_energy / state.kinetic_energy - 1.0,
        "deepest_overlap": tally.deepest_overlap,
        "pair_tests": tally.pair_tests,
    }


def _pair(scene: Scene, engine: TimeStepped, state: State, steps: int, exact: dict) -> dict:
    """Compare an engine with the exact run; all values are NaN if it rejects its step."""
    references = {f"exact_{name}": exact[name] for name in ("collisions", "virial", "memory", "z")}
    try:
        stepped = _run(scene, engine, state, (steps + SLACK) * engine.time_step)
        stepped.pop("z")
        return (
            references
            | stepped
            | _missed_contacts(scene, engine, state, steps, exact["collisions"] / state.count)
        )
    except SceneError:
        names = ("collisions", "virial", "memory", "energy_drift", "deepest_overlap", "pair_tests")
        return references | dict.fromkeys((*names, "missed", "made_up", "listed"), math.nan)


def _missed_contacts(scene: Scene, engine: TimeStepped, state: State, steps: int, collisions: float) -> dict:
    """Count particles with missed contacts, and with spurious contacts. A step with a missed contact leaves
    the particle's velocity unchanged, although the exact list has a contact in this step. A step with a
    spurious contact changes the velocity, although the list has none. Only the first such step counts for
    each particle, because later ones may follow from it.
    """
    import numpy as np

    from gaspart.engines.dynamics import EventLog

    steps = max(1, min(steps, round(steps * _LISTED / max(2.0 * collisions, _LISTED))))
    if steps > _LISTED_STEPS:
        return dict.fromkeys(("missed", "made_up", "listed"), math.nan)
    log, exact = EventLog(scene.dimension), EventDriven().start(scene, state)
    exact.advance(state.time + steps * engine.time_step, None, log)
    listed = np.zeros((steps, state.count), dtype=bool)
    step = ((log.events["time"] - state.time) / engine.time_step).astype(int)
    for side in range(2):
        listed[np.minimum(step, steps - 1), log.events["particles"][:, side]] = True
    dynamics, before = engine.start(scene, state), state.velocities.astype(engine.precision)
    differs = np.zeros((steps, state.count), dtype=bool)
    for n in range(steps):
        dynamics.advance(state.time + (n + 1 + SLACK) * engine.time_step)
        after = dynamics.state.velocities
        differs[n] = (after != before).any(axis=1) != listed[n]
        before = after
    first = differs.argmax(axis=0)
    missed = listed[first, np.arange(state.count)]
    wrong = differs.any(axis=0)
    return {
        "missed": int((wrong & missed).sum()),
        "made_up": int((wrong & ~missed).sum()),
        "listed": int(listed.sum()),
    }
