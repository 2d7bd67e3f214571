"""Columns of gas under gravity: heights, energies and forces in blocks of time, and profiles of discs.

The container has two dimensions. Gravity points down the last axis. Height 0 is the lowest position that the
centre of the smallest particle can reach. The height of a particle is the height of its centre. The
temperature is always defined by the kinetic energy.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis import series
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.flow import Grid
from gaspart.keys import POSITIVE, TEXT, count, describe, list_of, positive, record
from gaspart.reproduction.figure import Blocks, runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table
from gaspart.scene.species import Particle, Species
from gaspart.theory.geometry import particle_volume
from gaspart.theory.gravity import hydrostatic_profiles, ideal_mean_height
from gaspart.theory.state import compressibility_factor
from gaspart.theory.tables import excess_chemical_potential
from gaspart.trajectory.reading import open_trajectory


@dataclass(frozen=True)
class Field:
    """Gravity, container and particles of a scene.

    strength : gravitational acceleration, positive downwards.
    width, height : size of the region that centres of the smallest particles can reach (on a periodic axis,
        the length of the container).
    diameter : diameter of the smallest particles.
    masses, species : (N,), infinite for fixed particles; single particles follow the species of the scene.
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
    """Cut the measured part of every replica into `number` blocks of equal length, without a remainder.
    Raises ValueError for too few frames.
    """
    radius, result = 0.5 * field(point).diameter, []
    for run in runs(point):
        blocks = series.Blocks(run, number)
        energies = np.zeros(run.positions.shape[:2])
        energies[:, run.moving] = 0.5 * run.motion.energies(run.masses[run.moving])
        positions = run.positions - [0.0, radius]
        momentum = run.velocities[blocks.ends, run.moving, 1] @ run.masses[run.moving]
        columns = (
            blocks.growth("wall_impulse")[:, 2],
            blocks.growth("wall_impulse")[:, 3],
            np.diff(momentum) / blocks.durations,
            blocks.means_of_frames(run.temperatures),
        )
        frames = (np.split(values[blocks.frames], number) for values in (positions, energies))
        parts = zip(*frames, *(column.tolist() for column in columns), strict=True)
        result += [Stretch(*part) for part in parts]
    return result


def profile(column: Field, stretch: Stretch, bins: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Average a block without fixed particles over each of B equal bins of height. Returns the density of
    each species (S, B), the density times the temperature (B,), and the pressure (B,). In a steady state the
    momentum below any height is constant. Therefore the pressure at z is (F_ceiling + sum of m g over
    particles above z) / width. This is exact, and uses no equation of state.
    """
    frames, count = stretch.heights.shape
    grid = Grid.line(0.0, column.height, bins)
    cells = grid.cells(stretch.heights[..., None], inside=True)
    counts = np.array([
        grid.sums(cells[:, column.species == kind]) for kind in range(int(column.species.max()) + 1)
    ])  # fmt: skip
    density, total = counts / (frames * column.width * grid.volume), counts.sum(axis=0)
    # In an average over z of a bin, a particle in the bin contributes the fraction of the bin below it.
    below = np.clip(stretch.heights * (bins / column.height) - cells, 0.0, 1.0)
    mass, within = grid.sums(cells, column.masses), grid.sums(cells, column.masses * below)
    above = np.cumsum(mass[::-1])[::-1] - mass + within
    lost = 2.0 * count / (2.0 * count - column.across)  # the conserved momentum
    temperature = lost * grid.sums(cells, stretch.energies) / np.maximum(total, 1)  # 0 in an empty bin
    pressure = (stretch.ceiling + column.strength * above / frames) / column.width
    return density, temperature * density.sum(axis=0), pressure


# Profiles of discs of one size.


def column_settings(**columns: str) -> dict[str, Any]:
    """Return the settings of `measure_columns`, with the meanings of further columns."""
    columns = {"dilute": "nearly an ideal gas", "dense": "at fluid densities at the floor"} | columns
    named = {name: describe(TEXT, meaning, default=None) for name, meaning in columns.items()}
    return {
        "bins": count("bins of height"),
        "blocks": count("stretches of each replica"),
        "clear": positive("diameters next to floor and ceiling that are left out, where layers are"),
        "ranges": list_of(
            list_of(POSITIVE, least=2, most=2),
            "pairs of packing fractions between which the equation of state is averaged",
        ),
        "columns": record(named, "the experiment of each column that the figure distinguishes"),
        "source_collisions": positive("collisions before the sample of source C's own run"),
    }


_BY_BIN = ("temperature_ratio", "packing_fraction", "compressibility", "pressure_ratio")
_BY_BIN += ("height", "used", "log_ratio", "log_ratio_expected")
_BY_SPECIES = ("mass", "slope_ratio", "mean_height_ratio", "species_temperature_ratio")
INNER = {
    **dict.fromkeys(("density", "hydrostatic"), ("species", "bin")),
    **dict.fromkeys(_BY_BIN, ("bin",)),
    **dict.fromkeys(_BY_SPECIES, ("species",)),
    "range_ratio": ("range",),
    "share": ("layer",),
}
"""Dimensions, in addition to point, of the arrays of a column."""


def measure_columns(points: list[Point], settings: dict, of_source: Callable[[Point], dict]) -> xr.Dataset:
    """Measure columns of discs of one size; `of_source` returns further numbers of the column "source"."""
    names = {experiment: name for name, experiment in settings["columns"].items()}

    def row(point: Point) -> dict[str, Any]:
        name = names.get(point.experiment, "")
        own = {"collisions": _collisions(point), **of_source(point)} if name == "source" else {}
        return {"column": name, **_measure_column(point, settings), **own}

    low, high = np.array(settings["ranges"], dtype=float).T
    dataset = table("point", points, row, inner=INNER).set_coords("column")
    dataset = dataset.assign_coords(range_low=("range", low), range_high=("range", high))
    return dataset.assign_attrs(clear=settings["clear"], source_collisions=settings["source_collisions"])


def _collisions(point: Point) -> float:
    """Count collisions and wall hits before the sample; the source counts both together."""
    with open_trajectory(point.replica_path(0)) as trajectory:
        frame = trajectory.isel(frame=point.schedule.equilibration_frames)
        return float(frame["collisions"] + frame["wall_hits"].sum())


class Bins:
    """Bins of height of a column; those within `clear` diameters of floor or ceiling are not used. Arguments
    of the methods are averages over time: density (S, B), energy (B,), which is density times temperature,
    pressure (B,), and the temperature of the entire column.
    """

    def __init__(self, column: Field, number: int, clear: float) -> None:
        grid = Grid.line(0.0, column.height, number)
        self.column, self.height, self.width = column, grid.middles[0], grid.volume
        margin = clear * column.diameter + 0.5 * self.width
        self.used = (self.height > margin) & (self.height < column.height - margin)
        self.own = [column.species == n for n in range(int(column.species.max()) + 1)]
        self.masses = np.array([column.masses[own][0] for own in self.own])
        self.area = particle_volume(2, column.diameter)

    def _slope(self, y: np.ndarray, weight: np.ndarray) -> float:
        """Fit the slope of a line to the used bins with particles; variances are as 1 / weight."""
        seen = self.used & (weight > 0.0)
        return float(np.polyfit(self.height[seen], y[seen], 1, w=np.sqrt(weight[seen]))[0])

    def packing_fraction(self, density: np.ndarray) -> np.ndarray:
        """Compute the total packing fraction (B,) of all species."""
        return density.sum(axis=0) * self.area

    def pressure_ratio(self, density: np.ndarray, energy: np.ndarray, pressure: np.ndarray) -> np.ndarray:
        """Compute pressure (B,) divided by the reference at this density and temperature."""
        return pressure / (energy * compressibility_factor(self.packing_fraction(density), 2))

    def slope_ratio(self, density: np.ndarray, temperature: float) -> np.ndarray:
        """Compute slopes of ln eta_i + mu_excess(eta), divided by -m_i g / T, shape (S,)."""
        excess = excess_chemical_potential(self.packing_fraction(density), 2)
        slopes = [self._slope(np.log(row * self.area) + excess, row) for row in density]
        return -np.array(slopes) * temperature / (self.masses * self.column.strength)

    def exchange_ratio(self, density: np.ndarray, temperature: float) -> float:
        """Compute the slope of ln(rho_1 / rho_0) over -(m_1 - m_0) g / T; NaN for one species. It is exact at
        any density: for given positions, no energy depends on which particles are heavy.
        """
        if self.masses.size < 2:
            return np.nan
        slope = self._slope(log_ratio(density), density[0] * density[-1] / density.sum(axis=0))
        return -slope * temperature / ((self.masses[-1] - self.masses[0]) * self.column.strength)

    def temperature_gradient(self, density: np.ndarray, energy: np.ndarray) -> float:
        """Compute dT/dz over the mean weight of a particle: d ln T / dz in inverse scale heights."""
        total = density.sum(axis=0)
        return self._slope(energy / total, total) / (self.column.weight / len(self.column.masses))

    def mean_height_ratio(self, height: np.ndarray, temperature: float) -> np.ndarray:
        """Compute mean heights (S,) divided by the mean heights in ideal gases."""
        weights = self.masses * self.column.strength / temperature
        return height / ideal_mean_height(self.column.height, weights)

    def exchange_line(self, ratio: Estimate, temperature: float) -> np.ndarray:
        """Compute a line with the exact slope through the weighted mean of `log_ratio` (B,) in used bins."""
        line = -(self.masses[-1] - self.masses[0]) * self.column.strength / temperature * self.height
        error = ratio.error
        usable = self.used & np.isfinite(error) & (error > 0.0)
        if self.masses.size < 2 or not usable.any():
            return line
        return line + np.average((ratio.value - line)[usable], weights=1.0 / error[usable] ** 2)

    def hydrostatics(self, density: np.ndarray, temperature: float) -> np.ndarray:
        """Compute hydrostatic densities (S, B) with each species' number of particles in used bins."""
        first, last = np.flatnonzero(self.used)[[0, -1]]
        z = np.linspace(first, last + 1, 8 * (last - first + 1) + 1) * self.width
        numbers = density[:, self.used].sum(axis=1) * self.width
        weights = self.masses * self.column.strength / temperature
        curves = hydrostatic_profiles(z, numbers, weights, 2, self.column.diameter)
        densities = np.full(density.shape, np.nan)
        densities[:, self.used] = [np.interp(self.height[self.used], z, curve) for curve in curves]
        return densities


def log_ratio(density: np.ndarray) -> np.ndarray:
    """Compute ln of the last species' density divided by the first species' density, (B,)."""
    return np.log(density[-1] / density[0])


def _measure_column(point: Point, settings: dict) -> dict[str, Any]:
    column, blocks = field(point), stretches(point, settings["blocks"])
    bins = Bins(column, settings["bins"], settings["clear"])
    parts = [
        (
            *profile(column, stretch, settings["bins"]),
            stretch.temperature,
            [stretch.heights[:, kind].mean() for kind in bins.own],
            [stretch.energies[:, kind].mean() for kind in bins.own],
        )
        for stretch in blocks
    ]
    each = Blocks(parts)
    eta = bins.packing_fraction(np.mean([density for density, *_ in parts], axis=0))
    ranges = [bins.used & (eta >= low) & (eta < high) for low, high in settings["ranges"]]

    def range_ratio(*means: np.ndarray) -> np.ndarray:
        ratio = bins.pressure_ratio(*means)
        return np.array([ratio[mask].mean() if mask.any() else np.nan for mask in ranges])

    with np.errstate(invalid="ignore", divide="ignore"):  # empty bins
        row: dict[str, Any] = {
            "density": each(lambda rho, *_: rho),
            "packing_fraction": each(lambda rho, *_: bins.packing_fraction(rho)),
            "temperature": each(lambda rho, e, p, t, *_: t),
            "temperature_ratio": each(lambda rho, e, p, t, *_: e / rho.sum(axis=0) / t),
            "temperature_gradient": each(lambda rho, e, *_: bins.temperature_gradient(rho, e)),
            "compressibility": each(lambda rho, e, p, *_: p / e),
            "pressure_ratio": each(lambda rho, e, p, *_: bins.pressure_ratio(rho, e, p)),
            "range_ratio": each(lambda rho, e, p, *_: range_ratio(rho, e, p)),
            "slope_ratio": each(lambda rho, e, p, t, *_: bins.slope_ratio(rho, t)),
            "exchange_ratio": each(lambda rho, e, p, t, *_: bins.exchange_ratio(rho, t)),
            "log_ratio": each(lambda rho, *_: log_ratio(rho)),
            "mean_height_ratio": each(lambda rho, e, p, t, z, _: bins.mean_height_ratio(z, t)),
            "species_temperature_ratio": each(lambda *means: means[-1] / means[-1][0]),
        }
    temperature = row["temperature"].value
    return row | {
        "height": bins.height,
        "used": bins.used,
        "mass": bins.masses,
        "strength": column.strength,
        "top": column.height,
        "count": len(column.masses),
        "mean_density": len(column.masses) / (column.width * column.height),
        "hydrostatic": bins.hydrostatics(row["density"].value, temperature),
        "log_ratio_expected": bins.exchange_line(row["log_ratio"], temperature),
        "imbalance": max(abs(s.floor - s.ceiling - column.weight - s.gain) / column.weight for s in blocks),
    }
