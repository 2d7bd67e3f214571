"""What a point costs: work that is counted, the same on every machine, and time that is measured."""

from __future__ import annotations

import time

import numpy as np
import xarray as xr

from gaspart import grid
from gaspart.simulation import Simulation

COUNTED = ("collisions", "pair_tests", "box_visits", "crossings", "steps")


def measure_cost(point: grid.Point) -> xr.Dataset:
    """Run the point's equilibration, then its length in ``samples`` stretches, each timed and counted.

    Returns a dataset over ``stretch``: ``seconds`` (processor time of ``advance`` alone: filling the
    container and compiling are left out), ``duration`` (scene's time), and the counts of the tally.
    Attributes: count, packing_fraction, radius, boxes (in all; 0 if the engine chooses them itself).
    Raises SceneError and SimulationError.
    """
    schedule = grid.schedule(point)
    scene, engine = grid.scene(point), grid.engine(point)
    simulation = Simulation(scene, engine, seed=point.seed())
    simulation.advance(duration=schedule.equilibration)
    columns = {name: [] for name in ("seconds", "duration", *COUNTED)}
    for _ in range(schedule.samples):
        simulation.reset_tally()
        start = time.process_time()
        simulation.advance(duration=schedule.sample_interval)
        columns["seconds"].append(time.process_time() - start)
        tally = simulation.tally
        columns["duration"].append(tally.time)
        for name in COUNTED:
            columns[name].append(getattr(tally, name))
    units = {"seconds": "s", "duration": "scene time"}
    dataset = xr.Dataset(
        {
            name: ("stretch", np.asarray(values), {"units": units.get(name, "1")})
            for name, values in columns.items()
        }
    )
    per_side = getattr(engine, "boxes_per_side", None)
    if per_side is None:
        boxes = 0
    elif isinstance(per_side, int):
        boxes = per_side**scene.dimension
    else:
        boxes = int(np.prod(per_side))
    dataset.attrs.update(
        count=scene.count,
        packing_fraction=scene.packing_fraction,
        radius=scene.largest_radius,
        boxes=boxes,
    )
    return dataset
