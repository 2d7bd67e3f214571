"""Column of gas under gravity: heights, energies and forces, averaged over blocks.

The container has two dimensions. Gravity points down the last axis. Height 0 is the lowest position that the
centre of the smallest particle can reach. The height of a particle is the height of its centre.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gaspart.analysis.flow import Grid
from gaspart.analysis.series import Blocks
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.scene.species import Particle, Species


@dataclass(frozen=True)
class Field:
    """Gravity, container and particles of a scene, in the scene's units.

    strength : gravitational acceleration, positive downwards.
    width, height : size of the region that centres of the smallest particles can reach (on a periodic axis,
        the length of the container).
    diameter : diameter of the smallest particles.
    masses : (N,), masses; infinite for fixed particles.
    species : (N,), index of the species in the scene; single particles have the following indices.
    across : True if the other axis is periodic, so that momentum along it is conserved.
    """

    strength: float
    width: float
    height: float
    diameter: float
    masses: np.ndarray
    species: np.ndarray
    across: bool

    @property
    def weight(self) -> float:
        """Total weight of all moving particles."""
        return float(self.strength * self.masses[np.isfinite(self.masses)].sum())


def field(point: Point) -> Field:
    """Return gravity, container and particles of a point's scene."""
    scene = point.scene
    radius = scene.smallest_radius
    lower, upper = scene.reach(radius)
    parts: list[tuple[Species | Particle, int, int]] = [
        (particle, 1, len(scene.species)) for particle in scene.particles
    ]
    parts += [(kind, kind.count, n) for n, kind in enumerate(scene.species)]
    return Field(
        strength=-scene.gravity[-1] if scene.gravity else 0.0,
        width=upper[0] - lower[0],
        height=upper[1] - lower[1],
        diameter=2.0 * radius,
        masses=np.concatenate([np.full(k, np.inf if kind.fixed else kind.mass) for kind, k, _ in parts]),
        species=np.concatenate([np.full(k, n) for _, k, n in parts]),
        across=scene.container.periodic[0],
    )


@dataclass(frozen=True)
class Stretch:
    """Block of T consecutive frames of one run with N particles.

    positions : (T, N, 2), positions; the second coordinate is the height.
    energies : (T, N), kinetic temperatures, without the motion of the centre of mass along a periodic axis.
    floor, ceiling : mean forces on floor and ceiling.
    gain : mean rate of increase of the particles' upward momentum.
    temperature : twice the mean kinetic energy per degree of freedom (a conserved momentum removes one).
    """

    positions: np.ndarray
    energies: np.ndarray
    floor: float
    ceiling: float
    gain: float
    temperature: float

    @property
    def heights(self) -> np.ndarray:
        """Heights of particles, (T, N)."""
        return self.positions[..., 1]


def stretches(point: Point, number: int) -> list[Stretch]:
    """Cut the measured part of every replica into `number` blocks of equal length.

    A remainder is left out. Adjacent blocks share only the frame at which momenta are read. Raises ValueError
    for too few frames.
    """
    column, result = field(point), []
    for run in runs(point):
        blocks = Blocks(run, number)
        energies = np.zeros(run.positions.shape[:2])
        energies[:, run.moving] = 0.5 * run.motion.energies(run.masses[run.moving])
        positions = run.positions - [0.0, 0.5 * column.diameter]
        momentum = run.velocities[blocks.ends, run.moving, 1] @ run.masses[run.moving]
        columns = (
            blocks.growth("wall_impulse")[:, 2],
            blocks.growth("wall_impulse")[:, 3],
            np.diff(momentum) / blocks.durations,
            blocks.means_of_frames(run.temperatures),
        )
        frames = (np.split(values[blocks.frames], number) for values in (positions, energies))
        parts = zip(*frames, *(series.tolist() for series in columns), strict=True)
        result += [Stretch(*part) for part in parts]
    return result


@dataclass(frozen=True)
class Profile:
    """Averages in B bins of height.

    density : (S, B), number density of each species.
    temperature : (B,), temperature; NaN in empty bins.
    pressure : (B,), force per length that supports the gas above: the force on the ceiling plus the weight.
    """

    density: np.ndarray
    temperature: np.ndarray
    pressure: np.ndarray


def profile(column: Field, stretch: Stretch, bins: int) -> Profile:
    """Average a block without fixed particles over each of `bins` equal bins of height.

    In a steady state the momentum below any height is constant. Therefore the pressure at z is (F_ceiling +
    sum of m g over particles above z) / width. This is exact, and uses no equation of state.
    """
    frames, count = stretch.heights.shape
    grid = Grid.line(0.0, column.height, bins)
    cells = grid.cells(stretch.heights[..., None], inside=True)
    counts = np.array([
        grid.sums(cells[:, column.species == kind]) for kind in range(int(column.species.max()) + 1)
    ])  # fmt: skip
    total = counts.sum(axis=0)
    # In an average over z of a bin, a particle in the bin contributes the fraction of the bin below it.
    below = np.clip(stretch.heights * (bins / column.height) - cells, 0.0, 1.0)
    mass, within = grid.sums(cells, column.masses), grid.sums(cells, column.masses * below)
    above = np.cumsum(mass[::-1])[::-1] - mass + within
    lost = 2.0 * count / (2.0 * count - column.across)  # the conserved momentum
    with np.errstate(invalid="ignore"):
        energies = lost * grid.sums(cells, stretch.energies)
        temperature = np.where(total > 0, energies / np.maximum(total, 1), np.nan)
    return Profile(
        density=counts / (frames * column.width * grid.volume),
        temperature=temperature,
        pressure=(stretch.ceiling + column.strength * above / frames) / column.width,
    )
