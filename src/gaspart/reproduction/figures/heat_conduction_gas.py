"""Heat conduction through gases between two walls: flux, profiles, and the approach to the steady state.

Runs are cut into blocks of time, whose averages are assumed independent; errors are jackknife errors.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from gaspart.analysis.estimate import Estimate
from gaspart.keys import count, positive
from gaspart.rendering import style
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Blocks, Parts, runs
from gaspart.reproduction.figures._gap import Gap, averages
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, table
from gaspart.scene.boundaries import thermal_face
from gaspart.theory.enskog import enskog_conductivity, mean_free_path
from gaspart.theory.geometry import packing_fraction
from gaspart.theory.heat import (
    ELEMENTARY_JUMP,
    TEMPERATURE_JUMP,
    Slab,
    conducting_slab,
    dilute_fourier_flux,
    free_molecular_flux,
    steady_part,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

TITLE, CHAPTER = "Heat between walls", "Gravity, heat and walls"
SETTINGS = {
    "bins": count("bins across the gap"),
    "blocks": count("stretches of each replica"),
    "clear": positive("mean free paths next to the walls that are left out, where no fluid theory holds"),
}
FLUID = 0.1
"""Largest Knudsen number of a gas that is compared with Fourier's law."""
FRAMES = 40
"""Number of frames at the start of a run that show the approach."""
HEAT_CAPACITY = 2.5
"""Heat capacity of a particle at constant pressure, in a dilute gas of spheres."""
_APPROACH = ("approach_time", "approach", "approach_error", "expected_approach")
_PROFILES = ("position", "used", "density", "temperature", "slab_density", "slab_temperature")
INNER = dict.fromkeys(_PROFILES, ("bin",)) | dict.fromkeys(_APPROACH, ("frame",))
"""Dimensions, in addition to point, of the arrays."""


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the heat flux through gases of one kind of particles, and their profiles. `free` is the flux of
    particles that collide only with these walls, `full` with walls that accommodate fully. Theory of a fluid
    (`slab_...`) is for spheres between such walls at Knudsen numbers below FLUID.
    """
    return table("point", points, _measure_gas, settings, inner=INNER)


def _measure_gas(point: Point, settings: dict) -> dict[str, Any]:
    scene = point.scene
    gap, diameter = Gap.of(scene), 2.0 * scene.smallest_radius
    means = averages(point, gap, settings["blocks"], settings["bins"])
    position, half = gap.grid(settings["bins"]).middles[0], len(means.heat_in) // 2
    number = scene.species[0].count / (gap.area * gap.length)
    path = float(mean_free_path(packing_fraction(number, gap.dimension, diameter), gap.dimension, diameter))
    clear, components = settings["clear"] * path, thermal_face(scene, "x_low").components
    each = Blocks(zip(means.energy, means.density, strict=True))
    used, spheres = (position > clear) & (position < gap.length - clear), gap.dimension == 3
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
        "density": each(lambda e, n: n),
        "temperature": each(lambda e, n: e / n),
        "free": free_molecular_flux(number, gap.hot, gap.cold, gap.dimension, components=components),
        "full": free_molecular_flux(number, gap.hot, gap.cold, gap.dimension),
        "fourier": dilute_fourier_flux(gap.length, gap.hot, gap.cold, diameter) if spheres else np.nan,
        "position": position,
        "used": used,
        **dict.fromkeys(("slab_flux", *_APPROACH), np.nan),
    }
    if path / gap.length >= FLUID or not spheres or components != "all":
        return row
    slab = conducting_slab(gap.length, number, gap.hot, gap.cold, diameter)
    expected = np.interp(position, slab.position, slab.temperature)
    return row | {
        "slab_flux": slab.flux,
        "slab_temperature": expected,
        "slab_density": np.interp(position, slab.position, slab.density),
        "profile_ratio": each(lambda e, n: float((e / n / expected)[used].mean())),
        "jump": each(
            lambda energy, density: jump(gap, position[used], energy[used], density[used], diameter)
        ),
        **approach(point, slab),
    }


def jump(gap: Gap, position: np.ndarray, energy: np.ndarray, density: np.ndarray, diameter: float) -> float:
    """Compute the mean over both walls of |T_gas - T_wall| / (l dT/dx). T^(3/2) of the gas is extrapolated
    from bins (B,) away from the walls.
    """
    slope, start = np.polyfit(position, (energy / density) ** 1.5, 1)
    power = start + slope * np.array([0.0, gap.length])
    gas = power ** (2.0 / 3.0)
    gradient = -slope / (1.5 * np.sqrt(gas))
    path = mean_free_path(packing_fraction(energy.mean() / gas, 3, diameter), 3, diameter)
    return float(np.mean(np.array([gap.hot - gas[0], gas[1] - gap.cold]) / (path * gradient)))


def approach(point: Point, slab: Slab) -> dict[str, np.ndarray]:
    """Measure the temperature of the half at the hot wall less that of the other, from a uniform start on.
    Standard errors of the mean over replicas are for Maxwellian velocities of spheres of mass 1; squares of
    their components have the relative variance 2.
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
    return {
        "approach_time": time,
        "approach": np.mean(differences, axis=0),
        "approach_error": np.sqrt(np.sum(variances, axis=0)) / len(variances),
        "expected_approach": _expected_approach(time, slab, float(density), 2.0 * scene.smallest_radius),
    }


def _expected_approach(time: np.ndarray, slab: Slab, density: float, diameter: float) -> np.ndarray:
    """Compute `approach` by the heat equation, with the conductivity at the mean density and temperature. The
    difference converges to its value in the steady `slab`. Temperature jumps at the walls increase the
    effective gap.
    """
    hot, halves = slab.position < 0.5 * slab.position[-1], []
    for side in (hot, ~hot):
        position, number = slab.position[side], slab.density[side]
        heat = np.trapezoid(number * slab.temperature[side], position)
        halves.append(float(heat / np.trapezoid(number, position)))
    eta = packing_fraction(density, 3, diameter)
    temperature = 0.5 * (slab.temperature[0] + slab.temperature[-1])
    conductivity = enskog_conductivity(eta, 3, diameter, temperature)
    length = slab.position[-1] + 2.0 * TEMPERATURE_JUMP * mean_free_path(eta, 3, diameter)
    diffusivity = float(conductivity / (HEAT_CAPACITY * density))
    return (halves[0] - halves[1]) * steady_part(time, float(length), diffusivity)


FREE = 100.0
"""Knudsen number above which collisions between particles are negligible; points are drawn at infinity."""
FOURIER = "Fourier's law with Enskog's conductivity and temperature jumps ([Sone 1989])"
NEGLECTED = "the square of the Knudsen number, which an asymptotic theory of first order in it neglects"


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims on steady flux, limits, profile, and the source's rule."""
    for row in Table(dataset, "point"):
        rule = "normal component only" if row.normal else "full accommodation"
        at = f"{row.dimension}D, {rule}, Knudsen number {row.knudsen:.2g}"
        yield Claim.at_most(
            f"|heat from the walls - energy of the particles| over the transferred heat, {at}",
            Estimate(row.imbalance, 1e-7), 1e-6, 1e-6, "conservation of energy (exact)",
            "heat of walls that is not what particles gain and lose there", "identity",
        )  # fmt: skip
        # both fluxes are counted at wall hits: they differ by the energy that the gas stores
        yield Claim(
            f"flux into the cold over flux out of the hot wall, {at}", row.wall_ratio, 1.0, 0.02,
            "a steady state", "a gas that still warms up or cools down", "identity",
        )  # fmt: skip
        yield Claim(
            f"flux in the second over that in the first half of the run, {at}", row.half_ratio, 1.0, 0.06,
            "a steady state", "a profile that is not yet stationary",
        )  # fmt: skip
        if row.knudsen > FREE:
            share = f"{2 if row.normal else row.dimension + 1}/{row.dimension + 1}"
            yield Claim(
                f"flux over n (d + 1) sqrt(T1 T2 / 2 pi m) (sqrt T1 - sqrt T2), {at}",
                row.flux / row.full, row.free / row.full, 0.01,
                f"particles that collide with walls only: {share} (exact)",
                "outgoing velocities that are not weighted by the flux, or a component that is not drawn",
            )  # fmt: skip
        if np.isfinite(row.slab_flux):
            yield from _claim_fluid(row, at)


def _claim_fluid(row: Row, at: str) -> Iterator[Claim]:
    square = row.knudsen**2
    yield Claim(
        f"flux over that of theory, {at}", row.flux / row.slab_flux, Estimate(1.0, square), 0.02, FOURIER,
        "a conductivity that is not that of hard spheres, or walls that do not accommodate",
        allowance_source=NEGLECTED,
    )  # fmt: skip
    yield Claim(
        f"temperature away from the walls over that of theory, {at}",
        row.profile_ratio, Estimate(1.0, square), 0.01, FOURIER,
        "a profile that is not that of a conductivity growing as sqrt T", allowance_source=NEGLECTED,
    )  # fmt: skip
    yield Claim(
        f"temperature jump over mean free path times slope, {at}",
        row.jump, Estimate(TEMPERATURE_JUMP, TEMPERATURE_JUMP * square), 0.3,
        "[Sone 1989], linear in the slope",
        "a gas that has the temperature of the wall, or one that the wall does not warm",
        allowance_source=NEGLECTED, alternative=ELEMENTARY_JUMP,
    )  # fmt: skip


NOISY = 0.03
"""Relative error above which a density profile is not drawn."""


def draw(dataset: xr.Dataset) -> Figure:
    """Draw flux against density and Knudsen number, the approach to a steady state, and profiles."""
    figure, axes = style.new((2.5,), (2.3,), (1.8,), (2.7, 1.3, 2.6))
    flux, share, start, warm, off, dense = axes
    gases = Table(dataset, "point")
    crowded = gases[gases.knudsen < FREE]
    _draw_fluxes(flux, crowded)
    _draw_shares(share, gases)
    spheres = crowded[~crowded.normal.astype(bool)].sorted_by("knudsen")
    for kind, n in enumerate(dict.fromkeys((0, len(spheres) // 2, len(spheres) - 1))):
        _draw_profiles(warm, off, dense, spheres[n], kind)
    _draw_approach(start, spheres[0])
    style.level(off, 0.0)
    for wall in (gases.hot[0], gases.cold[0]):
        warm.axhline(wall, color=style.GREY, lw=0.6, ls=":")
    style.label_axes(warm, y="temperature $T$", legend="upper right")
    style.label_axes(off, y=r"$T/T_\mathrm{th}-1$ (%)", ylim=(-2.5, 2.5))
    style.label_axes(dense, "position between the walls $x/L$", r"density $n/\bar n$")
    style.letters(flux, share, start, warm, dense)
    return figure


def _draw_fluxes(axis: Axes, gases: Table) -> None:
    first, number = gases[0], np.geomspace(5e-4, 0.08, 100)
    free, fourier = number / first.number * first.full, first.fourier
    axis.plot(number, 1e3 * free, color=style.GREY, label="free flight")
    axis.axhline(1e3 * fourier, color=style.GREY, ls="--", lw=1.0, label=r"Fourier, $\lambda_0$")
    axis.plot(number, 1e3 / (1.0 / free + 1.0 / fourier), color=style.GREY, ls=":", label="guide")
    fluid = gases.number[np.isfinite(gases.slab_flux)]
    if fluid.size:
        line = np.geomspace(fluid.min(), fluid.max(), 5)
        theory = [1e3 * _conducted_flux(first.length, n, first.hot, first.cold) for n in line.tolist()]
        axis.plot(line, theory, color=style.DATA, label="with jumps", zorder=4)
    for kind, name in enumerate(("all components", "normal only")):
        own = gases[gases.normal == kind]
        style.points(axis, own.number, 1e3 * own.flux, kind=kind, hollow=bool(kind), label=name)
    axis.set(xscale="log", yscale="log", ylim=(0.2, 12.0))
    axis.tick_params(axis="x", which="minor", labelbottom=False)
    labels = r"number density $n\sigma^3$", r"heat flux $q$ ($10^{-3}$ reduced units)"
    style.label_axes(axis, *labels)
    axis.legend(loc="lower right", ncol=2, columnspacing=0.8)


@cache
def _conducted_flux(length: float, number: float, hot: float, cold: float) -> float:
    """Compute the flux of `conducting_slab`; each value takes a second."""
    return conducting_slab(length, number, hot, cold).flux


def _draw_shares(axis: Axes, gases: Table) -> None:
    end = 20.0
    for level in (1.0, 2.0 / 3.0, 0.5):
        style.level(axis, level)
    for kind, (normal, dimension, name) in enumerate(
        ((0, 3, "all, spheres"), (1, 3, "normal, spheres"), (0, 2, "all, discs"), (1, 2, "normal, discs"))
    ):
        own = gases[(gases.normal == normal) & (gases.dimension == dimension)]
        if not own:
            continue
        knudsen = np.where(own.knudsen < FREE, own.knudsen, end * 1.15 ** (dimension - 2.5))
        style.points(axis, knudsen, own.flux / own.full, kind=kind, hollow=bool(normal), label=name)
    axis.set(xscale="log", xlim=(0.02, 40.0))
    axis.set_xticks([0.1, 1.0, end], ["0.1", "1", r"$\infty$"])
    axis.set_yticks([0.0, 0.5, 2.0 / 3.0, 1.0], ["0", "1/2", "2/3", "1"])
    style.label_axes(axis, r"Knudsen number $l/L$", "flux / free-flight flux", ylim=(0.0, 1.6))
    axis.legend(loc="upper right", ncol=2, columnspacing=0.8)


def _draw_approach(axis: Axes, gas: Row) -> None:
    look: dict[str, Any] = {"hollow": True, "markersize": 2.5, "label": rf"$l/L = {gas.knudsen:.2g}$"}
    style.points(axis, gas.approach_time, gas.approach, **look)
    theory: dict[str, Any] = {"color": style.DATA, "zorder": 4, "label": "heat equation"}
    axis.plot(gas.approach_time, gas.expected_approach, **theory)
    difference = r"$T_\mathrm{hot\,half}-T_\mathrm{cold\,half}$"
    style.label_axes(axis, "time $t$ (reduced units)", difference, "lower right")


def _draw_profiles(warm: Axes, off: Axes, dense: Axes, gas: Row, kind: int) -> None:
    position = gas.position / gas.length
    small: dict[str, Any] = {"kind": kind, "hollow": True, "markersize": 2.5}
    style.points(warm, position, gas.temperature, label=rf"$l/L = {gas.knudsen:.2g}$", **small)
    density = gas.density / gas.number
    if np.median(density.error) < NOISY:
        style.points(dense, position, density, **small)
    if not np.isfinite(gas.slab_flux):
        return
    theory = gas.slab_temperature
    warm.plot(position, theory, color=style.DATA, zorder=4, label="Fourier with jumps")
    dense.plot(position, gas.slab_density / gas.number, color=style.DATA, zorder=4)
    deviation = 100.0 * (gas.temperature / theory - 1.0)
    style.points(off, position[gas.used], deviation[gas.used], **small)


FIGURES = {"heat_conduction_gas": Parts(SETTINGS, measure, claims, draw, key=3)}
