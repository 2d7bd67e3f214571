"""Gap between two thermal walls: geometry, and averages over blocks of time of its particles and walls.

The walls are the two faces of the first axis. Positions are measured between particle centres and the lowest
position at the hot wall.
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
from gaspart.scene.boundaries import thermal_face
from gaspart.scene.scene import Scene


@dataclass(frozen=True)
class Gap:
    """Length that is accessible to centres, area of a wall, temperatures of the walls; x_low is hot."""

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
        """Compute the steady flux of both walls in some blocks, without the energy that these store."""
        changes = np.diff(self.stored, axis=1).reshape(-1, 2)[blocks]
        return steady_mean(0.5 * (self.heat_in + self.heat_out)[blocks], *changes.T)

    def wall_ratio(self) -> Estimate:
        """Compute heat into the cold over heat out of the hot wall, which differ by energies stored at both
        ends.
        """
        replicas, ends, _ = self.stored.shape
        spread = self.stored[:, :, 0].std(axis=1, ddof=1)
        error = np.sqrt(2.0 * np.sum(spread**2)) / self.heat
        return Estimate(self.heat_out.sum() / self.heat_in.sum(), error, replicas * (ends - 1))


def averages(point: Point, gap: Gap, blocks: int, bins: int) -> Averages:
    """Average over blocks of each replica, of particles of mass 1; ValueError for too few frames."""
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
