"""Dilute gases by the DSMC engine, for SPARTA to repeat: heat between two plates, and how equal speeds relax.

Spheres of diameter and mass 1 at the same density. Between plates everything is the same along them, so a
cell is as wide as the container there. What SPARTA has to know stands in each row, beside our number and
its standard error.
"""

import math

import numpy as np

import gaspart as gp
from gaspart import theory
from gaspart.theory.geometry import packing_fraction

DENSITY = 0.001
DIAMETER = 1.0
PATH = float(theory.mean_free_path(packing_fraction(DENSITY, 3, DIAMETER), 3, DIAMETER))
HOT, COLD = 2.0, 1.0
PLATES = {
    "Kn = 0.1": {"knudsen": 0.1, "cells": 80, "block": 2000},
    "Kn = 1": {"knudsen": 1.0, "cells": 20, "block": 2500},
}
"""Steps of a block of time. In the longer gap the temperatures come to their steady state in some 200."""
BLOCKS = 40
STEP = 10.0
"""A tenth of the time in which a mean free path is flown, or the shorter gap is crossed."""
REPLICAS = 20
SPHERES = 100_000


def jobs():
    """Jobs, each a function and its arguments, that give one row of dilute.json."""
    return [*((plates, name, seed) for seed, name in enumerate(PLATES, 21)), (relaxation, 31)]


def plates(name, seed):
    """The flux of energy per area between plates of two temperatures, the mean of both."""
    given = PLATES[name]
    length, side = PATH / given["knudsen"], PATH / 3.0
    count = round(DENSITY * length * side**2)
    faces = {"x_low": gp.Thermal(HOT), "x_high": gp.Thermal(COLD)}
    container = gp.Container((length + DIAMETER, side, side), ("wall", "periodic", "periodic"))
    species = gp.Species(count, 0.5 * DIAMETER, temperature=0.5 * (HOT + COLD))
    engine = gp.DSMC(time_step=STEP, cells_per_side=(given["cells"], 1, 1))
    sim = gp.Simulation(gp.Scene(container, [species], faces=faces), engine, seed)
    sim.advance(2.0 * given["block"] * STEP)
    taken = []
    for _ in range(BLOCKS):
        sim.reset_tally()
        sim.advance(given["block"] * STEP)
        taken.append(sim.tally.wall_energy[:2])
    fluxes = np.diff(taken, axis=1)[:, 0] / (2.0 * given["block"] * STEP * side**2)
    row = {"name": name, "count": count, "lengths": [length, side, side], "cells": [given["cells"], 1, 1]}
    row |= {"hot": HOT, "cold": COLD, "blocks": BLOCKS, "block": given["block"]}
    return row | {"diameter": DIAMETER, "step": STEP} | mean(fluxes)


def relaxation(seed):
    """<v^4> / <v^2>^2 of spheres that all have the speed 1 at first, after about one collision of each."""
    side = (SPHERES / DENSITY) ** (1.0 / 3.0)
    cells, step, steps = math.ceil(3.0 * side / PATH), 0.1 * PATH, 10
    container = gp.Container((side,) * 3, "periodic")
    scene = gp.Scene(container, [gp.Species(SPHERES, 0.5 * DIAMETER, speed=1.0)])
    found = []
    for replica in range(REPLICAS):
        sim = gp.Simulation(scene, gp.DSMC(time_step=step, cells_per_side=cells), (seed, replica))
        sim.advance(steps * step)
        squares = (sim.state.velocities**2).sum(axis=1)
        found.append((squares**2).mean() / squares.mean() ** 2)
    row = {"name": "relaxation", "count": SPHERES, "lengths": [side] * 3, "cells": [cells] * 3}
    row |= {"replicas": REPLICAS, "steps": steps}
    return row | {"diameter": DIAMETER, "step": step} | mean(np.array(found))


def mean(values):
    """Of independent values (K,), with its standard error."""
    return {"ours": float(values.mean()), "error": float(values.std(ddof=1) / math.sqrt(len(values)))}
