"""How a gas between a hot and a cold wall comes to its steady state, from one temperature everywhere."""

from __future__ import annotations

import numpy as np

from gaspart.planning import grid
from gaspart.theory.enskog import enskog_conductivity, mean_free_path
from gaspart.theory.geometry import number_density
from gaspart.theory.heat import TEMPERATURE_JUMP, Slab, steady_part
from gaspart.trajectory.run import open_trajectory

FRAMES = 40
"""First frames of a run that show the approach."""
HEAT_CAPACITY = 2.5
"""Of a particle at constant pressure, in a dilute gas of spheres."""


def approach(point: grid.Point, middle: float) -> dict[str, np.ndarray]:
    """The temperature of the particles nearer to the hot wall minus that of the others, in the first frames.

    middle: the position between the walls. Returns approach_time, approach and approach_error, (FRAMES,)
    each, with NaN beyond the end of a short run: the mean over replicas, and its standard error for
    Maxwellian velocities, the squares of whose components have the relative variance 2.
    """
    differences, variances = [], []
    for path in point.replica_paths:
        with open_trajectory(path) as trajectory:
            part = trajectory.isel(frame=slice(FRAMES))
            time = part["time"].values
            hot = part["coordinates"].values[:, :, 0] < middle
            squares = (part["velocities"].values.astype(float) ** 2).mean(axis=2)
        halves = [np.mean(squares, axis=1, where=side) for side in (hot, ~hot)]
        differences.append(halves[0] - halves[1])
        relative = 2.0 / part.sizes["spatial"]
        numbers = [side.sum(axis=1) for side in (hot, ~hot)]
        variances.append(sum(relative * one**2 / count for one, count in zip(halves, numbers, strict=True)))
    found = {
        "approach_time": time,
        "approach": np.mean(differences, axis=0),
        "approach_error": np.sqrt(np.sum(variances, axis=0)) / len(variances),
    }
    return {name: _filled(values) for name, values in found.items()}


def expected_approach(time: np.ndarray, slab: Slab, eta: float, diameter: float) -> np.ndarray:
    """The same by the heat equation, which ends at the difference of the steady `slab`; eta: mean packing
    fraction. Conductivity and density are those of the mean; jumps at the walls lengthen the gap."""
    hot = slab.position < 0.5 * slab.position[-1]
    steady = _average(slab, hot) - _average(slab, ~hot)
    temperature = 0.5 * (slab.temperature[0] + slab.temperature[-1])
    conductivity = enskog_conductivity(eta, 3, diameter, temperature)
    diffusivity = conductivity / (HEAT_CAPACITY * number_density(eta, 3, diameter))
    length = slab.position[-1] + 2.0 * TEMPERATURE_JUMP * mean_free_path(eta, 3, diameter)
    return steady * steady_part(time, float(length), float(diffusivity))


def _average(slab: Slab, side: np.ndarray) -> float:
    """The mean temperature of the particles of one half."""
    place, number = slab.position[side], slab.density[side]
    return float(np.trapezoid(number * slab.temperature[side], place) / np.trapezoid(number, place))


def _filled(values: np.ndarray) -> np.ndarray:
    return np.pad(values.astype(float), (0, FRAMES - len(values)), constant_values=np.nan)
