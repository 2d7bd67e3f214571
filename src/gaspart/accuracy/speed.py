"""Speed of this machine relative to the machine of the table, measured in 0.1 s."""

from __future__ import annotations

import math
import statistics
import time
from functools import cache

from gaspart import theory
from gaspart.accuracy import table
from gaspart.accuracy.advisers import adviser_of, candidate_engines, timed_as
from gaspart.scene.container import Container
from gaspart.scene.scene import Scene
from gaspart.scene.species import Species
from gaspart.simulation import Simulation

_LEAST, _MOST = 500, 100_000  # particles in a timed run
_GROWTH = 0.15  # growth exponent of the time per contact with N, beyond the processor cache
_CONTACTS = 2e4


@cache
def factor(dimension: int, engine: str, precision: str, count: int) -> float:
    """Measure the CPU time of a contact on this machine, divided by the table's time. The reference gas of
    the engine (`timed_at`) is simulated and timed three times with `count` particles, after a short run from
    a lattice. `engine` is the engine's name in the table.
    """
    growth = max(1.0, count / _MOST) ** _GROWTH
    count = min(max(count, _LEAST), _MOST)
    timed = next(candidate for candidate in candidate_engines() if timed_as(candidate) == engine)
    fraction, step = adviser_of(timed).timed_at
    side = (count * theory.particle_volume(dimension) / fraction) ** (1.0 / dimension)
    particles = Species(count, 0.5, temperature=1.0, arrangement="lattice")
    gas = Scene(Container((side,) * dimension, boundary="periodic"), species=(particles,))
    rate = float(theory.collision_rate(fraction, dimension))
    run = Simulation(gas, adviser_of(timed).at_step(gas, step, precision), seed=1)
    run.advance(duration=1.0 / rate)
    stretch = 2.0 * max(_CONTACTS, 0.5 * count) / (count * rate)
    seconds = []
    for _ in range(3):
        before, start = run.time, time.process_time()
        run.advance(duration=stretch)
        seconds.append((time.process_time() - start) / (0.5 * count * rate * (run.time - before)))
    table_seconds = table.seconds(dimension, fraction, engine, precision, step)
    return growth * statistics.median(seconds) / table_seconds if math.isfinite(table_seconds) else math.inf
