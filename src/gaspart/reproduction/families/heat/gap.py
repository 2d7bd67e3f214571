"""Gap between two thermal walls: geometry, block averages, approach to a steady state.

The averages are of particles in the gap, and of its walls. The walls are the two faces of the first axis.
Positions are measured between particle centres and the lowest position at the hot wall.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.flow import Grid
from gaspart.analysis.series import Blocks
from gaspart.analysis.statistics import steady_mean
from gaspart.reproduction.figure import runs
from gaspart.reproduction.points.point import Point
from gaspart.scene.faces import thermal_face
from gaspart.scene.scene import Scene
from gaspart.theory.enskog import enskog_conductivity, mean_free_path
from gaspart.theory.geometry import packing_fraction
from gaspart.theory.heat import TEMPERATURE_JUMP, Slab, steady_part


@dataclass(frozen=True)
class Gap:
    """Gap between the walls.

    length : length that is accessible to centres.
    area : area of a wall.
    hot, cold : temperatures of the walls; the hot wall is x_low.
    dimension : dimension.
    """

    length: float
    area: float
    hot: float
    cold: float
    dimension: int

    @classmethod
    def of(cls, scene: Scene) -> Gap:
        """Return the gap of a scene whose walls are thermal."""
        lower, upper = scene.reach(scene.smallest_radius)
        hot, cold = (thermal_face(scene, name).temperatures[0] for name in ("x_low", "x_high"))
        area = float(np.prod(scene.container.lengths[1:]))
        return cls(upper[0] - lower[0], area, hot, cold, scene.dimension)

    def grid(self, bins: int) -> Grid:
        """Return equal bins across the gap."""
        return Grid.line(0.0, self.length, bins)


@dataclass(frozen=True)
class Averages:
    """Averages over K time blocks.

    heat_in, heat_out : (K,), heat flux out of the hot wall, and heat flux into the cold wall.
    density : (K, B), particles in bins, per volume.
    energy : (K, B), energy of the particles per volume, as a temperature.
    imbalance : largest difference between supplied energy and gained energy, divided by the conducted heat.
    stored : (R, K/R + 1, 2), particles' energy and its first moment about the middle, at ends of blocks.
    heat : total conducted heat.
    """

    heat_in: np.ndarray
    heat_out: np.ndarray
    density: np.ndarray
    energy: np.ndarray
    imbalance: float
    stored: np.ndarray
    heat: float

    def flux(self, blocks: slice = slice(None)) -> Estimate:
        """Compute the steady flux from the mean of both walls, in the chosen blocks.

        Changes and displacements of the particles' energy are bounded. Their contributions are removed.
        """
        changes = np.diff(self.stored, axis=1).reshape(-1, 2)[blocks]
        return steady_mean(0.5 * (self.heat_in + self.heat_out)[blocks], *changes.T)

    def wall_ratio(self) -> Estimate:
        """Compute the heat into the cold wall divided by the heat out of the hot wall.

        Both differ exactly by the energy that the particles gained. In a steady state, this is the difference
        of independent energies at both ends of a replica.
        """
        replicas, ends, _ = self.stored.shape
        spread = self.stored[:, :, 0].std(axis=1, ddof=1)
        error = np.sqrt(2.0 * np.sum(spread**2)) / self.heat
        return Estimate(self.heat_out.sum() / self.heat_in.sum(), error, replicas * (ends - 1))


def averages(point: Point, gap: Gap, blocks: int, bins: int) -> Averages:
    """Average over the measured part of all replicas of particles of mass 1.

    Each replica is cut into `blocks` blocks.

    Raises ValueError if there are too few frames.
    """
    radius = point.scene.smallest_radius
    heats, densities, energies, missing, stored, conducted = [], [], [], [], [], 0.0
    grid = gap.grid(bins)
    for run in runs(point):
        parts, kinetic = Blocks(run, blocks), run.data["kinetic_energy"].values
        positions = run.positions[:, :, 0] - radius
        squares = (run.velocities**2).sum(axis=2)
        heats.append(parts.growth("wall_energy")[:, :2] / gap.area)
        through = run.data["wall_energy"].values - run.data["wall_energy"].values[0]
        missing.append(abs(through.sum(axis=1) + kinetic - kinetic[0]).max() / abs(through[-1]).max())
        moment = 0.5 * (squares * (positions - 0.5 * gap.length)).sum(axis=1)
        stored.append(np.stack([kinetic, moment], axis=1)[parts.ends])
        conducted += abs(np.ptp(through[parts.ends, :2][[0, -1]], axis=0)).mean()
        cells, volume = grid.cells(positions[..., None], inside=True), parts.length * gap.area * grid.volume
        densities.append(parts.sums(grid, cells) / volume)
        energies.append(parts.sums(grid, cells, squares / gap.dimension) / volume)
    into_hot, into_cold = np.concatenate(heats).T
    profiles = np.concatenate(densities), np.concatenate(energies)
    return Averages(-into_hot, into_cold, *profiles, float(max(missing)), np.array(stored), float(conducted))


# Approach to the steady state of a gas between a hot and a cold wall. Initially the gas has a single
# temperature.


FRAMES = 40
"""Number of frames at the start of a run that show the approach."""
HEAT_CAPACITY = 2.5
"""Heat capacity of a particle at constant pressure, in a dilute gas of spheres."""


NO_APPROACH = dict.fromkeys(
    ("approach_time", "approach", "approach_error", "expected_approach"), np.full(FRAMES, np.nan)
)
"""Result of `approach` for gases for which it is not defined."""


def approach(point: Point, slab: Slab) -> dict[str, np.ndarray]:
    """Measure the temperature difference between the halves of a gas, in its first frames.

    The result is the temperature of the particles nearer to the hot wall, minus the temperature of the
    others. The gas consists of spheres of mass 1. Its steady state is `slab`.

    Returns approach_time, approach, approach_error and expected_approach, with shape (FRAMES,) each, and NaN
    beyond the end of a short run. `approach` is the mean over replicas. Its standard error is computed for
    Maxwellian velocities; squares of their components have the relative variance 2. `expected_approach` is
    the value by the heat equation.
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
    """Compute the temperature difference between the halves by the heat equation.

    The conductivity is taken at the mean density and temperature. The difference converges to its value in
    the steady `slab`. Temperature jumps at the walls increase the effective gap.
    """
    hot = slab.position < 0.5 * slab.position[-1]
    steady = _average(slab, hot) - _average(slab, ~hot)
    eta = packing_fraction(density, 3, diameter)
    temperature = 0.5 * (slab.temperature[0] + slab.temperature[-1])
    conductivity = enskog_conductivity(eta, 3, diameter, temperature)
    length = slab.position[-1] + 2.0 * TEMPERATURE_JUMP * mean_free_path(eta, 3, diameter)
    return steady * steady_part(time, float(length), float(conductivity / (HEAT_CAPACITY * density)))


def _average(slab: Slab, side: np.ndarray) -> float:
    """Compute the mean temperature of the particles in one half."""
    position, number = slab.position[side], slab.density[side]
    return float(np.trapezoid(number * slab.temperature[side], position) / np.trapezoid(number, position))
