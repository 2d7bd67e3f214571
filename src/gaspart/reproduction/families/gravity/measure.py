"""Gases under gravity: profiles of one and of two kinds of discs, and the heat capacity.

Each replica is cut into `blocks` blocks of time. The blocks of all replicas are assumed independent. Errors
are jackknife errors over the blocks. The temperature is always defined by the kinetic energy.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from scipy.optimize import curve_fit

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.flow import Grid
from gaspart.analysis.statistics import jackknife
from gaspart.reproduction.families.shared.columns import (
    Field,
    field,
    profile,
    stretches,
)
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table
from gaspart.state.initial import initial_state
from gaspart.theory.geometry import particle_volume
from gaspart.theory.gravity import (
    hydrostatic_profiles,
    ideal_energy_moments,
    ideal_mean_height,
    lebowitz_percus_verlet,
)
from gaspart.theory.state import compressibility_factor
from gaspart.theory.tables import excess_chemical_potential
from gaspart.trajectory.reading import open_trajectory

# Results of source C's own runs under gravity, for comparison with the numbers in its notebooks. The sample
# of such a point begins at the number of collisions at which the source stops.


_FALL = 0.3
"""Fraction of the time before the sample. Before this time, the oscillation is large, and not yet harmonic.
"""


def collisions(point: Point) -> float:
    """Count collisions and wall hits before the sample.

    The source counts both together.
    """
    with open_trajectory(point.replica_path(0)) as trajectory:
        frame = trajectory.isel(frame=point.schedule.equilibration_frames)
        return float(frame["collisions"] + frame["wall_hits"].sum())


def ringing(point: Point) -> dict[str, Estimate]:
    """Fit the relative amplitude of the kinetic energy's oscillation at the start of the sample.

    The fit is mean + e^{-t / decay} (a cos w t + b sin w t) to all frames after the fall. The time t starts
    at the sample. The amplitude is divided by the mean. The error follows from the scatter of the frames.
    """
    begin = point.schedule.equilibration
    with open_trajectory(point.replica_path(0)) as trajectory:
        time, kinetic = trajectory["time"].values, trajectory["kinetic_energy"].values
    late = time > _FALL * begin
    time, kinetic = time[late] - begin, kinetic[late] / kinetic[late].mean()

    def model(t: np.ndarray, mean: float, a: float, b: float, w: float, decay: float) -> np.ndarray:
        return mean + np.exp(-t / decay) * (a * np.cos(w * t) + b * np.sin(w * t))

    frequencies = np.linspace(2.0, 30.0, 600) * np.pi / np.ptp(time)
    power = np.abs(np.exp(1j * np.outer(frequencies, time)) @ (kinetic - 1.0))
    start = (1.0, 0.01, 0.01, frequencies[power.argmax()], 0.5 * begin)
    (_, a, b, _, _), covariance = curve_fit(model, time, kinetic, start, sigma=None, absolute_sigma=False)
    amplitude = float(np.hypot(a, b))
    direction = np.array([a, b]) / amplitude
    error = np.sqrt(direction @ covariance[1:3, 1:3] @ direction)
    return {"ringing": Estimate(amplitude, error, len(time) - len(start))}


def layer_fractions(point: Point, layers: int) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Compute the fraction of the first species in equal layers of the container, (layers,).

    The error is the binomial error of a single frame. Frames of one sample are close in time, so that the
    composition of a layer is nearly the same in all. The source has one frame.
    """
    column, [sample] = field(point), stretches(point, 1)
    grid = Grid.line(-0.5 * column.diameter, column.height + 0.5 * column.diameter, layers)
    cells = grid.cells(sample.heights[..., None])
    first, second = (grid.sums(cells[:, column.species == kind]) / len(cells) for kind in (0, 1))
    share = first / (first + second)
    return {"share": (share, np.sqrt(share * (1.0 - share) / (first + second)))}


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
"""Dimensions, in addition to point, of the arrays of `profiles`."""


def barometric(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure density, temperature and pressure against height for one kind of discs.

    See `profiles`. Further settings are `source_collisions` and `source_temperature` of the source's sample.
    """
    dataset = profiles(points, settings, ringing)
    return dataset.assign_attrs(
        source_collisions=settings["source_collisions"], source_temperature=settings["source_temperature"]
    )


def separation(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure profiles of heavy and light discs of one size, and the slope of their ratio.

    See `profiles`. Further settings are `source_collisions`, the number before the source's sample, and
    `source_shares`, the fractions of light discs in equal layers of the container.
    """
    shares = settings["source_shares"]
    dataset = profiles(points, settings, lambda point: layer_fractions(point, len(shares)))
    return dataset.assign_attrs(source_collisions=settings["source_collisions"], source_shares=shares)


def profiles(points: list[Point], settings: dict, of_source: Callable[[Point], dict]) -> xr.Dataset:
    """Measure columns of discs of one size under gravity, point by point.

    The settings are:

    bins : number of bins of height
    blocks : number of time blocks of each replica
    clear : distance from floor and ceiling, in diameters, that is left out of comparisons because of layers
    ranges : pairs of packing fractions between which the equation of state is averaged
    columns : experiment of each column, by name

    `of_source` returns further numbers of the column "source".

    The dimensions are point, species, bin, range, and layer (for the source's shares). Variables include:

    pressure_ratio : pressure that supports the weight above, divided by rho T Z(eta) of the reference
    slope_ratio : slope of ln eta_i + mu_excess against height, divided by -m_i g / T
    exchange_ratio : slope of ln (eta_1 / eta_0), divided by -(m_1 - m_0) g / T

    The exchange ratio of particles of one size is exact at any density. For given positions, the energy of
    interaction does not depend on which particles are heavy.
    """
    names = {experiment: name for name, experiment in settings["columns"].items()}

    def column(point: Point) -> dict[str, Any]:
        name = names.get(point.experiment, "")
        own = {"collisions": collisions(point), **of_source(point)} if name == "source" else {}
        return {"column": name, **_column(point, settings), **own}

    low, high = np.array(settings["ranges"], dtype=float).T
    dataset = table("point", points, column, inner=INNER).set_coords("column")
    dataset = dataset.assign_coords(range_low=("range", low), range_high=("range", high))
    return dataset.assign_attrs(clear=settings["clear"])


@dataclass(frozen=True)
class Bins:
    """Bins of height of one column, and quantities computed from averages in the bins.

    column : the column and its particles. masses : (S,), masses of the species. height, width : (B,), heights
    of the middles of bins, and width of a bin. used : (B,), True for bins away from floor and ceiling.

    Arguments of the methods are averages over time: density (S, B), energy (B,), which is density times
    temperature, pressure (B,), and the temperature of the entire column.
    """

    column: Field
    masses: np.ndarray
    height: np.ndarray
    width: float
    used: np.ndarray

    @classmethod
    def of(cls, column: Field, number: int, clear: float) -> Bins:
        """Return `number` bins; bins within `clear` diameters of floor or ceiling are not used."""
        grid = Grid.line(0.0, column.height, number)
        height, width = grid.middles[0], grid.volume
        margin = clear * column.diameter + 0.5 * width
        masses = [column.masses[column.species == n][0] for n in range(int(column.species.max()) + 1)]
        used = (height > margin) & (height < column.height - margin)
        return cls(column, np.array(masses), height, width, used)

    def packing_fraction(self, density: np.ndarray) -> np.ndarray:
        """Compute the total packing fraction (B,) of all species."""
        return density.sum(axis=0) * particle_volume(2, self.column.diameter)

    def pressure_ratio(self, density: np.ndarray, pressure: np.ndarray, energy: np.ndarray) -> np.ndarray:
        """Compute pressure (B,) divided by the reference at this density and temperature."""
        return pressure / (energy * compressibility_factor(self.packing_fraction(density), 2))

    def slope_ratio(self, density: np.ndarray, temperature: float) -> np.ndarray:
        """Compute slopes of ln eta_i + mu_excess(eta), divided by -m_i g / T, shape (S,)."""
        volume = particle_volume(2, self.column.diameter)
        excess = excess_chemical_potential(self.packing_fraction(density), 2)
        with np.errstate(divide="ignore"):
            slopes = [self._slope(np.log(row * volume) + excess, row) for row in density]
        return -np.array(slopes) * temperature / (self.masses * self.column.strength)

    def log_ratio(self, density: np.ndarray) -> np.ndarray:
        """Compute ln of the last species' density divided by the first species' density, (B,)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.log(density[-1] / density[0])

    def exchange_ratio(self, density: np.ndarray, temperature: float) -> float:
        """Compute the slope of `log_ratio` over -(M - m) g / T; NaN for one species."""
        if self.masses.size < 2:
            return np.nan
        slope = self._slope(self.log_ratio(density), density[0] * density[-1] / density.sum(axis=0))
        return -slope * temperature / ((self.masses[-1] - self.masses[0]) * self.column.strength)

    def temperature_gradient(self, energy: np.ndarray, density: np.ndarray) -> float:
        """Compute dT/dz divided by the mean weight of a particle.

        The result equals d ln T / dz in units of the inverse scale height.
        """
        total = density.sum(axis=0)
        return self._slope(energy / total, total) / (self.column.weight / len(self.column.masses))

    def mean_height_ratio(self, height: np.ndarray, temperature: float) -> np.ndarray:
        """Compute mean heights (S,) divided by the mean heights in ideal gases."""
        return height / ideal_mean_height(
            self.column.height, self.masses * self.column.strength / temperature
        )

    def exchange_line(self, value: np.ndarray, error: np.ndarray, temperature: float) -> np.ndarray:
        """Compute a line for `log_ratio` (B,) with the exact slope.

        The line passes through the weighted mean over the used bins.
        """
        line = -(self.masses[-1] - self.masses[0]) * self.column.strength / temperature * self.height
        usable = self.used & np.isfinite(error) & (error > 0.0)
        if self.masses.size < 2 or not usable.any():
            return line
        return line + np.average((value - line)[usable], weights=1.0 / error[usable] ** 2)

    def hydrostatics(self, density: np.ndarray, temperature: float) -> np.ndarray:
        """Compute hydrostatic densities (S, B) with the actual numbers of particles in used bins.

        There is a number for each species.
        """
        first, last = np.flatnonzero(self.used)[[0, -1]]
        z = np.linspace(first, last + 1, 8 * (last - first + 1) + 1) * self.width
        numbers = density[:, self.used].sum(axis=1) * self.width
        weights = self.masses * self.column.strength / temperature
        curves = hydrostatic_profiles(z, numbers, weights, 2, self.column.diameter)
        densities = np.full(density.shape, np.nan)
        densities[:, self.used] = [np.interp(self.height[self.used], z, curve) for curve in curves]
        return densities

    def _slope(self, y: np.ndarray, weight: np.ndarray) -> float:
        """Fit the slope of a line to the used bins that have particles.

        Variances are proportional to 1 / weight.
        """
        seen = self.used & (weight > 0.0)
        return float(np.polyfit(self.height[seen], y[seen], 1, w=np.sqrt(weight[seen]))[0])


def _column(point: Point, settings: dict) -> dict[str, Any]:
    """Return the numbers of one point."""
    column, blocks = field(point), stretches(point, settings["blocks"])
    bins = Bins.of(column, settings["bins"], settings["clear"])
    parts = [profile(column, stretch, settings["bins"]) for stretch in blocks]
    density = np.array([part.density for part in parts])
    pressure = np.array([part.pressure for part in parts])
    # A block without particles in a bin has no temperature in this bin, and weight 0.
    energy = np.array([np.nan_to_num(part.temperature) * part.density.sum(axis=0) for part in parts])
    warm = np.array([stretch.temperature for stretch in blocks])
    own = [column.species == n for n in range(bins.masses.size)]
    heights = np.array([[stretch.heights[:, kind].mean() for kind in own] for stretch in blocks])
    kinetic = np.array([[stretch.energies[:, kind].mean() for kind in own] for stretch in blocks])
    eta = bins.packing_fraction(density.mean(axis=0))
    ranges = [bins.used & (eta >= low) & (eta < high) for low, high in settings["ranges"]]

    def range_ratio(*means: np.ndarray) -> np.ndarray:
        ratio = bins.pressure_ratio(*means)
        return np.array([ratio[mask].mean() if mask.any() else np.nan for mask in ranges])

    with np.errstate(invalid="ignore", divide="ignore"):  # empty bins
        averages = {
            "density": jackknife(lambda rho: rho, density),
            "packing_fraction": jackknife(bins.packing_fraction, density),
            "temperature": jackknife(lambda t: t, warm),
            "temperature_ratio": jackknife(lambda e, rho, t: e / rho.sum(axis=0) / t, energy, density, warm),
            "temperature_gradient": jackknife(bins.temperature_gradient, energy, density),
            "compressibility": jackknife(lambda e, p: p / e, energy, pressure),
            "pressure_ratio": jackknife(bins.pressure_ratio, density, pressure, energy),
            "range_ratio": jackknife(range_ratio, density, pressure, energy),
            "slope_ratio": jackknife(bins.slope_ratio, density, warm),
            "exchange_ratio": jackknife(bins.exchange_ratio, density, warm),
            "log_ratio": jackknife(bins.log_ratio, density),
            "mean_height_ratio": jackknife(bins.mean_height_ratio, heights, warm),
            "species_temperature_ratio": jackknife(lambda k: k / k[0], kinetic),
        }
    numbers = {name: Estimate(*pair, len(blocks) - 1) for name, pair in averages.items()}
    temperature = numbers["temperature"].value
    return numbers | {
        "height": bins.height,
        "used": bins.used,
        "mass": bins.masses,
        "strength": column.strength,
        "top": column.height,
        "count": len(column.masses),
        "mean_density": len(column.masses) / (column.width * column.height),
        "hydrostatic": bins.hydrostatics(numbers["density"].value, temperature),
        "log_ratio_expected": bins.exchange_line(*averages["log_ratio"], temperature),
        "imbalance": max(abs(s.floor - s.ceiling - column.weight - s.gain) / column.weight for s in blocks),
    }


def heat_capacity(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the heat capacity of a dilute gas under gravity in a box, in two ways.

    The box has a finite height H. The heat capacity is a function of x = m g H / (k_B T).

    Points come in pairs: one scene at two energies. The first method is C = dE/dT. The second method uses the
    fluctuations of the kinetic energy in each run at constant energy, `lebowitz_percus_verlet`. Variables
    `..._expected` are exact values for an ideal gas with the same particle number and energy. The setting is
    `blocks` of each replica.

    The dimensions are pair and run (of a pair). Raises ValueError for points that are not such pairs.
    """
    if len(points) % 2:
        raise ValueError(f"points: {len(points)} (must be pairs)")
    ends = [_energies(point, settings["blocks"]) for point in points]
    pairs = list(zip(ends[::2], ends[1::2], strict=True))
    if any(a["gravity"] != b["gravity"] for a, b in pairs) or len({end["count"] for end in ends}) > 1:
        raise ValueError("points: the two of a pair must differ in their energy only")
    of = list(zip(points[::2], points[1::2], strict=True))
    return table("pair", pairs, _pair, inner=("run",), of=of).assign_attrs(count=ends[0]["count"])


def _pair(ends: tuple[dict, dict]) -> dict[str, Any]:
    """Return the variables of two runs at two energies, and C = dE/dT from both."""
    cold, warm = ends
    both = {
        name: np.array([end[name] for end in ends]) for name in ("energy", "temperature_expected", "run_x")
    }
    rise = np.diff(both["energy"])[0] / cold["count"]
    return both | {
        "temperature": Estimate.stack([end["temperature"] for end in ends]),
        "fluctuation": Estimate.stack([end["fluctuation"] for end in ends]),
        "fluctuation_expected": np.array([end["fluctuation_expected"] for end in ends]),
        "slope": Estimate(rise) / (warm["temperature"] - cold["temperature"]),
        "slope_expected": rise / np.diff(both["temperature_expected"])[0],
        "x": both["run_x"].mean(),
        "gravity": cold["gravity"],
    }


def _energies(point: Point, blocks: int) -> dict[str, Any]:
    """Measure temperature and fluctuations of a point with one replica, with expected values."""
    column, scene = field(point), point.scene
    if point.replicas != 1 or column.across:
        raise ValueError(f"{point.path}: must be one run between walls, whose energy is known")
    start = initial_state(scene, point.seed(0))
    potential = column.masses @ (start.positions[:, 1] - 0.5 * column.diameter) * column.strength
    energy, count = start.kinetic_energy + potential, len(column.masses)
    force = column.weight / count
    [kinetic] = [run.data["kinetic_energy"].values[1:] for run in runs(point)]
    parts = kinetic[: len(kinetic) // blocks * blocks].reshape(blocks, -1) / count

    shift = parts.mean()  # squares of deviations lose no digits when the energy hardly changes
    fluctuation = jackknife(
        lambda mean, square: lebowitz_percus_verlet(
            count * (mean + shift), count**2 * (square - mean**2), count, 2
        ),
        (parts - shift).mean(axis=1),
        ((parts - shift) ** 2).mean(axis=1),
    )
    temperature = Estimate(*jackknife(lambda mean: mean, parts.mean(axis=1)), blocks - 1)
    mean, variance = ideal_energy_moments(float(energy), count, column.height, force, 2)
    return {
        "count": count,
        "gravity": column.strength,
        "energy": energy,
        "temperature": temperature,
        "fluctuation": Estimate(*fluctuation, blocks - 1),
        "temperature_expected": mean / count,
        "run_x": force * column.height / temperature.value,
        "fluctuation_expected": lebowitz_percus_verlet(mean, variance, count, 2),
    }
