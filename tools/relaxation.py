"""Relaxation of equal speeds to Maxwell's distribution, by the DSMC engine.

    python tools/relaxation.py 3 1000000 60 > table.csv

computes the numbers of `theory/data/relaxation_3d.csv`. The arguments are the dimension, the number of
particles in a run, and the number of runs. The gas is homogeneous, so that neither cells nor steps matter:
within a step, collisions occur one after another in continuous time (see docs/dsmc.md). Statistical errors
are the scatter of the runs.
"""

from __future__ import annotations

import sys

import numpy as np

from gaspart.analysis.statistics import means_of
from gaspart.engines import DSMC
from gaspart.scene.container import Container
from gaspart.scene.scene import Scene
from gaspart.scene.species import Species
from gaspart.simulation import Simulation

COLUMNS = ("collisions_per_particle", "kurtosis", "never_hit", "mean_speed")
_PACKING_FRACTION = 1e-3  # packing fraction


def relaxation(dimension: int, count: int, collisions: float, seed: int) -> np.ndarray:
    """Simulate the relaxation of speeds, and return rows of `COLUMNS`, (rows, 4). The columns are 2 N_coll /
    N, <v^4> / <v^2>^2, the fraction of particles without a collision so far, and <v> divided by the
    root-mean-square speed. The run ends after `collisions` collisions of a particle.
    """
    unit = np.pi / (4.0 if dimension == 2 else 6.0)
    side = (count * unit / _PACKING_FRACTION) ** (1.0 / dimension)
    kind = Species(count, 0.5, speed=1.0)
    scene = Scene(Container((side,) * dimension, "periodic"), [kind])
    simulation = Simulation(scene, DSMC(), seed)
    step = simulation.engine.for_scene(scene).quantum
    assert step is not None
    start = simulation.state.velocities
    rows: list[tuple[float, ...]] = []
    while not rows or rows[-1][0] < collisions:
        velocities = simulation.state.velocities
        square = (velocities**2).sum(axis=1)
        kurtosis = (square**2).mean() / square.mean() ** 2
        hit = (velocities != start).any(axis=1)
        speed = np.sqrt(square).mean() / np.sqrt(square.mean())
        rows.append((2.0 * simulation.tally.collisions / count, kurtosis, 1.0 - hit.mean(), speed))
        simulation.advance(until=simulation.time + 1.5 * step)
    return np.array(rows)


def main(dimension: int, count: int, runs: int) -> None:
    """Write the table, with the standard error of the kurtosis."""
    tables = [relaxation(dimension, count, 8.0, seed) for seed in range(runs)]
    shortest = min(map(len, tables))
    means, errors = means_of([table[:shortest] for table in tables])
    print(",".join((*COLUMNS, "kurtosis_standard_error")))
    for mean, error in zip(means, errors, strict=True):
        print(",".join(f"{value:.6f}" for value in (*mean, error[1])))


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
