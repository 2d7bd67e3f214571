"""Pressure on the walls of containers by the momentum that they receive, beside theory with surface terms.

Units are the particles' diameter, mass and temperature. Along a periodic axis the total momentum is
conserved: the temperature is then that of velocities relative to the centre of mass.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.run import Run
from gaspart.analysis.series import face_pressures
from gaspart.analysis.statistics import average, combine_estimates, correlated_mean, fit_power_law
from gaspart.errors import SceneError
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import PARTICLES, Parts, runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, table

TITLE, CHAPTER = "Pressure on walls and pistons", "Equation of state and structure"
UNITS = {"length": "diameters", "density": "1 / sigma^d", "temperature": "scene's energy"}
UNITS |= dict.fromkeys(("pressure", "whole_pressure", "bulk_pressure", "expected"), "k_B T / sigma^d")


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the mean force on a wall over the area that centres can reach, and over its full area. `axes`
    have walls, `length` apart. `bulk_pressure` is that of an infinite fluid of the density N / V. Raises
    SceneError for containers without walls, or with different distances of walls.
    """
    return table("point", points, _row, units=UNITS)


def _row(point: Point) -> dict:
    scene = point.scene
    dimension, count, diameter = scene.dimension, scene.count, 2.0 * scene.largest_radius
    lengths = np.array(scene.container.lengths) / diameter
    walled = ~np.array(scene.container.periodic)
    if not walled.any() or np.ptp(lengths[walled]) > 1e-9 * lengths.max():
        raise SceneError(point.path, scene.container.boundary, "needs walls, all of one distance")
    touched = np.where(walled, lengths - 1.0, lengths)
    length, axes = float(lengths[walled][0]), int(walled.sum())
    replicas = [replica(run) for run in runs(point)]
    accessible = [pressures * diameter**dimension / temperature for pressures, temperature, _ in replicas]
    pressure = average([correlated_mean(series).estimate for series in accessible])
    share = touched.prod() / touched[walled][0] * lengths[walled][0] / lengths.prod()
    density = count / float(lengths.prod())
    eta = float(theory.packing_fraction(density, dimension))
    return {
        "pressure": pressure,
        "expected": theory.wall_pressure(length, count / touched.prod(), count, dimension, axes),
        "whole_pressure": pressure.value * share,
        "bulk_pressure": density * float(theory.compressibility_factor(eta, dimension)),
        "density": density,
        "packing_fraction": eta,
        "temperature": float(np.mean([temperature for _, temperature, _ in replicas])),
        "hits": float(sum(hits for _, _, hits in replicas)),
        "count": count,
        "dimension": dimension,
        "axes": axes,
        "length": length,
    }


def replica(run: Run) -> tuple[np.ndarray, float, int]:
    """Return the mean wall pressure (samples,), temperature and number of hits of a replica."""
    walled = np.repeat(~run.periodic, 2)
    hits = run.increments("wall_hits")[:, : 2 * run.dimension].sum()
    return face_pressures(run)[:, walled].mean(axis=1), run.temperature, hits


REQUIRED = 1e-3  # relative
THEORY = (
    "bulk equation of state; surfaces, edges and corners of the container to fifth order in the "
    "density, by cluster integrals (gaspart.theory.film); canonical ensemble to first order in 1/N"
)
ALLOWANCE = "surfaces, edges and corners: a sixth order as large as the larger of the two before"
FAILS_IF = "wall collisions are missed or counted twice, or the wrong area, volume or density is taken"
LESS_CERTAIN = "surfaces and edges are less certain than the measurement, by an estimate of what is left out"


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims that the pressure is that of theory, needs its surface terms, and is proportional to T."""
    table = Table(dataset, "point")
    slits, closed = table[table.axes < table.dimension], table[table.axes == table.dimension]
    for dimension, part in slits.by("dimension"):
        yield from _between_walls(part, dimension)
    for one in closed:
        ratio, expected = (number / one.expected.value for number in (one.pressure, one.expected))
        yield Claim(
            f"pressure of {one.count} {PARTICLES[one.dimension]} in a closed container over theory's, "
            f"packing fraction {one.packing_fraction:.2g}",
            ratio, expected, REQUIRED, THEORY, FAILS_IF, allowance_source=ALLOWANCE,
            no_verdict=LESS_CERTAIN if expected.error > ratio.error else "",
        )  # fmt: skip
    small = closed.count == np.where(closed.dimension == 2, 100, 125)
    for dimension, naive in closed[small & (abs(closed.packing_fraction - 0.1) < 0.005)].by("dimension"):
        one = naive[0]
        yield Claim.at_most(
            f"bulk pressure at N/V over that on the walls of {one.count} {PARTICLES[dimension]}, "
            "packing fraction 0.1",
            one.bulk_pressure / one.pressure, 0.95 if dimension == 2 else 0.8, 0.01,
            "the accessible volume is smaller than the container's: -7 % (discs), -34 % (spheres)",
            "the pressure on walls does not depend on the particles' size",
        )  # fmt: skip
    for *_, part in table.by("axes", "dimension", table.density.round(9)):
        if part.temperature.max() < 2.0 * part.temperature.min():
            continue
        pressure = part.pressure * part.temperature
        law = fit_power_law(part.temperature, pressure.value, pressure.error)
        yield Claim(
            f"exponent of P against T at packing fraction {part.packing_fraction[0]:.3g}",
            Estimate(law.exponent, law.exponent_error), 1.0, 2e-3,
            "hard particles have no energy scale (exact)",
            "the program has a hidden energy or time scale",
            kind="identity",
        )  # fmt: skip


def _between_walls(slits: Table, dimension: int) -> Iterator[Claim]:
    ratio, expected = slits.pressure / slits.expected.value, slits.expected / slits.expected.value
    mean = combine_estimates(Estimate(ratio.value, ratio.error))
    measured, allowance = Estimate(mean.value, mean.error), ratio.weights @ expected.error
    name = f"pressure of {PARTICLES[dimension]} between two walls"
    yield Claim(
        f"{name} over theory's, mean of {len(slits)} slits",
        measured, Estimate(1.0, allowance), REQUIRED, THEORY, FAILS_IF, allowance_source=ALLOWANCE,
        no_verdict=LESS_CERTAIN if dimension == 2 and allowance > measured.error else "",
    )  # fmt: skip
    yield Claim.joint(
        f"{name} against theory's", (slits.pressure - slits.expected).deviation, THEORY,
        "an error that grows with density, or wrong error bars",
    )  # fmt: skip


Z = r"$P/(n k_\mathrm{B}T)$"


def draw(dataset: xr.Dataset) -> Figure:
    """Draw P/(n k T) against T and packing fraction, raw and corrected, and residuals."""
    figure, panels = style.new((2.0,), (2.4, 1.7))
    for part, panel in zip((_temperatures, _densities, _residuals), panels, strict=True):
        part(panel, Table(dataset, "point"))
    style.letters(*panels)
    return figure


def _temperatures(axis: Axes, table: Table) -> None:
    """Draw P / (n k T) against T, at the densities that have several temperatures."""
    series = [(n, part) for n, part in table.by(table.density.round(9)) if np.ptp(part.temperature) > 1.0]
    for kind, (n, part) in enumerate(series):
        part = part.sorted_by("temperature")
        line = np.array([0.0, 1.1 * part.temperature.max()])
        axis.plot(line, np.full(2, part.expected.value[0] / n), color=style.COLOURS[kind], zorder=1)
        label = rf"$\eta={part.packing_fraction[0]:.2g}$"
        style.points(axis, part.temperature, part.pressure / n, kind=kind, label=label)
    if series:
        axis.plot(line, np.ones(2), color=style.GREY, linestyle=":", label="ideal gas")
        axis.set_xlim(0.0, line[1])
    axis.set_ylim(bottom=0.8)
    style.label_axes(axis, r"temperature $T$", Z, "lower right" if series else "")


def _densities(axis: Axes, table: Table) -> None:
    """Draw P / (n k T) by the full area of walls (hollow), and corrected to the infinite fluid."""
    for kind, (dimension, part) in enumerate(table.by("dimension")):
        eta, name = part.packing_fraction, PARTICLES[dimension]
        curve = np.linspace(1e-3, 1.05 * eta.max(), 200)
        z = theory.compressibility_factor(curve, dimension)
        axis.plot(curve, z, color=style.COLOURS[kind], zorder=1, label=f"{name}, bulk")
        raw = part.whole_pressure / part.density
        style.points(axis, eta, raw, kind=kind, hollow=True, label=f"{name}, uncorrected")
        corrected = part.pressure / part.expected.value * part.bulk_pressure / part.density
        style.points(axis, eta, corrected, kind=kind, label=f"{name}, corrected")
    style.level(axis, 1.0)
    style.label_axes(axis, y=Z, legend="lower right")


def _residuals(axis: Axes, table: Table) -> None:
    style.level(axis, 0.0)
    for kind, (dimension, part) in enumerate(table.by("dimension")):
        for closed, containers in part.by(part.axes == dimension):
            # Shifted slightly: many containers have the same packing fraction.
            eta = containers.packing_fraction + 0.003 * closed
            label = f"{PARTICLES[dimension]}, {'closed' if closed else 'slit'}"
            style.points(axis, eta, _excess(containers), kind=kind, hollow=closed, label=label)
    excess = _excess(table)
    widest = 1.2 * float(np.max(np.abs(excess.value) + excess.error))
    axis.set(ylim=(-widest, 1.6 * widest), xlim=(0.0, 0.43))
    labels = r"packing fraction $\eta$ of the container", r"$P/P_\mathrm{theory}-1$  (%)"
    style.label_axes(axis, *labels, legend="upper left", columns=2)


def _excess(table: Table) -> Estimate:
    """Return 100 (P / theory - 1) with both uncertainties."""
    both = table.pressure + Estimate(0.0, table.expected.error)
    return 100.0 * (both / table.expected.value - 1.0)


FIGURES = {"wall_pressure": Parts({}, measure, claims, draw, key=1)}
