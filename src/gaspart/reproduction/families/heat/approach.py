"""Approach of a gas between a hot and a cold wall to its steady state.

It starts at one temperature.
"""

from __future__ import annotations

import numpy as np

from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.theory.enskog import enskog_conductivity, mean_free_path
from gaspart.theory.geometry import packing_fraction
from gaspart.theory.heat import TEMPERATURE_JUMP, Slab, steady_part

FRAMES = 40
"""First frames of a run that show the approach."""
HEAT_CAPACITY = 2.5
"""Heat capacity of a particle at constant pressure, in a dilute gas of spheres."""


NO_APPROACH = dict.fromkeys(
    ("approach_time", "approach", "approach_error", "expected_approach"), np.full(FRAMES, np.nan)
)
"""Result of `approach` for gases that it does not describe."""


def approach(point: Point, slab: Slab) -> dict[str, np.ndarray]:
    """Measure the difference of temperature between the halves of a gas, in its first frames.

    It is the temperature of the particles nearer to the hot wall minus the temperature of the others, in a
    gas of spheres of mass 1 whose steady state is `slab`.

    Returns approach_time, approach, approach_error and expected_approach, (FRAMES,) each, with NaN beyond the
    end of a short run: the mean over replicas; its standard error for Maxwellian velocities, the squares of
    whose components have the relative variance 2; and the value of the heat equation.
    """
    scene = point.scene
    middle = scene.smallest_radius + 0.5 * slab.position[-1]
    differences, variances = [], []
    for run in runs(point, first=0):
        part = run.data.isel(frame=slice(FRAMES))
        time = part["time"].values
        hot = part["coordinates"].values[:, :, 0] < middle
        squares = (part["velocities"].values.astype(float) ** 2).mean(axis=2)
        halves = [np.mean(squares, axis=1, where=side) for side in (hot, ~hot)]
        numbers = [side.sum(axis=1) for side in (hot, ~hot)]
        differences.append(halves[0] - halves[1])
        variances.append(sum(2.0 / 3.0 * half**2 / n for half, n in zip(halves, numbers, strict=True)))
    density = scene.species[0].count / (slab.position[-1] * np.prod(scene.container.lengths[1:]))
    columns = {
        "approach_time": time,
        "approach": np.mean(differences, axis=0),
        "approach_error": np.sqrt(np.sum(variances, axis=0)) / len(variances),
        "expected_approach": expected_approach(time, slab, float(density), 2.0 * scene.smallest_radius),
    }
    rest = (0, FRAMES - len(time))
    return {
        name: np.pad(values.astype(float), rest, constant_values=np.nan) for name, values in columns.items()
    }


def expected_approach(time: np.ndarray, slab: Slab, density: float, diameter: float) -> np.ndarray:
    """Compute the difference of the halves' temperatures by the heat equation.

    The conductivity is that at the mean density and temperature. The difference ends at its value in the
    steady `slab`; jumps at the walls lengthen the gap.
    """
    hot = slab.position < 0.5 * slab.position[-1]
    steady = _average(slab, hot) - _average(slab, ~hot)
    eta = packing_fraction(density, 3, diameter)
    temperature = 0.5 * (slab.temperature[0] + slab.temperature[-1])
    conductivity = enskog_conductivity(eta, 3, diameter, temperature)
    length = slab.position[-1] + 2.0 * TEMPERATURE_JUMP * mean_free_path(eta, 3, diameter)
    return steady * steady_part(time, float(length), float(conductivity / (HEAT_CAPACITY * density)))


def _average(slab: Slab, side: np.ndarray) -> float:
    """Compute the mean temperature of the particles of one half."""
    position, number = slab.position[side], slab.density[side]
    return float(np.trapezoid(number * slab.temperature[side], position) / np.trapezoid(number, position))
