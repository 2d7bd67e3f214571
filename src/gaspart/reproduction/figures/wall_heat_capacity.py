"""Heat capacity of a gas from the temperature of its walls, and from the fluctuations of its energy."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import fit_polynomial
from gaspart.keys import count
from gaspart.rendering import style
from gaspart.rendering.style import Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Blocks, Parts, runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, table
from gaspart.scene.boundaries import thermal_face

TITLE, CHAPTER = "Heat between walls", "Gravity, heat and walls"
SETTINGS = {"blocks": count("stretches of each replica")}
EXACT = "canonical distribution of velocities, whatever the density (exact): d/2"


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the mean energy of a particle, and the variance of the energy, at each temperature."""
    return table("point", points, _measure_point, settings["blocks"])


def _measure_point(point: Point, number: int) -> dict[str, Any]:
    scene, parts = point.scene, []
    for run in runs(point):
        energy = run.data["kinetic_energy"].values[1:] / scene.count
        for part in np.array_split(energy, number):
            parts.append((part.mean(), (part**2).mean()))
    each, temperature = Blocks(parts), thermal_face(scene, "x_low").temperatures[0]
    return {
        "temperature": temperature,
        "dimension": scene.dimension,
        "energy": each(lambda mean, _: mean),
        "fluctuation": each(lambda mean, square: scene.count * (square - mean**2) / temperature**2),
    }


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims on the slope of the energy, and on its fluctuations at each temperature."""
    points = Table(dataset, "point")
    exact = 0.5 * points.dimension[0]
    yield Claim(
        "heat capacity C_V/Nk as slope of the energy against the walls' temperature",
        fit_polynomial(points.temperature, points.energy).estimate(1), exact, 0.01, EXACT,
        "walls that send particles back at another temperature than theirs, by an amount that grows with it",
    )  # fmt: skip
    for row in points:
        yield Claim(
            f"heat capacity C_V/Nk from fluctuations of the energy, walls at {row.temperature:g}",
            row.fluctuation, exact, 0.1, f"{EXACT} = <dE^2>/(N (kT)^2)",
            "particles that exchange too little energy with the walls, or a run shorter than its memory",
        )  # fmt: skip


def draw(dataset: xr.Dataset) -> Figure:
    """Draw energy and heat capacity against the temperature of the walls."""
    figure, (energy, capacity) = style.new((2.2, 1.4))
    points = Table(dataset, "point")
    line, half = np.array([0.0, 1.1 * points.temperature.max()]), 0.5 * points.dimension[0]
    energy.plot(line, half * line, color=style.REFERENCE, label=r"$\frac{d}{2}\,kT$")
    style.points(energy, points.temperature, points.energy, color=style.DATA, label="measured")
    style.label_axes(energy, y=r"energy $E/N$", legend="upper left")
    style.level(capacity, half)
    style.points(capacity, points.temperature, points.fluctuation, color=style.DATA, hollow=True)
    labels = r"temperature of the walls $kT$", "$C_V/Nk$ from\nfluctuations"
    style.label_axes(capacity, *labels, xlim=tuple(line))
    style.letters(energy, capacity)
    return figure


FIGURES = {"wall_heat_capacity": Parts(SETTINGS, measure, claims, draw)}
