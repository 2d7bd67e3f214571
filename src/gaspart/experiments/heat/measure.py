"""Heat between two walls, through gases and metals: fluxes, profiles, and what a degree of temperature costs.

The walls are the two faces of the first axis, whose positions count from the hot one on, where centres can
be. Runs are cut into stretches of time, whose averages are taken as independent; errors are the jackknife's.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import fit_polynomial, jackknife, steady_mean
from gaspart.experiments.heat.approach import NO_APPROACH, approach
from gaspart.planning import grid
from gaspart.scene.faces import thermal_face
from gaspart.scene.scene import Scene
from gaspart.state.insertion import per_body
from gaspart.theory.enskog import mean_free_path
from gaspart.theory.geometry import packing_fraction
from gaspart.theory.heat import conducting_slab, dilute_fourier_flux, free_molecular_flux
from gaspart.trajectory.run import open_trajectory

FLUID = 0.1
"""Knudsen number up to which a gas is compared with Fourier's law."""


@dataclass(frozen=True)
class Gap:
    """Between the walls: length, where centres can be; area of a wall; temperatures of the walls, the hot one
    is x_low; dimension."""

    length: float
    area: float
    hot: float
    cold: float
    dimension: int

    @classmethod
    def of(cls, scene: Scene) -> Gap:
        """That of a scene whose walls are thermal."""
        lower, upper = scene.reach(scene.smallest_radius)
        walls = thermal_face(scene, "x_low").temperature, thermal_face(scene, "x_high").temperature
        area = float(np.prod(scene.container.lengths[1:]))
        return cls(upper[0] - lower[0], area, *walls, scene.dimension)


@dataclass(frozen=True)
class Averages:
    """Averages over K time blocks: given (K,) and taken (K,), the fluxes out of the hot and into the cold
    wall; density (K, B) of particles in bins, energy (K, B) theirs per volume, as a temperature; imbalance,
    the largest difference between the energy given by the walls and that gained by the particles, over the
    heat conducted. stored (R, K/R + 1, 2): the particles' energy, and its first moment about the middle, at
    the ends of the blocks of each replica; heat: conducted in all."""

    given: np.ndarray
    taken: np.ndarray
    density: np.ndarray
    energy: np.ndarray
    imbalance: float
    stored: np.ndarray
    heat: float

    def flux(self, blocks: slice = slice(None)) -> Estimate:
        """The steady flux, from the mean of both walls in some of the blocks: without what changes the
        energy of the particles or moves it, which is bounded."""
        changes = np.diff(self.stored, axis=1).reshape(-1, 2)[blocks]
        return steady_mean(0.5 * (self.given + self.taken)[blocks], *changes.T)

    def wall_ratio(self) -> Estimate:
        """Heat into the cold over heat out of the hot wall. They differ by the energy that the particles have
        gained (exact), in a steady state the difference of independent energies at both ends of a replica."""
        replicas, ends, _ = self.stored.shape
        spread = self.stored[:, :, 0].std(axis=1, ddof=1)
        error = np.sqrt(2.0 * np.sum(spread**2)) / self.heat
        return Estimate(self.taken.sum() / self.given.sum(), error, replicas * (ends - 1))


def averages(point: grid.Point, gap: Gap, blocks: int, bins: int) -> Averages:
    """Of the measured part of all replicas of particles of mass 1, each cut into `blocks`.

    Raises ValueError for too few frames.
    """
    first = grid.schedule(point).equilibration_frames
    radius = grid.scene(point).smallest_radius
    heats, densities, energies, missing, stored, conducted = [], [], [], [], [], 0.0
    for path in point.replica_paths:
        with open_trajectory(path) as trajectory:
            part = trajectory.isel(frame=slice(first, None))
            time, heat, kinetic = (part[name].values for name in ("time", "wall_energy", "kinetic_energy"))
            places = part["coordinates"].values[:, :, 0]
            squares = (part["velocities"].values.astype(float) ** 2).sum(axis=2)
        length = (len(time) - 1) // blocks
        if length < 1:
            raise ValueError(f"blocks: {blocks} (more than the {len(time) - 1} intervals of {path})")
        used = length * blocks
        ends = heat[: used + 1 : length, :2]
        heats.append(np.diff(ends, axis=0) / np.diff(time[: used + 1 : length])[:, None] / gap.area)
        through = heat - heat[0]
        missing.append(abs(through.sum(axis=1) + kinetic - kinetic[0]).max() / abs(through[-1]).max())
        moment = 0.5 * (squares * (places - radius - 0.5 * gap.length)).sum(axis=1)
        stored.append(np.stack([kinetic, moment], axis=1)[: used + 1 : length])
        conducted += abs(ends[-1] - ends[0]).mean()
        places, squares = places[1:], squares[1:]
        bin_of = np.clip(((places - radius) * (bins / gap.length)).astype(int), 0, bins - 1)
        block_of = np.repeat(np.arange(blocks), length)[:, None] * bins
        slot = (bin_of[:used] + block_of).ravel()
        volume = length * gap.area * gap.length / bins
        densities.append(np.bincount(slot, minlength=blocks * bins).reshape(blocks, bins) / volume)
        weights = squares[:used].ravel() / gap.dimension
        energies.append(np.bincount(slot, weights, minlength=blocks * bins).reshape(blocks, bins) / volume)
    given, taken = np.concatenate(heats).T
    profiles = np.concatenate(densities), np.concatenate(energies)
    return Averages(-given, taken, *profiles, float(max(missing)), np.array(stored), float(conducted))


def heat_conduction_gas(points: list[grid.Point], settings: dict) -> xr.Dataset:
    """Flux through gases of one kind of particles, and their profiles.

    settings: `bins` across the gap; `blocks` of each replica; `clear`, the mean free paths next to the walls
    that are left out where profiles are compared with Fourier's law.

    Dimensions point, bin; `_error` and `_freedom`, the degrees of freedom of the error. `flux` is the steady
    flux through both walls, `wall_ratio` cold over hot, `half_ratio` the second over the first half of the
    run; `free` and `fourier` theory's fluxes for particles that collide
    with nothing but walls, and for a gas so dilute that only its conductivity counts. Where the Knudsen
    number is below FLUID, three dimensions, walls of full accommodation: `slab_flux` of Fourier's law with
    jumps, its profiles, `profile_ratio` the mean of T over it, and `jump`, the temperature jumps in units of
    the mean free path times the slope: T^(3/2), a straight line away from the walls, continued to both of
    them. Of these gases, over `frame`, how they come to the steady state (see `approach`): approach_time,
    approach, and expected_approach.
    """
    rows = [_gas(point, settings) for point in points]
    return xr.Dataset(
        {
            name: (_dimensions(name, value), np.stack([row[name] for row in rows]))
            for name, value in rows[0].items()
        }
    )


def _dimensions(name: str, value: ArrayLike) -> tuple[str, ...]:
    """Of a variable of `heat_conduction_gas`."""
    if not np.ndim(value):
        return ("point",)
    return ("point", "frame" if "approach" in name else "bin")


def _gas(point: grid.Point, settings: dict) -> dict:
    """The numbers of one point."""
    scene = grid.scene(point)
    gap, diameter = Gap.of(scene), 2.0 * scene.smallest_radius
    found = averages(point, gap, settings["blocks"], settings["bins"])
    position = (np.arange(settings["bins"]) + 0.5) * gap.length / settings["bins"]
    number = scene.species[0].count / (gap.area * gap.length)
    path = float(mean_free_path(packing_fraction(number, gap.dimension, diameter), gap.dimension, diameter))
    components = thermal_face(scene, "x_low").components
    half = len(found.given) // 2
    estimates = {
        "flux": found.flux(),
        "wall_ratio": found.wall_ratio(),
        "half_ratio": found.flux(slice(half, None)) / found.flux(slice(half)),
    }
    made = {
        "density": jackknife(lambda n: n, found.density),
        "temperature": jackknife(lambda e, n: e / n, found.energy, found.density),
    }
    row = {
        "dimension": gap.dimension,
        "normal": components == "normal",
        "number": number,
        "knudsen": path / gap.length,
        "length": gap.length,
        "hot": gap.hot,
        "cold": gap.cold,
        "imbalance": found.imbalance,
        "free": free_molecular_flux(number, gap.hot, gap.cold, gap.dimension, components=components),
        "full": free_molecular_flux(number, gap.hot, gap.cold, gap.dimension),
        "fourier": np.nan,
        "slab_flux": np.nan,
        "position": position,
        "slab_temperature": np.full(position.shape, np.nan),
        "slab_density": np.full(position.shape, np.nan),
        "used": (position > settings["clear"] * path) & (position < gap.length - settings["clear"] * path),
    } | NO_APPROACH
    made |= dict.fromkeys(("profile_ratio", "jump"), (np.nan, np.nan))
    if gap.dimension == 3:
        row["fourier"] = dilute_fourier_flux(gap.length, gap.hot, gap.cold, diameter)
    if row["knudsen"] < FLUID and gap.dimension == 3 and components == "all":
        slab = conducting_slab(gap.length, number, gap.hot, gap.cold, diameter)
        row |= {"slab_flux": slab.flux, **approach(point, slab)}
        for name in ("temperature", "density"):
            row[f"slab_{name}"] = np.interp(position, slab.position, getattr(slab, name))
        used = row["used"]
        made["profile_ratio"] = jackknife(
            lambda e, n: (e / n / row["slab_temperature"])[used].mean(), found.energy, found.density
        )
        made["jump"] = jackknife(
            lambda e, n: _jump(gap, position[used], e[used], n[used], diameter), found.energy, found.density
        )
    row |= {name: value for name, (value, _) in made.items()}
    row |= {f"{name}_error": error for name, (_, error) in made.items()}
    row |= dict.fromkeys(("profile_ratio_freedom", "jump_freedom"), len(found.given) - 1)
    for name, one in estimates.items():
        row |= {name: one.value, f"{name}_error": one.error, f"{name}_freedom": one.freedom}
    return row


def _jump(gap: Gap, position: np.ndarray, energy: np.ndarray, density: np.ndarray, diameter: float) -> float:
    """Mean over the walls of |T_gas - T_wall| / (l dT/dx), from bins (B,) away from them."""
    slope, start = np.polyfit(position, (energy / density) ** 1.5, 1)
    power = start + slope * np.array([0.0, gap.length])
    gas = power ** (2.0 / 3.0)
    gradient = -slope / (1.5 * np.sqrt(gas))
    path = mean_free_path(packing_fraction(energy.mean() / gas, 3, diameter), 3, diameter)
    return float(np.mean(np.array([gap.hot - gas[0], gas[1] - gap.cold]) / (path * gradient)))


def heat_conduction_metal(points: list[grid.Point], settings: dict) -> xr.Dataset:
    """Electrons, all particles that move, among fixed vibrating scatterers: profiles between walls of two
    temperatures, and the specific heat between walls of one.

    settings: `bins` across the gap; `blocks` of each replica. `expected` is the heat capacity N_e d/2 + N_s,
    `electrons_part` what the electrons have of it.

    Dimensions point, bin: electrons, the temperature of the electrons; modes, the mean energy of a mode; and
    `share`, the mean over the bins of modes over electrons; `bend`, the second-order coefficient of the
    electrons' temperature against position; hot, cold, flux, position. Over point
    too: energy_ratio, E / T over the expected heat capacity, log_fluctuation, the logarithm of var E / T^2
    over it (both with T of the walls, and NaN between different ones; the variance about the known mean,
    which has no bias where samples are correlated, and whose logarithm is closer to Gaussian),
    mode_ratio, the mean energy of all modes over T. `slope` is dE/dT over the expected, from a line
    through the points in equilibrium, of which there must be two. `regular` are points whose scatterers are
    given one by one, on a grid, instead of placed at random.
    """
    rows = [_metal(point, settings) for point in points]
    long = {name for name, value in rows[0].items() if np.ndim(value)}
    ds = xr.Dataset(
        {
            name: (("point", "bin") if name in long else "point", np.stack([row[name] for row in rows]))
            for name in rows[0]
        }
    )
    still = ds.isel(point=np.flatnonzero(ds["hot"] == ds["cold"]))
    warm, energy = still["hot"].values, (still["energy_ratio"] * still["hot"]).values
    fit = fit_polynomial(warm, energy, still["energy_ratio_error"].values * warm, powers=(0, 1))
    return ds.assign(slope=fit.values[1], slope_error=fit.errors[1])


def _metal(point: grid.Point, settings: dict) -> dict:
    """The numbers of one point."""
    scene = grid.scene(point)
    gap, fixed = Gap.of(scene), per_body(scene, "fixed").astype(bool)
    bins, blocks = settings["bins"], settings["blocks"]
    capacity = 0.5 * gap.dimension * np.sum(~fixed) + np.sum(fixed)
    first = grid.schedule(point).equilibration_frames
    sums, totals, squares, heats, modes = [], [], [], [], []
    for path in point.replica_paths:
        with open_trajectory(path) as trajectory:
            part = trajectory.isel(frame=slice(first, None))
            time, heat = part["time"].values, part["wall_energy"].values[:, :2]
            places = part["coordinates"].values[1:, :, 0]
            speeds = (part["velocities"].values[1:, ~fixed].astype(float) ** 2).sum(axis=2)
            vibrations = part["vibrations"].values[1:, fixed].astype(float)
        length = (len(time) - 1) // blocks
        if length < 1:
            raise ValueError(f"blocks: {blocks} (more than the {len(time) - 1} intervals of {path})")
        used = length * blocks
        bin_of = np.clip((places[:used] - scene.smallest_radius) * (bins / gap.length), 0, bins - 1).astype(
            int
        )
        slot = bin_of + np.repeat(np.arange(blocks), length)[:, None] * bins
        here, there = slot[:, ~fixed].ravel(), slot[:, fixed].ravel()
        table = [
            np.bincount(where, weights, minlength=blocks * bins).reshape(blocks, bins)
            for where, weights in (
                (here, None),
                (here, speeds[:used].ravel() / gap.dimension),
                (there, None),
                (there, vibrations[:used].ravel()),
            )
        ]
        sums.append(np.stack(table, axis=1))
        energy = (0.5 * speeds.sum(axis=1) + vibrations.sum(axis=1))[:used].reshape(blocks, length)
        totals.append(energy.mean(axis=1))
        squares.append(((energy - capacity * gap.hot) ** 2).mean(axis=1))
        modes.append(vibrations[:used].mean(axis=1).reshape(blocks, length).mean(axis=1))
        ends = slice(None, used + 1, length)
        heats.append(np.diff(heat[ends], axis=0) / np.diff(time[ends])[:, None] / gap.area)
    bodies, kinetic, scatterers, vibrating = np.moveaxis(np.concatenate(sums), 1, 0)
    given, taken = np.concatenate(heats).T
    total, square, mode = (np.concatenate(values) for values in (totals, squares, modes))
    made = {
        "electrons": jackknife(lambda k, n: k / n, kinetic, bodies),
        "modes": jackknife(lambda v, s: v / s, vibrating, scatterers),
        "share": jackknife(lambda k, n, v, s: (v / s * n / k).mean(), kinetic, bodies, vibrating, scatterers),
        "flux": jackknife(lambda out, into: 0.5 * (into - out), given, taken),
    }
    made["bend"] = jackknife(_bend, kinetic, bodies)
    warm = gap.hot if gap.hot == gap.cold else np.nan
    made["energy_ratio"] = jackknife(lambda e: e / (capacity * warm), total)
    made["mode_ratio"] = jackknife(lambda e: e / warm, mode)
    made["log_fluctuation"] = jackknife(lambda q: np.log(q / (capacity * warm**2)), square)
    row = {name: value for name, (value, _) in made.items()}
    row |= {f"{name}_error": error for name, (_, error) in made.items()}
    row |= {f"{name}_freedom": len(total) - 1 for name in made}
    row |= {"electrons_part": 1.0 - np.sum(fixed) / capacity, "expected": capacity}
    row["regular"] = bool(scene.bodies)
    return row | {"hot": gap.hot, "cold": gap.cold, "position": (np.arange(bins) + 0.5) / bins}


def _bend(kinetic: np.ndarray, number: np.ndarray) -> float:
    """Second-order coefficient of the temperature against position over the gap, from sums in bins, without
    the outermost, where electrons come from a wall directly; NaN for fewer than five bins."""
    if number.size < 5:
        return np.nan
    position = (np.arange(number.size) + 0.5) / number.size
    return float(np.polyfit(position[1:-1], (kinetic / number)[1:-1], 2)[0])
