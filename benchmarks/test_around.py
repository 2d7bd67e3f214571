"""What a user waits for beside the engines: a job's start, random insertion, a trajectory's writing."""

import os
import subprocess
import sys
import time

import cases

import gaspart as gp
from gaspart.state.initial import initial_state

START = """
from gaspart.kernels.compile.cache import load_numba
load_numba(ours=True)
import gaspart as gp
scene = gp.Scene(gp.Container((20.0, 20.0)), [gp.Species(10, 0.5, speed=1.0)])
gp.Simulation(scene, gp.EventDriven(), seed=1).advance(max_events=10)
"""


def record(benchmark, name, unit, **rest):
    benchmark.extra_info.update(engine=name, unit=unit, **rest)


def test_a_job_starts(benchmark, small):
    """A new process: interpreter, imports from bytecode, kernels from their cache, a first event."""
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}

    def start():
        subprocess.run([sys.executable, "-c", START], env=environment, check=True)

    start()  # fills the caches
    benchmark.pedantic(start, rounds=1 if small else 7)
    record(benchmark, "start of a job", "s")


def test_random_insertion(benchmark, small):
    """A million spheres at a packing fraction of 0.3."""
    case = cases.Case("event", 3, cases.SMALL if small else 1_000_000, 0.3)
    kind = gp.Species(case.count, 0.5, temperature=1.0)
    scene = gp.Scene(cases.scene(case).container, [kind])
    initial_state(gp.Scene(scene.container, [gp.Species(10, 0.5, temperature=1.0)]), seed=1)
    benchmark.pedantic(lambda: initial_state(scene, seed=1), rounds=1)
    record(benchmark, "random insertion", "s", count=case.count, dimension=3, packing_fraction=0.3)


def test_a_trajectory_is_written(benchmark, small, tmp_path):
    """The share of a run's time that writing takes, at a frame for every 10 collisions of a particle."""
    case = cases.Case("event", 3, cases.SMALL if small else 10_000, 0.3)
    scene = cases.scene(case)
    sim = gp.Simulation(scene, gp.EventDriven(), seed=1)
    sim.advance(max_events=10 * case.count)
    frames = 2 if small else 20
    interval = sim.time * 0.5  # 10 collisions of each particle are 5 of each pair's two
    shares = []

    def both():
        start = time.perf_counter()
        gp.Simulation(scene, gp.EventDriven(), seed=1).advance(duration=frames * interval)
        plain = time.perf_counter() - start
        path = tmp_path / f"{len(shares)}.nc"
        start = time.perf_counter()
        gp.run(scene, gp.EventDriven(), 1, duration=frames * interval, sample_interval=interval, path=path)
        shares.append((time.perf_counter() - start - plain) / plain)

    benchmark.pedantic(both, rounds=1 if small else 5)
    record(
        benchmark, "writing a trajectory", "share of the run",
        count=case.count, dimension=3, packing_fraction=0.3, values=shares,
    )  # fmt: skip
