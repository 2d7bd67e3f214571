"""Heat between two walls, through gases and metals: fluxes, profiles, and specific heat.

Positions are defined by `gap`. Runs are cut into blocks of time, whose averages are taken as independent;
errors are the jackknife's.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.series import Blocks
from gaspart.analysis.statistics import fit_polynomial, jackknife
from gaspart.reproduction.families.heat.gap import NO_APPROACH, Averages, Gap, approach, averages
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, table
from gaspart.scene.faces import thermal_face
from gaspart.scene.scene import Scene
from gaspart.state.insertion import per_particle
from gaspart.theory.enskog import mean_free_path
from gaspart.theory.geometry import packing_fraction
from gaspart.theory.heat import Slab, conducting_slab, dilute_fourier_flux, free_molecular_flux

FLUID = 0.1
"""Knudsen number up to which a gas is compared with Fourier's law."""
_PROFILES = ("position", "used", "density", "temperature", "slab_density", "slab_temperature")
INNER = dict.fromkeys(_PROFILES, ("bin",)) | {name.removesuffix("_error"): ("frame",) for name in NO_APPROACH}
"""The further dimension of the arrays of `heat_conduction_gas`."""


def heat_conduction_gas(points: list[Point], settings: dict) -> xr.Dataset:
    """Return the heat flux through gases of one kind of particles, and their profiles.

    settings: `bins` across the gap; `blocks` of each replica; `clear`, the mean free paths next to the walls
    that are left out where profiles are compared with Fourier's law.

    Dimensions point, bin; `_error` and `_freedom`, the degrees of freedom of the error. `flux` is the steady
    flux through both walls, `wall_ratio` cold over hot, `half_ratio` the second over the first half of the
    run; `free` and `fourier` theory's fluxes for particles that collide with nothing but walls, and for a gas
    so dilute that only its conductivity counts. Where the Knudsen number is below FLUID, three dimensions,
    walls of full accommodation: `slab_flux` of Fourier's law with jumps, its profiles, `profile_ratio` the
    mean of T over it, and `jump`, the temperature jumps in units of the mean free path times the slope:
    T^(3/2), a straight line away from the walls, continued to both of them. Of these gases, over `frame`, how
    they come to the steady state (see `approach`): approach_time, approach, and expected_approach.
    """
    return table("point", points, _gas, settings, inner=INNER)


def _gas(point: Point, settings: dict) -> dict[str, Any]:
    """Return the numbers of one point."""
    scene = point.scene
    gap, diameter = Gap.of(scene), 2.0 * scene.smallest_radius
    means = averages(point, gap, settings["blocks"], settings["bins"])
    position, half = gap.grid(settings["bins"]).middles[0], len(means.heat_in) // 2
    number = scene.species[0].count / (gap.area * gap.length)
    path = float(mean_free_path(packing_fraction(number, gap.dimension, diameter), gap.dimension, diameter))
    clear, components = settings["clear"] * path, thermal_face(scene, "x_low").components
    unknown = Estimate(np.nan, np.nan, len(means.heat_in) - 1)
    spheres = gap.dimension == 3
    row = {
        "dimension": gap.dimension,
        "normal": components == "normal",
        "number": number,
        "knudsen": path / gap.length,
        "length": gap.length,
        "hot": gap.hot,
        "cold": gap.cold,
        "imbalance": means.imbalance,
        "flux": means.flux(),
        "wall_ratio": means.wall_ratio(),
        "half_ratio": means.flux(slice(half, None)) / means.flux(slice(half)),
        "density": jackknife(lambda n: n, means.density),
        "temperature": jackknife(lambda e, n: e / n, means.energy, means.density),
        "free": free_molecular_flux(number, gap.hot, gap.cold, gap.dimension, components=components),
        "full": free_molecular_flux(number, gap.hot, gap.cold, gap.dimension),
        "fourier": dilute_fourier_flux(gap.length, gap.hot, gap.cold, diameter) if spheres else np.nan,
        "position": position,
        "used": (position > clear) & (position < gap.length - clear),
        "slab_flux": np.nan,
        **dict.fromkeys(("slab_temperature", "slab_density"), np.full(position.shape, np.nan)),
        **dict.fromkeys(("profile_ratio", "jump"), unknown),
        **NO_APPROACH,
    }
    if path / gap.length < FLUID and spheres and components == "all":
        slab = conducting_slab(gap.length, number, gap.hot, gap.cold, diameter)
        return row | _against(slab, gap, means, row["used"], diameter) | approach(point, slab)
    return row


def _against(slab: Slab, gap: Gap, means: Averages, used: np.ndarray, diameter: float) -> dict[str, Any]:
    """Compare with Fourier's law with jumps, in the bins that are `used`."""
    position, freedom = gap.grid(used.size).middles[0], len(means.heat_in) - 1
    temperature = np.interp(position, slab.position, slab.temperature)

    def ratio(energy: np.ndarray, density: np.ndarray) -> float:
        return float((energy / density / temperature)[used].mean())

    def jump(energy: np.ndarray, density: np.ndarray) -> float:
        return _jump(gap, position[used], energy[used], density[used], diameter)

    return {
        "slab_flux": slab.flux,
        "slab_temperature": temperature,
        "slab_density": np.interp(position, slab.position, slab.density),
        "profile_ratio": Estimate(*jackknife(ratio, means.energy, means.density), freedom),
        "jump": Estimate(*jackknife(jump, means.energy, means.density), freedom),
    }


def _jump(gap: Gap, position: np.ndarray, energy: np.ndarray, density: np.ndarray, diameter: float) -> float:
    """Compute the mean over the walls of |T_gas - T_wall| / (l dT/dx).

    The bins (B,) are away from the walls.
    """
    slope, start = np.polyfit(position, (energy / density) ** 1.5, 1)
    power = start + slope * np.array([0.0, gap.length])
    gas = power ** (2.0 / 3.0)
    gradient = -slope / (1.5 * np.sqrt(gas))
    path = mean_free_path(packing_fraction(energy.mean() / gas, 3, diameter), 3, diameter)
    return float(np.mean(np.array([gap.hot - gas[0], gas[1] - gap.cold]) / (path * gradient)))


def heat_conduction_metal(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure electrons among fixed vibrating scatterers between two walls.

    Electrons are all particles that move. Profiles are measured between walls of two temperatures, the
    specific heat between walls of one.

    The settings are `bins` across the gap; `blocks` of a run. Several replicas, which differ in the places of
    their scatterers if these are random, are one block each: their scatter is the uncertainty. `expected` is
    the heat capacity N_e d/2 + N_s, `electrons_part` the part of the electrons.

    Dimensions point, bin: electrons, the temperature of the electrons; modes, the mean energy of a mode; and
    `share`, the mean over the bins of modes over electrons; `bend`, the second-order coefficient of the
    electrons' temperature against position; hot, cold, flux, position. Over point too: energy_ratio, E / T
    over the expected heat capacity, log_fluctuation, the logarithm of var E / T^2 over it (both with T of the
    walls, and NaN between different ones; the variance about the known mean, which has no bias where samples
    are correlated, and whose logarithm is closer to Gaussian), mode_ratio, the mean energy of all modes over
    T. `slope` is dE/dT over the expected, from a line through the points in equilibrium, of which there must
    be two. `regular` are points whose scatterers are given one by one, on a grid, instead of placed at
    random.
    """
    ds = table("point", points, _metal, settings, inner=("bin",))
    metals = Table(ds, "point")
    still = metals[metals.hot == metals.cold]
    energy = still.energy_ratio * still.hot
    fit = fit_polynomial(still.hot, energy.value, energy.error, powers=(0, 1))
    return ds.assign(slope=fit.values[1], slope_error=fit.errors[1])


def _metal(point: Point, settings: dict) -> dict[str, Any]:
    """Return the numbers of one point."""
    scene = point.scene
    gap, fixed = Gap.of(scene), per_particle(scene, "fixed").astype(bool)
    bins, blocks = settings["bins"], settings["blocks"] if point.replicas == 1 else 1
    capacity = 0.5 * gap.dimension * np.sum(~fixed) + np.sum(fixed)
    tables, totals, squares, heats, modes = [], [], [], [], []
    grid = gap.grid(bins)
    for run in runs(point):
        parts = Blocks(run, blocks)
        cells = grid.cells(run.positions[:, :, :1] - scene.smallest_radius, inside=True)
        here, there = cells[:, ~fixed], cells[:, fixed]
        speeds = (run.velocities[:, ~fixed] ** 2).sum(axis=2)
        vibrations = run.data["vibrations"].values[:, fixed].astype(float)
        table = [
            parts.sums(grid, where, weights)
            for where, weights in (
                (here, None),
                (here, speeds / gap.dimension),
                (there, None),
                (there, vibrations),
            )
        ]
        tables.append(np.stack(table, axis=1))
        energy = 0.5 * speeds.sum(axis=1) + vibrations.sum(axis=1)
        totals.append(parts.means_of_frames(energy))
        squares.append(parts.means_of_frames((energy - capacity * gap.hot) ** 2))
        modes.append(parts.means_of_frames(vibrations.mean(axis=1)))
        heats.append(parts.growth("wall_energy")[:, :2] / gap.area)
    particles, kinetic, scatterers, vibrating = np.moveaxis(np.concatenate(tables), 1, 0)
    into_hot, into_cold = np.concatenate(heats).T
    total, square, mode = (np.concatenate(values) for values in (totals, squares, modes))
    warm = gap.hot if gap.hot == gap.cold else np.nan
    numbers = {
        "electrons": jackknife(lambda k, n: k / n, kinetic, particles),
        "modes": jackknife(lambda v, s: v / s, vibrating, scatterers),
        "share": jackknife(
            lambda k, n, v, s: (v / s * n / k).mean(), kinetic, particles, vibrating, scatterers
        ),
        "flux": jackknife(lambda out, into: 0.5 * (into - out), into_hot, into_cold),
        "bend": jackknife(_bend, kinetic, particles),
        "energy_ratio": jackknife(lambda e: e / (capacity * warm), total),
        "mode_ratio": jackknife(lambda e: e / warm, mode),
        "log_fluctuation": jackknife(lambda q: np.log(q / (capacity * warm**2)), square),
    }
    return {name: Estimate(*pair, len(total) - 1) for name, pair in numbers.items()} | {
        "electrons_part": 1.0 - np.sum(fixed) / capacity,
        "expected": capacity,
        "gap_over_path": gap.length / _path(scene, gap, fixed),
        "regular": bool(scene.particles),
        "hot": gap.hot,
        "cold": gap.cold,
        "position": grid.middles[0] / gap.length,
    }


def _path(scene: Scene, gap: Gap, fixed: np.ndarray) -> float:
    """Compute the mean free path of electrons among discs.

    It is pi times the free area over the discs' perimeter (exact).
    """
    contact = per_particle(scene, "radius")[fixed] + scene.smallest_radius
    return float((gap.length * gap.area - np.pi * np.sum(contact**2)) / (2.0 * np.sum(contact)))


def _bend(kinetic: np.ndarray, number: np.ndarray) -> float:
    """Fit the second-order coefficient of the temperature against position over the gap.

    The sums are in bins, without the outermost, where electrons come from a wall directly; NaN for fewer than
    five bins.
    """
    if number.size < 5:
        return np.nan
    position = (np.arange(number.size) + 0.5) / number.size
    return float(np.polyfit(position[1:-1], (kinetic / number)[1:-1], 2)[0])
