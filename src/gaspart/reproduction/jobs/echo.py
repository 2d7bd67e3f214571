"""Loschmidt's echo: a gas is run, all velocities are reversed, and it is run back.

The distance of the final state from the initial state is measured.

Exact mechanics would return to the initial state. Rounding errors grow by exp(lambda) with every collision of
a particle, in both directions. Therefore the distance shows how long the memory of the initial state lasts.
Its growth rate is the largest Lyapunov exponent. The linearised dynamics of the same gas determine this
exponent without rounding errors.

The planning of a workflow imports this module, so slow imports are made inside functions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from gaspart.engines import EventDriven
from gaspart.keys import Kind, count
from gaspart.reproduction.jobs.data import EQUILIBRATION_KEY, SLACK, PointData, intervals

if TYPE_CHECKING:
    from gaspart.engines import Engine
    from gaspart.reproduction.points.point import Point
    from gaspart.scene.scene import Scene
    from gaspart.simulation import Simulation
    from gaspart.state.state import State

RESULT = "runs forward and back"
KEYS: dict[str, Kind] = {
    "equilibration": EQUILIBRATION_KEY,
    "samples": count(
        "number of echoes, after 1, 2 ... of the intervals into which the length is divided", default=1
    ),
}
DISPLACEMENT = 1e-13
"""Root-mean-square displacement, in diameters, with which the divergence of the exact dynamics is measured.
"""
TANGENT_COLLISIONS = 100.0
"""Collisions per particle for the exponent of the linearised dynamics, for each seed."""


def engines(point: Point) -> list[Engine]:
    """Return the engine that runs forward and back."""
    return [point.engine]


def arguments(point: Point) -> dict:
    """Return the arguments of `echo`."""
    return {"scene": point.scene, "engine": point.engine, "seeds": point.seeds, **intervals(point)}


def echo(
    scene: Scene,
    engine: Engine,
    seeds: Sequence[tuple[int, ...]],
    equilibration: float,
    interval: float,
    samples: int,
) -> PointData:
    """Measure echoes from equilibrium states of a scene, one for each seed. The results over ``seed`` and
    ``sample`` are for runs of 1 to `samples` intervals. ``collisions`` is the number of collisions per
    particle before the reversal: twice the number of contacts divided by the number of particles. ``echo`` is
    the root-mean-square distance from the initial state after the return, in diameters. ``divergence`` is the
    distance at the reversal between two event-driven runs whose initial distance is `DISPLACEMENT`. Over
    ``seed``: ``exponent`` is the largest Lyapunov exponent per collision of a particle, for the event-driven
    engine, and NaN for other engines. Attributes describe the gas (`side` in diameters) and the engine.
    """
    import numpy as np

    from gaspart.simulation import Simulation

    shape = (len(seeds), samples)
    columns = {name: np.empty(shape) for name in ("collisions", "echo", "divergence")}
    exponents = np.full(len(seeds), np.nan)
    slack = SLACK * (engine.quantum or 0.0)
    for n, seed in enumerate(seeds):
        equilibrium = Simulation(scene, EventDriven(), seed=seed)
        equilibrium.advance(duration=equilibration)
        state = equilibrium.state.copy()
        there = engine.start(scene, state)
        start = there.state  # rounded to the engine's precision
        pair = [EventDriven().start(scene, initial) for initial in (state, _displace(state, seed))]
        for k in range(samples):
            time = (k + 1) * interval
            there.advance(state.time + time + slack)
            reversed_state = replace(there.state, time=0.0, velocities=-there.state.velocities)
            back = engine.start(scene, reversed_state)
            back.advance(time + slack)
            for run in pair:
                run.advance(state.time + time)
            columns["collisions"][n, k] = 2.0 * there.tally.collisions / state.count
            columns["echo"][n, k] = _distance(start, back.state)
            columns["divergence"][n, k] = _distance(pair[0].state, pair[1].state)
        if engine.reference:
            exponents[n] = _exponent(equilibrium, samples * interval)
    return PointData(
        {
            **{name: (("seed", "sample"), values) for name, values in columns.items()},
            "exponent": ("seed", exponents),
        },
        attributes={
            "count": scene.count,
            "dimension": scene.dimension,
            "side": max(scene.container.lengths) / (2.0 * scene.largest_radius),
            "packing_fraction": scene.packing_fraction,
            "engine": engine.name,
            "precision": engine.precision,
            "time_step": engine.quantum or 0.0,
        },
    )


def _exponent(equilibrium: Simulation, interval: float) -> float:
    """Measure the Lyapunov exponent of a run that is continued until `TANGENT_COLLISIONS`. The run is
    continued by intervals of time.
    """
    from gaspart.analysis.lyapunov import lyapunov_exponent  # this loads xarray, which other jobs do not need

    equilibrium.reset_tally()
    equilibrium.record_events = True
    count = equilibrium.scene.count
    while 2.0 * equilibrium.tally.collisions < TANGENT_COLLISIONS * count:
        equilibrium.advance(duration=interval)
    tally = equilibrium.tally
    return float(lyapunov_exponent(equilibrium).estimate) * count * tally.time / (2.0 * tally.collisions)


def _displace(state: State, seed: tuple[int, ...]) -> State:
    """Return a state in which all particles are displaced at random. The displacement is so small that only
    touching particles can overlap.
    """
    import numpy as np

    away = np.random.default_rng(seed).standard_normal(state.positions.shape)
    away *= DISPLACEMENT * 2.0 * state.radii.max() / np.sqrt((away**2).sum(axis=1).mean())
    inside = np.clip(state.positions + away, state.radii[:, None], state.lengths - state.radii[:, None])
    return replace(state, positions=inside)


def _distance(state: State, other: State) -> float:
    """Compute the root-mean-square distance between two states, in diameters. Positions are between walls,
    and not periodic.
    """
    import numpy as np

    apart = ((state.positions - other.positions) ** 2).sum(axis=1)
    return float(np.sqrt(apart.mean()) / (2.0 * state.radii.max()))
