"""Heat conduction between two walls in gases and metals: fluxes, profiles, specific heat.

Positions are defined by `gap`. Runs are cut into blocks of time. The averages of blocks are assumed
independent. Errors are jackknife errors.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.series import Blocks
from gaspart.analysis.statistics import fit_polynomial, jackknife
from gaspart.reproduction.families.heat.gap import NO_APPROACH, Averages, Gap, approach, averages
from gaspart.reproduction.figure import runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, table
from gaspart.scene.faces import thermal_face
from gaspart.scene.scene import Scene
from gaspart.state.insertion import per_particle
from gaspart.theory.enskog import mean_free_path
from gaspart.theory.geometry import packing_fraction
from gaspart.theory.heat import Slab, conducting_slab, dilute_fourier_flux, free_molecular_flux

FLUID = 0.1
"""Largest Knudsen number of a gas that is compared with Fourier's law."""
_PROFILES = ("position", "used", "density", "temperature", "slab_density", "slab_temperature")
INNER = dict.fromkeys(_PROFILES, ("bin",)) | {name.removesuffix("_error"): ("frame",) for name in NO_APPROACH}
"""Dimensions, in addition to point, of the arrays of `heat_conduction_gas`."""


def heat_conduction_gas(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the heat flux through gases of one kind of particles, and their profiles.

    The settings are `bins` across the gap, `blocks` of each replica, and `clear`. `clear` is a distance from
    the walls, in mean free paths; this region is left out of comparisons with Fourier's law.

    The dimensions are point and bin. The suffix `_freedom` marks the degrees of freedom of an error `_error`.

    flux : steady flux through both walls
    wall_ratio : flux into the cold wall divided by the flux out of the hot wall
    half_ratio : flux in the second half of the run divided by the flux in the first half
    free : theoretical flux of particles that collide only with walls
    fourier : theoretical flux of a gas so dilute that only its conductivity matters

    Further variables are for gases in three dimensions between walls of full accommodation, at Knudsen
    numbers below FLUID.

    slab_flux : flux by Fourier's law with temperature jumps, with its profiles
    profile_ratio : mean of T divided by this theory
    jump : mean temperature jump over mean free path times slope, by linear extrapolation of T^(3/2)
    approach_time, approach, expected_approach : approach to the steady state over `frame`; see `approach`
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
    """Compare with Fourier's law with jumps, in the `used` bins."""
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
    """Compute the mean over both walls of |T_gas - T_wall| / (l dT/dx).

    The temperature of the gas is extrapolated from bins (B,) away from the walls.
    """
    slope, start = np.polyfit(position, (energy / density) ** 1.5, 1)
    power = start + slope * np.array([0.0, gap.length])
    gas = power ** (2.0 / 3.0)
    gradient = -slope / (1.5 * np.sqrt(gas))
    path = mean_free_path(packing_fraction(energy.mean() / gas, 3, diameter), 3, diameter)
    return float(np.mean(np.array([gap.hot - gas[0], gas[1] - gap.cold]) / (path * gradient)))


def heat_conduction_metal(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure electrons among fixed vibrating scatterers between two walls.

    Electrons are all moving particles. Profiles are measured between walls of different temperatures. The
    specific heat is measured between walls of equal temperature.

    The settings are `bins` across the gap, and `blocks` of a run. If there are several replicas, each is one
    block, and their scatter is the uncertainty. They differ in the positions of their scatterers, if these
    are random.

    The dimensions are point and bin.

    electrons : temperature of the electrons, over point and bin
    modes : mean energy of a vibrational mode, over point and bin
    share : `modes` divided by `electrons`, averaged over bins
    bend : second-order coefficient of the electrons' temperature against position
    hot, cold, flux, position : temperatures of the walls, heat flux, and positions
    expected : heat capacity N_e d/2 + N_s, with the part `electrons_part` of the electrons
    energy_ratio : E / T divided by `expected`, with T of the walls; NaN for different walls
    log_fluctuation : ln of var E / T^2 divided by `expected`; NaN for different walls
    mode_ratio : mean energy of all modes divided by T
    slope : dE/dT divided by `expected`, from a line through the points in equilibrium, at least two
    regular : True if scatterers are listed one by one, on a grid, instead of placed at random

    The variance of E is the mean square of the deviation from the known mean of E. Its estimate therefore has
    no bias, even if samples are correlated. Its logarithm is closer to a Gaussian number.
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

    The mean free path is exactly pi times the free area, divided by the total perimeter of the discs.
    """
    contact = per_particle(scene, "radius")[fixed] + scene.smallest_radius
    return float((gap.length * gap.area - np.pi * np.sum(contact**2)) / (2.0 * np.sum(contact)))


def _bend(kinetic: np.ndarray, number: np.ndarray) -> float:
    """Fit the second-order coefficient of the temperature against position in the gap.

    `kinetic` and `number` are sums in bins. The outermost bins are left out, because electrons come directly
    from the walls there. The result is NaN for fewer than five bins.
    """
    if number.size < 5:
        return np.nan
    position = (np.arange(number.size) + 0.5) / number.size
    return float(np.polyfit(position[1:-1], (kinetic / number)[1:-1], 2)[0])
