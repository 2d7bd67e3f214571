"""Electrons among fixed vibrating scatterers between two walls: heat flux, profiles, specific heat.

Electrons are all moving particles. Profiles are measured between walls of different temperatures, the
specific heat between walls of equal temperature. Blocks of time are assumed independent; of several replicas,
which may differ in the places of their scatterers, each is one block. Errors are jackknife errors.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from gaspart.analysis import series
from gaspart.analysis.statistics import fit_polynomial
from gaspart.keys import count
from gaspart.rendering import style
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.figure import Blocks, Parts, runs
from gaspart.reproduction.figures._gap import Gap
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, table
from gaspart.state.insertion import per_particle
from gaspart.theory.heat import METAL_BEND, METAL_BEND_ERROR, METAL_GAP

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TITLE, CHAPTER = "Heat between walls", "Gravity, heat and walls"
SETTINGS = {
    "bins": count("bins across the gap"),
    "blocks": count("stretches of a run; of several replicas each is one block"),
}


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure temperatures of electrons and modes, energies over the `expected` heat capacity, and dE/dT.
    `regular` is True if scatterers are listed one by one, on a grid, instead of placed at random.
    """
    dataset = table("point", points, measure_metal, settings, inner=("bin",))
    metals = Table(dataset, "point")
    still = metals[metals.hot == metals.cold]
    energy = still.energy_ratio * still.hot
    fit = fit_polynomial(still.hot, energy.value, energy.error, powers=(0, 1))
    return dataset.assign(slope=fit.values[1], slope_error=fit.errors[1])


def measure_metal(point: Point, settings: dict) -> dict[str, Any]:
    """Measure one point. The variance of E is the mean square of the deviation from the known mean of E. Its
    estimate therefore has no bias, even if samples are correlated. Its logarithm is closer to a Gaussian
    number.
    """
    scene = point.scene
    gap, fixed = Gap.of(scene), per_particle(scene, "fixed").astype(bool)
    capacity = 0.5 * gap.dimension * np.sum(~fixed) + np.sum(fixed)
    grid, of_runs = gap.grid(settings["bins"]), []
    for run in runs(point):
        parts = series.Blocks(run, settings["blocks"] if point.replicas == 1 else 1)
        cells = grid.cells(run.positions[:, :, :1] - scene.smallest_radius, inside=True)
        here, there = cells[:, ~fixed], cells[:, fixed]
        speeds = (run.velocities[:, ~fixed] ** 2).sum(axis=2)
        vibrations = run.data["vibrations"].values[:, fixed].astype(float)
        energy = 0.5 * speeds.sum(axis=1) + vibrations.sum(axis=1)
        into = parts.growth("wall_energy")[:, :2] / gap.area
        of_runs.append((
            parts.sums(grid, here, speeds / gap.dimension),
            parts.sums(grid, here, None),
            parts.sums(grid, there, vibrations),
            parts.sums(grid, there, None),
            parts.means_of_frames(energy),
            parts.means_of_frames((energy - capacity * gap.hot) ** 2),
            parts.means_of_frames(vibrations.mean(axis=1)),
            into[:, 0],
            into[:, 1],
        ))  # fmt: skip
    each = Blocks(zip(*map(np.concatenate, zip(*of_runs, strict=True)), strict=True))
    warm = gap.hot if gap.hot == gap.cold else np.nan
    # The mean free path among discs is exactly pi times the free area, divided by their total perimeter.
    contact = per_particle(scene, "radius")[fixed] + scene.smallest_radius
    path = float((gap.length * gap.area - np.pi * np.sum(contact**2)) / (2.0 * np.sum(contact)))
    return {
        "electrons": each(lambda k, n, *_: k / n),
        "modes": each(lambda k, n, v, s, *_: v / s),
        "share": each(lambda k, n, v, s, *_: (v / s * n / k).mean()),
        "flux": each(lambda *means: 0.5 * (means[-1] - means[-2])),
        "bend": each(lambda k, n, *_: bend(k / n)),
        "energy_ratio": each(lambda *means: means[4] / (capacity * warm)),
        "log_fluctuation": each(lambda *means: np.log(means[5] / (capacity * warm**2))),
        "mode_ratio": each(lambda *means: means[6] / warm),
        "electrons_part": 1.0 - np.sum(fixed) / capacity,
        "expected": capacity,
        "gap_over_path": gap.length / path,
        "regular": bool(scene.particles),
        "hot": gap.hot,
        "cold": gap.cold,
        "position": grid.middles[0] / gap.length,
    }


def bend(temperature: np.ndarray) -> float:
    """Fit the second-order coefficient of the temperature against position in the gap. The outermost bins are
    left out, because electrons come directly from the walls there. The result is NaN for fewer than five
    bins.
    """
    if temperature.size < 5:
        return np.nan
    position = (np.arange(temperature.size) + 0.5) / temperature.size
    return float(np.polyfit(position[1:-1], temperature[1:-1], 2)[0])


CHANNELS = 0.1
"""Upper bound of the relative increase of the flux by channels of a grid, compared with randomly placed
scatterers. Electrons that fly from wall to wall add w/a (sqrt(1 + (L/w)^2) - L/w) = 0.008 of the flux of free
flight. This is 0.06 of the flux (gap L = 40, channels of width w = 1.18 with period a = 2.22). The rest of
the bound is for flights that end in the gap."""


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims on equipartition of electrons and modes, Dulong and Petit's law, and effects of a grid."""
    points = Table(dataset, "point")
    law = f"N_e d/2 + N_s = {points.expected[0]:g} (classical statistical mechanics, exact)"
    conducting = {}
    for row in points:
        if row.hot == row.cold:
            yield from _claim_isothermal(row, law)
            continue
        conducting[bool(row.regular)] = row
        arrangement = "on a grid" if row.regular else "at random places"
        yield Claim.within(
            f"energy of a mode over the temperature of the electrons around it, scatterers {arrangement}",
            row.share, 1.0, 0.05, "local equilibrium, to the square of the slope over a mean free path",
            "modes that do not take the temperature of the electrons",
        )  # fmt: skip
        # On a grid electrons fly far in channels, so that their temperature is not local. For other walls and
        # gaps theory has not been computed.
        if not row.regular and row.hot == 2.0 * row.cold and abs(row.gap_over_path / METAL_GAP - 1.0) <= 0.1:
            slope, level = np.polyfit(row.position[1:-1], row.electrons.value[1:-1], 1)
            yield Claim(
                "second-order coefficient of the electrons' temperature against position over the gap",
                row.bend, Estimate(row.cold * METAL_BEND, row.cold * METAL_BEND_ERROR), 0.1 * row.cold,
                "the Boltzmann equation of electrons and modes (tests/theory/electrons.py)",
                "electrons that conduct as a gas does, whose T^(3/2) is linear",
                allowance_source="the statistical error of its direct simulation",
                alternative=-0.25 * slope**2 / (level + 0.5 * slope),
            )  # fmt: skip
    if len(conducting) == 2:
        yield Claim.within(
            "flux among scatterers on the source's grid over that at random places",
            conducting[True].flux / conducting[False].flux, 1.0 + 0.5 * CHANNELS, 0.5 * CHANNELS,
            "channels between the rows of a grid lengthen flights, few of which reach from wall to wall",
            "electrons that fly along the channels for ever, or that a grid holds up",
        )  # fmt: skip
    yield Claim(
        "heat capacity dE/dT from runs at several temperatures", points.slope, 1.0, 0.02, law,
        "modes that freeze out, or take more than kT",
    )  # fmt: skip


def _claim_isothermal(row: Row, law: str) -> Iterator[Claim]:
    at, unequal = f"T = {row.hot:g}", "energy that electrons, modes and walls do not share as kT per mode"
    yield Claim(
        f"mean energy of a mode over kT of the walls, {at}", row.mode_ratio, 1.0, 0.01,
        "equipartition, <E> = kT", unequal,
    )  # fmt: skip
    yield Claim(f"E / T over the heat capacity, {at}", row.energy_ratio, 1.0, 0.01, law, unequal)
    yield Claim(
        f"ln of var E / T^2 over the heat capacity, {at}", row.log_fluctuation, 0.0, 0.1, law,
        "modes whose energies do not fluctuate", alternative=math.log(row.electrons_part),
    )  # fmt: skip


def draw(dataset: xr.Dataset) -> Figure:
    """Draw temperatures of electrons and modes at random places between walls, and energy by temperature."""
    figure, (top, bottom, off) = style.new((3.0,), (2.2, 1.2))
    points = Table(dataset, "point")
    for metal in points[(points.hot != points.cold) & ~points.regular.astype(bool)]:
        for kind, (energy, label) in enumerate(((metal.electrons, "electrons"), (metal.modes, "modes"))):
            style.points(top, metal.position, energy, kind=kind, hollow=bool(kind), label=label)
        for wall in (metal.hot, metal.cold):
            top.axhline(wall, color=style.GREY, lw=0.6, ls=":")
    labels = "position between the walls $x/L$", r"$T$ of electrons, $\langle E\rangle$ of modes"
    style.label_axes(top, *labels, legend="upper right")
    still = points[points.hot == points.cold]
    warm, electrons = still.hot, points.electrons_part[0]
    line = np.array([0.0, 1.1 * warm.max()])
    bottom.plot(line, line, color=style.REFERENCE, label=r"$(N_e d/2 + N_s)\,kT$")
    style.points(bottom, warm, still.energy_ratio * warm, kind=1, label="electrons and modes")
    bottom.plot(line, electrons * line, color=style.GREY, ls="--", label="frozen modes")
    style.label_axes(bottom, y=rf"energy / {points.expected[0]:g}", legend="upper left")
    style.level(off, 0.0)
    style.points(off, warm, 100.0 * (still.energy_ratio - 1.0), kind=1)
    style.points(off, 1.02 * warm, 100.0 * (still.mode_ratio - 1.0), kind=0, hollow=True)
    style.label_axes(off, "temperature of both walls $kT$", "deviation (%)", ylim=(-3.5, 3.5))
    style.letters(top, bottom)
    return figure


FIGURES = {"heat_conduction_metal": Parts(SETTINGS, measure, claims, draw, key=1)}
