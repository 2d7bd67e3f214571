"""Measurements of extreme scenes, and of reversibility.

The first part runs every scene of a table in every engine and precision. The second part measures the memory
of a gas: growth of echoes, and of the distance of neighbouring runs.
"""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import mean_of
from gaspart.engines import Engine, EventDriven, TimeStepped
from gaspart.errors import SceneError, SimulationError
from gaspart.reproduction.families.stability.rows import ROWS, Row
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table
from gaspart.simulation import ENERGY_DRIFT, Simulation
from gaspart.state.state import State

# Trial of a scene of the table in an engine: drifts, missed contacts, and the verdict.


TRIAL_ENGINES: dict[str, Callable[[Row], Engine]] = {
    "event": lambda row: EventDriven(),
    "event, all pairs": lambda row: EventDriven("pairs"),
    "step": lambda row: TimeStepped(row.time_step),
    "step, float32": lambda row: TimeStepped(row.time_step, precision="float32"),
}
PASSES, REFUSED, FAILS = "passes", "refused", "fails"
OVERLAP = {"event": 1e-9, "step": 0.01}
"""Largest allowed overlap, in contact distances, by engine."""
MISCOUNTED = 0.03
"""Allowed relative error of the number of contacts with time steps, in addition to the statistical error."""
MOST_EVENTS, MOST_TESTS = 10_000_000, 50_000_000
"""Limits at which an event-driven run ends: number of contacts; number of pair tests if all pairs are
searched."""
CHECKS = 8
"""Number of times that a run is checked for overlaps."""


@dataclass(frozen=True)
class Outcome:
    """Outcome of one scene in one engine.

    verdict : the verdict.
    message : message of the rejection or failure.
    energy, momentum : relative drifts (momentum is NaN if walls absorb momentum).
    overlap : deepest observed overlap, in contact distances.
    contacts, missed : number of contacts of particles and walls, and number of missed contacts (negative if
    contacts are spurious).
    seconds : wall-clock time in s.
    bits : digest of the final state.
    """

    verdict: str
    message: str = ""
    energy: float = math.nan
    momentum: float = math.nan
    overlap: float = math.nan
    contacts: int = -1
    missed: int = 0
    seconds: float = math.nan
    bits: bytes = b""


def attempt(row: Row, engine: str, referee: Outcome | None = None) -> Outcome:
    """Run a row of the table in one of `TRIAL_ENGINES`.

    If there is no exact number of contacts, `referee` supplies it.
    """
    start = time.perf_counter()
    try:
        with warnings.catch_warnings():
            # warnings of time steps with errors of several per cent
            warnings.simplefilter("ignore", UserWarning)
            outcome = _run(row, engine, referee)
    except (SceneError, SimulationError) as refusal:
        outcome = {"verdict": REFUSED, "message": str(refusal)}
    return Outcome(**outcome, seconds=time.perf_counter() - start)


def _run(row: Row, engine: str, referee: Outcome | None) -> dict:
    simulation = Simulation(row.scene(), TRIAL_ENGINES[engine](row), seed=1)
    overlap = 0.0
    for check in range(1, CHECKS + 1):
        if not _advance(simulation, row.duration * check / CHECKS):
            return {
                "verdict": FAILS,
                "message": "not at its end after the largest permitted number of contacts",
            }
        overlap = max(overlap, deepest_overlap(simulation.state, simulation.scene.container.periodic))
        simulation.check_invariants()
    tally, state = simulation.tally, simulation.state
    contacts = int(tally.collisions + tally.wall_hits.sum())
    before = simulation.initial_state
    numbers = {
        "energy": energy_drift(before, state, tally.dissipated_energy),
        "momentum": momentum_drift(before, state) if simulation.scene.is_periodic else math.nan,
        "overlap": overlap,
        "contacts": contacts,
        "bits": state.positions.tobytes() + state.velocities.tobytes(),
    }
    expected = row.contacts
    if expected is None and referee is not None and referee.verdict == PASSES:
        expected = referee.contacts
    numbers["missed"] = 0 if expected is None else expected - contacts
    if engine == "event" and row.contacts is None and referee is not None and referee.bits:
        numbers["missed"] = numbers["missed"] or int(numbers["bits"] != referee.bits)
    return {"verdict": PASSES, **numbers} | _faults(row, simulation.engine, numbers, expected)


def _advance(simulation: Simulation, until: float) -> bool:
    """Advance to a time; return True if it was reached within the allowed contacts."""
    if not isinstance(simulation.engine, EventDriven):
        simulation.advance(until=until)
        return True
    all_pairs = simulation.engine.search == "pairs"
    most = MOST_TESTS // max(1, simulation.scene.count) ** 2 if all_pairs else MOST_EVENTS
    simulation.advance(until=until, max_events=most)
    return simulation.time >= until * (1.0 - 1e-12)


def _faults(row: Row, engine: Engine, numbers: dict, expected: int | None) -> dict:
    """Return the verdict if a number shows that the run is incorrect."""
    drift = ENERGY_DRIFT[engine.precision]
    allowed = 0.0
    if row.chaotic and engine.name == "step" and expected:
        allowed = 4.0 * math.sqrt(expected) + MISCOUNTED * expected
    for quantity, measured, most in (
        ("energy", numbers["energy"], drift),
        ("momentum", numbers["momentum"], drift),
        ("overlap", numbers["overlap"], OVERLAP[engine.name]),
        ("missed", abs(numbers["missed"]), allowed),
    ):
        if measured > most or (quantity != "momentum" and math.isnan(measured)):
            return {"verdict": FAILS, "message": f"{quantity} = {measured:g}: more than {most:g}"}
    return {}


def energy_drift(before: State, after: State, dissipated: float) -> float:
    """Compute the drift of the energy relative to the kinetic energy.

    The energy of a fall through the container is added to the kinetic energy.
    """
    scale = max(before.kinetic_energy, after.kinetic_energy)
    if after.gravity is not None:
        scale += float(after.masses.sum() * (abs(after.gravity) @ after.lengths))
    return abs(after.energy + dissipated - before.energy) / (scale or 1.0)


def momentum_drift(before: State, after: State) -> float:
    """Compute the drift of the momentum relative to the sum of the absolute momenta."""
    scale = float((before.masses * before.speeds).sum())
    return float(np.abs(after.momentum - before.momentum).max()) / (scale or 1.0)


def deepest_overlap(state: State, periodic: tuple[bool, ...]) -> float:
    """Compute the deepest overlap of any pair, divided by the contact distance.

    All pairs are searched.
    """
    deepest = 0.0
    for n in range(state.count - 1):
        apart = state.positions[n + 1 :] - state.positions[n]
        apart -= np.where(periodic, state.lengths * np.rint(apart / state.lengths), 0.0)
        sigma = state.radii[n + 1 :] + state.radii[n]
        deepest = max(deepest, float((1.0 - np.sqrt((apart**2).sum(axis=1)) / sigma).max()))
    return deepest


# Work that may hang is done in a separate process, which can be killed.


def run_guarded(work: Callable, items: Sequence, limit: float) -> list:
    """Return `work(item)` for each item, in order, or None.

    An item that takes more than `limit` seconds, or ends its process, has the result None. Compiled code
    cannot be interrupted. Therefore it runs in a child process, which can be killed.
    """
    results: list = []
    context = get_context("fork")
    while len(results) < len(items):
        receiver, sender = context.Pipe(duplex=False)
        child = context.Process(target=_work, args=(sender, work, items[len(results) :]))
        child.start()
        sender.close()
        try:
            while len(results) < len(items) and receiver.poll(limit):
                results.append(receiver.recv())
        except EOFError:  # the child process has ended
            pass
        if len(results) < len(items):
            results.append(None)
        child.kill()
        child.join()
    return results


def _work(sender: Connection, work: Callable, items: Sequence) -> None:
    for item in items:
        sender.send(work(item))


LIMIT = 300.0
"""Time limit of a row, in s; a row that takes longer hangs."""
HANGS = "hangs"
UNITS = {
    "energy": "kinetic energy",
    "momentum": "sum of all |p|",
    "overlap": "contact distance",
    "seconds": "s",
}
_ALL_PAIRS = "event, all pairs"


def stability_extremes(points: list[Point], settings: dict) -> xr.Dataset:
    """Run all rows of the table, or the rows of the groups in the setting `groups`.

    There are no points. Variables over row and engine:

    verdict : "passes", "refused", "fails" or "hangs"
    message : message of the rejection or failure
    energy, momentum, overlap, contacts, missed : see `Outcome`
    seconds : wall-clock time in s
    refusal : 1 if rejection is the expected result

    Over row are `group`, and `expected`, the exact number of contacts; -1 if the search of all pairs is the
    reference.
    """
    groups = settings.get("groups")
    rows = [row for row in ROWS if groups is None or row.group in groups]
    limit = LIMIT * len(TRIAL_ENGINES)
    lost = [Outcome(HANGS, f"not done within {limit:g} s")] * len(TRIAL_ENGINES)
    outcomes = [outcome or lost for outcome in run_guarded(run_row, rows, limit)]
    dataset = table("row", list(zip(rows, outcomes, strict=True)), _columns, inner=("engine",), units=UNITS)
    return dataset.assign_coords(row=[row.name for row in rows], engine=list(TRIAL_ENGINES))


def _columns(of: tuple[Row, list[Outcome]]) -> dict[str, Any]:
    row, outcomes = of
    names = ("verdict", "message", *UNITS, "contacts", "missed")
    return {
        **{name: [getattr(outcome, name) for outcome in outcomes] for name in names},
        "refusal": [engine.startswith(row.refused) for engine in TRIAL_ENGINES],
        "group": row.group,
        "expected": -1 if row.contacts is None else row.contacts,
    }


def run_row(row: Row) -> list[Outcome]:
    """Run a row in each engine; the search of all pairs is first, as the reference."""
    trial = partial(attempt, row)
    referee = trial(_ALL_PAIRS)
    return [referee if engine == _ALL_PAIRS else trial(engine, referee) for engine in TRIAL_ENGINES]


WINDOW = {"float64": (1e-10, 1e-2), "float32": (1e-5, 1e-2)}
"""Distances, in diameters, between which exponential growth is fitted. The upper limit is below saturation;
the lower limit is three decades above the first deviations. Initial deviations have random directions, and
grow faster than the largest exponent until they have turned into the direction of fastest growth. In spheres
at packing fraction 0.001, two runs with the initial distance 1e-10 grow with 1.13(3) times the exponent from
1e-9 on, and with 1.03(4) times from 1e-7 on."""
APART = WINDOW["float64"]
"""Window for the distance between two runs."""
FORGOTTEN = 0.1
"""Distance of the echo from the start, in diameters, at which the memory ends."""


def reversibility(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the growth of the echo per collision, and the memory in collisions.

    The memory is the number of collisions of a particle after which the initial state is forgotten. Points
    are `echo` jobs. Over (``row``, ``sample``) are ``collisions`` (mean) and ``echo`` (median over seeds, in
    diameters).

    Variables over ``row``; the variables from growth to memory have an ``_error`` over seeds:

    dimension, packing_fraction, count, side : gas, with the side in diameters
    engine, precision : engine and its precision
    growth : growth of the logarithm of the echo per collision of a particle
    divergence : growth of the distance of two exact runs, per collision
    exponent : growth in the linearised dynamics; NaN for time steps
    memory : collisions per particle until the echo is `FORGOTTEN`

    `jumps` is the fraction of the echoes that pass from the lower half of the window to beyond the window
    within one interval.
    """
    rows = table("row", points, _row, inner=("sample",))
    return rows.sortby(["dimension", "packing_fraction"])


def _row(point: Point) -> dict:
    """Return the row of one point, with all its seeds."""
    run = xr.load_dataset(point.path)
    window = WINDOW[run.attrs["precision"]]
    collisions, echoes, apart = (run[name].values for name in ("collisions", "echo", "divergence"))
    kept = ("dimension", "count", "side", "engine", "precision")
    return {name: run.attrs[name] for name in kept} | {
        "packing_fraction": round(run.attrs["packing_fraction"], 12),
        "collisions": collisions.mean(axis=0),
        "echo": np.median(echoes, axis=0),
        "jumps": float(np.mean([_jumps(echo, *window) for echo in echoes])),
        "growth": _mean(map(partial(_slope, window), collisions, echoes)),
        "divergence": _mean(map(partial(_slope, APART), collisions, apart)),
        "memory": _mean(map(_memory, collisions, echoes)),
        "exponent": _mean(run.exponent.values),
    }


def _mean(values: Iterable[float]) -> Estimate:
    """Average over the seeds with a finite value; NaN for fewer than two."""
    finite = [value for value in values if np.isfinite(value)]
    return mean_of(finite) if len(finite) > 1 else Estimate(math.nan, math.nan, math.nan)


def _slope(window: tuple[float, float], s: np.ndarray, distance: np.ndarray) -> float:
    """Fit the growth of ln distance with s until it first leaves the window.

    The result is NaN for fewer than three points.
    """
    low, high = window
    out = np.flatnonzero(distance >= high)
    end = out[0] if out.size else distance.size
    inside = np.flatnonzero(distance[:end] > low)
    if inside.size < 3:
        return np.nan
    return float(np.polyfit(s[inside], np.log(distance[inside]), 1)[0])


def _memory(s: np.ndarray, distance: np.ndarray) -> float:
    """Find the number of collisions at which the distance first is `FORGOTTEN`.

    The logarithm is interpolated between samples. The result is NaN if the distance remains smaller.
    """
    out = np.flatnonzero(distance >= FORGOTTEN)
    if not out.size or out[0] == 0:
        return np.nan
    before, after = np.log(distance[out[0] - 1 : out[0] + 1])
    part = (np.log(FORGOTTEN) - before) / (after - before)
    return float(s[out[0] - 1] + part * (s[out[0]] - s[out[0] - 1]))


def _jumps(distance: np.ndarray, low: float, high: float) -> bool:
    """Return True if the distance jumps over the upper half of the window.

    The window is halved on a logarithmic scale.
    """
    out = np.flatnonzero(distance >= high)
    return bool(out.size and out[0] > 0 and distance[out[0] - 1] < np.sqrt(low * high))
