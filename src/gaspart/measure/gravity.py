"""Gases under gravity: profiles of one and of two kinds of discs, and the heat capacity.

Every run is cut into stretches of time, `blocks` of a replica; the stretches of all replicas are taken as
independent, and errors are the jackknife's over them. The temperature is always that of the kinetic energy.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart import grid
from gaspart.initial import initial_state
from gaspart.measure.columns import Field, field, profile, stretches, temperature
from gaspart.statistics import jackknife
from gaspart.theory.geometry import body_volume
from gaspart.theory.gravity import (
    excess_chemical_potential,
    hydrostatic_profiles,
    ideal_energy_moments,
    ideal_mean_height,
    lebowitz_percus_verlet,
)
from gaspart.theory.state import compressibility_factor
from gaspart.trajectory import open_trajectory


def barometric(points: list[grid.Point], settings: dict) -> xr.Dataset:
    """Density, temperature and pressure against height of one kind of discs; see `profiles`."""
    return profiles(points, settings)


def separation(points: list[grid.Point], settings: dict) -> xr.Dataset:
    """The same of heavy and light discs of one size, and the slope of their ratio; see `profiles`."""
    return profiles(points, settings)


def profiles(points: list[grid.Point], settings: dict) -> xr.Dataset:
    """Columns of discs of one size under gravity, point by point.

    settings: `bins` of height; `blocks`, the stretches of each replica; `clear`, the diameters next to floor
    and ceiling that are left out of every comparison (layers there are real, and not hydrostatics); `ranges`,
    pairs of packing fractions between which the equation of state is averaged.

    Dimensions point, species, bin, range. `pressure_ratio` is the pressure that carries the weight of what is
    above over rho T Z(eta) of the reference; `slope_ratio` that of ln eta_i + mu_excess against height over
    -m_i g / T; `exchange_ratio` that of ln (eta_1 / eta_0) over -(m_1 - m_0) g / T, which for bodies of one
    size is exact at any density: given their places, which of them is heavy has no other energy.
    """
    rows = [_column(point, settings) for point in points]
    axes = {
        "density": ("species", "bin"),
        "hydrostatic": ("species", "bin"),
        "temperature_ratio": ("bin",),
        "packing_fraction": ("bin",),
        "compressibility": ("bin",),
        "pressure_ratio": ("bin",),
        "range_ratio": ("range",),
        "height": ("bin",),
        "used": ("bin",),
        "mass": ("species",),
        "slope_ratio": ("species",),
        "mean_height_ratio": ("species",),
        "species_temperature_ratio": ("species",),
        "log_ratio": ("bin",),
        "log_ratio_expected": ("bin",),
    }
    values = {}
    for name in rows[0]:
        own = axes.get(name.removesuffix("_error"), ())
        values[name] = (("point", *own), np.stack([row[name] for row in rows]))
    low, high = np.array(settings["ranges"], dtype=float).T
    return xr.Dataset(
        values,
        coords={
            "experiment": ("point", [point.experiment for point in points]),
            "range_low": ("range", low),
            "range_high": ("range", high),
        },
        attrs={"clear": settings["clear"]},
    )


def _column(point: grid.Point, settings: dict) -> dict:
    """The numbers of one point."""
    place, bins = field(point), settings["bins"]
    found = stretches(point, settings["blocks"])
    temperatures = np.array([temperature(place, stretch) for stretch in found])
    parts = [profile(place, stretch, bins) for stretch in found]
    density = np.array([part.density for part in parts])
    pressure = np.array([part.pressure for part in parts])
    kinds = density.shape[1]
    masses = np.array([place.masses[place.species == n][0] for n in range(kinds)])
    width = place.height / bins
    height = (np.arange(bins) + 0.5) * width
    margin = settings["clear"] * place.diameter
    used = (height - 0.5 * width > margin) & (height + 0.5 * width < place.height - margin)
    volume = body_volume(2, place.diameter)
    eta = density.mean(axis=0).sum(axis=0) * volume
    ranges = [used & (eta >= low) & (eta < high) for low, high in settings["ranges"]]

    def pressure_ratio(density, pressure, energy):
        eta = density.sum(axis=0) * volume
        return pressure / (energy * compressibility_factor(eta, 2))

    def range_ratio(*means):
        ratio = pressure_ratio(*means)
        return np.array([ratio[mask].mean() if mask.any() else np.nan for mask in ranges])

    def slope_ratio(density, temperature):
        potential = np.log(density * volume) + excess_chemical_potential(density.sum(axis=0) * volume, 2)
        slopes = [_slope(height, values, row, used) for values, row in zip(potential, density, strict=True)]
        return -np.array(slopes) * temperature / (masses * place.strength)

    def log_ratio(density):
        return np.log(density[-1] / density[0])

    def exchange_ratio(density, temperature):
        if kinds < 2:
            return np.nan
        weight = density[0] * density[-1] / density.sum(axis=0)
        slope = _slope(height, log_ratio(density), weight, used)
        return -slope * temperature / ((masses[-1] - masses[0]) * place.strength)

    def gradient(energy, density, temperature):
        total = density.sum(axis=0)
        slope = _slope(height, energy / total, total, used)
        return slope / (place.weight / len(place.masses))

    # The temperature of a bin where a stretch found nothing is not known: weights say how much it counts.
    energies = np.array([np.nan_to_num(part.temperature) * part.density.sum(axis=0) for part in parts])
    means = np.array([[s.heights[:, place.species == n].mean() for n in range(kinds)] for s in found])
    hot = np.array([[s.energies[:, place.species == n].mean() for n in range(kinds)] for s in found])
    made = {
        "density": jackknife(lambda rho: rho, density),
        "packing_fraction": jackknife(lambda rho: rho.sum(axis=0) * volume, density),
        "temperature": jackknife(lambda t: t, temperatures),
        "temperature_ratio": jackknife(
            lambda e, rho, t: e / (rho.sum(axis=0) * t), energies, density, temperatures
        ),
        "compressibility": jackknife(lambda e, p: p / e, energies, pressure),
        "pressure_ratio": jackknife(pressure_ratio, density, pressure, energies),
        "range_ratio": jackknife(range_ratio, density, pressure, energies),
        "temperature_gradient": jackknife(gradient, energies, density, temperatures),
        "slope_ratio": jackknife(slope_ratio, density, temperatures),
        "exchange_ratio": jackknife(exchange_ratio, density, temperatures),
        "log_ratio": jackknife(log_ratio, density),
        "mean_height_ratio": jackknife(
            lambda z, t: z / ideal_mean_height(place.height, masses * place.strength / t), means, temperatures
        ),
        "species_temperature_ratio": jackknife(lambda e: e / e[0], hot),
    }
    row = {name: value for name, (value, _) in made.items()}
    row |= {f"{name}_error": error for name, (_, error) in made.items()}
    mean = float(temperatures.mean())
    return row | {
        "height": height,
        "used": used,
        "mass": masses,
        "strength": place.strength,
        "diameter": place.diameter,
        "top": place.height,
        "count": len(place.masses),
        "mean_density": len(place.masses) / (place.width * place.height),
        "blocks": len(found),
        "hydrostatic": _hydrostatics(place, row["density"], masses, mean, used, width),
        "log_ratio_expected": _exchange(made["log_ratio"], height, masses, place.strength / mean, used),
        "imbalance": max(abs(s.floor - s.ceiling - place.weight - s.gain) / place.weight for s in found),
    }


def _slope(x: np.ndarray, y: np.ndarray, weight: np.ndarray, used: np.ndarray) -> float:
    """Of the line fitted to the used points, whose variances are as 1 / weight."""
    return float(np.polyfit(x[used], y[used], 1, w=np.sqrt(weight[used]))[0])


def _exchange(log_ratio, height, masses, slope: float, used) -> np.ndarray:
    """(B,) ln of the last over the first kind's density: the exact slope, through the weighted mean."""
    value, error = log_ratio
    line = -(masses[-1] - masses[0]) * slope * height
    if masses.size < 2:
        return line
    return line + np.average((value - line)[used], weights=1.0 / error[used] ** 2)


def _hydrostatics(place: Field, density, masses, temperature: float, used, width: float) -> np.ndarray:
    """(S, B) hydrostatic densities between the first and the last used bin, with as many bodies there."""
    first, last = np.flatnonzero(used)[[0, -1]]
    fine = 8
    z = (np.arange(fine * (last - first + 1) + 1) / fine + first) * width
    numbers = density[:, first : last + 1].sum(axis=1) * width
    curves = hydrostatic_profiles(z, numbers, masses * place.strength / temperature, 2, place.diameter)
    shown = np.full(density.shape, np.nan)
    middle = (np.arange(first, last + 1) + 0.5) * width
    shown[:, first : last + 1] = [np.interp(middle, z, curve) for curve in curves]
    return shown


def heat_capacity(points: list[grid.Point], settings: dict) -> xr.Dataset:
    """Heat capacity of a dilute gas in a box of finite height, in two ways, against x = m g H / (k_B T).

    Points come in pairs of one scene at two energies. From them, C = dE/dT; and from the fluctuations of the
    kinetic energy in each run, at constant energy, `lebowitz_percus_verlet`. What an ideal gas of as many
    bodies and the same energy gives for both is exact: `..._expected`. settings: `blocks` of each replica.

    Dimensions pair, run (of a pair). Raises ValueError for points that are not such pairs.
    """
    if len(points) % 2:
        raise ValueError(f"points: {len(points)} (must be pairs)")
    runs = [_energies(point, settings["blocks"]) for point in points]
    names = list(runs[0])
    table = {name: np.array([run[name] for run in runs]).reshape(-1, 2) for name in names}
    if np.ptp(table["strength"], axis=1).any() or np.ptp(table["count"]).any():
        raise ValueError("points: the two of a pair must differ in their energy only")
    count = int(table["count"][0, 0])
    rise = np.diff(table["energy"], axis=1)[:, 0] / count
    step = np.diff(table["temperature"], axis=1)[:, 0]
    pairs = {
        "slope": rise / step,
        "slope_error": np.abs(rise) / step**2 * np.hypot(*table["temperature_error"].T),
        "slope_expected": rise / np.diff(table["temperature_expected"], axis=1)[:, 0],
        "x": table["run_x"].mean(axis=1),
    }
    values = {name: (("pair", "run"), table[name]) for name in names if name != "count"}
    return xr.Dataset(
        values | {name: ("pair", value) for name, value in pairs.items()}, attrs={"count": count}
    )


def _energies(point: grid.Point, blocks: int) -> dict:
    """Temperature, fluctuations and what they should be, of one point of a single replica."""
    place, scene = field(point), grid.scene(point)
    if point.replicas != 1 or place.across:
        raise ValueError(f"{point.path}: must be one run between walls, whose energy is known")
    start = initial_state(scene, point.seed(0))
    potential = place.masses @ (start.positions[:, 1] - 0.5 * place.diameter) * place.strength
    energy, count = start.kinetic_energy + potential, len(place.masses)
    force = place.weight / count
    with open_trajectory(point.replica_path(0)) as trajectory:
        kinetic = trajectory["kinetic_energy"].values[grid.schedule(point).equilibration_frames + 1 :]
    parts = kinetic[: len(kinetic) // blocks * blocks].reshape(blocks, -1) / count

    shift = parts.mean()  # the square of what is left loses no digits where the energy hardly changes
    fluctuation, spread = jackknife(
        lambda mean, square: lebowitz_percus_verlet(
            count * (mean + shift), count**2 * (square - mean**2), count, 2
        ),
        (parts - shift).mean(axis=1),
        ((parts - shift) ** 2).mean(axis=1),
    )
    temperature, error = jackknife(lambda mean: mean, parts.mean(axis=1))
    mean, variance = ideal_energy_moments(energy, count, place.height, force, 2)
    return {
        "count": count,
        "strength": place.strength,
        "energy": energy,
        "temperature": float(temperature),
        "temperature_error": float(error),
        "temperature_expected": mean / count,
        "run_x": force * place.height / float(temperature),
        "fluctuation": float(fluctuation),
        "fluctuation_error": float(spread),
        "fluctuation_expected": lebowitz_percus_verlet(mean, variance, count, 2),
    }
