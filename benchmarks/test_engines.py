"""How fast the engines are: the median of repeated stretches of one run, and the work counted in them."""

import time

import cases
import numpy as np
import pytest

import gaspart as gp

COUNTED = ("collisions", "wall_hits", "pair_tests", "box_visits", "crossings", "steps", "rebuilds")
ROUNDS = 5


def bytes_of(thing, seen=None):
    """Memory of all arrays in an object, each counted once."""
    seen = set() if seen is None else seen
    if id(thing) in seen:
        return 0
    seen.add(id(thing))
    if isinstance(thing, np.ndarray):
        return thing.nbytes if thing.base is None else bytes_of(thing.base, seen)
    if isinstance(thing, dict):
        return sum(bytes_of(part, seen) for part in thing.values())
    if isinstance(thing, (tuple, list)):
        return sum(bytes_of(part, seen) for part in thing)
    return 0


def record(benchmark, case, sim, seconds, stretches):
    """What is written beside the times."""
    tally = sim.tally
    # without what only the face keeps: the state that the run began with
    arrays = {key: value for key, value in vars(sim._dynamics).items() if key != "_reference"}
    benchmark.extra_info.update(
        {name: int(np.sum(getattr(tally, name))) for name in COUNTED},
        engine=case.engine, dimension=case.dimension, count=case.count, feature=case.feature,
        packing_fraction=case.packing_fraction, unit=case.unit, peer=case.peer, peer_value=case.peer_value,
        stretches=stretches, seconds=seconds,
        bytes_per_particle=bytes_of(arrays) / case.count,
    )  # fmt: skip


def timed(benchmark, advance, rounds):
    """Wall-clock seconds of each of some rounds of `advance`."""
    seconds = []

    def once():
        start = time.perf_counter()
        advance()
        seconds.append(time.perf_counter() - start)

    benchmark.pedantic(once, rounds=rounds, warmup_rounds=0)
    return seconds


@pytest.mark.parametrize("case", cases.EVENT, ids=lambda case: case.name)
def test_events(benchmark, case, small):
    case = case.small() if small else case
    sim = gp.Simulation(cases.scene(case), cases.engine(case), seed=1)
    sim.record_events = case.feature == "recording"
    sim.advance(max_events=max(2000, 2 * case.count))  # the lattice melts, kernels are loaded
    sim.reset_tally()
    most = case.count if small else max(300_000, min(500_000, case.count))

    def advance():
        if case.feature == "recording":
            sim.record_events = True  # begins a new record, as one does who empties it
        sim.advance(max_events=most)

    seconds = timed(benchmark, advance, 1 if small else ROUNDS)
    record(benchmark, case, sim, seconds, [sim.tally.collisions / len(seconds)] * len(seconds))
    assert sim.tally.collisions > 0


@pytest.mark.parametrize("case", cases.STEP, ids=lambda case: case.name)
def test_steps(benchmark, case, small):
    case = case.small() if small else case
    engine = cases.engine(case)
    sim = gp.Simulation(cases.scene(case), engine, seed=1)
    steps = 10 if small else max(20, 10_000_000 // case.count)
    sim.advance(duration=(steps + 0.1) * engine.time_step)
    sim.reset_tally()
    seconds = timed(
        benchmark, lambda: sim.advance(duration=(steps + 0.1) * engine.time_step), 1 if small else ROUNDS
    )
    record(benchmark, case, sim, seconds, [1e-9 * case.count * steps] * len(seconds))
    assert sim.tally.steps >= steps
