"""Inelastic gases that random kicks heat: steady temperature, and deviation from Maxwell's distribution."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import mean_of
from gaspart.rendering import style
from gaspart.rendering.style import Figure
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.figure import PARTICLES, Parts, runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, table
from gaspart.theory.granular import driven_cumulant, finite_size_cumulant

TITLE, CHAPTER = "Granular gases", "Granular matter"


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure temperature, fourth cumulant and power of each gas, with errors from replicas."""
    units = {"temperature": "energy", **dict.fromkeys(("power", "given", "lost"), "energy / time")}
    return table("gas", points, _gas, units=units)


def _gas(point: Point) -> dict[str, Any]:
    scene = point.scene
    assert scene.restitution is not None and scene.thermostat is not None, "a driven granular gas"
    replicas = [means(run) for run in runs(point)]
    return {
        "dimension": scene.dimension,
        "restitution": scene.restitution.normal,
        "packing_fraction": scene.packing_fraction,
        "count": scene.count,
        "power": scene.thermostat.power,
    } | {name: mean_of([replica[name] for replica in replicas]) for name in replicas[0]}


def means(run: Run) -> dict[str, float]:
    """Compute temperature and cumulant in the frame of the centre of mass, and power per particle."""
    squares, dimension = (run.peculiar**2).sum(axis=2), run.dimension
    # computed in each frame, so that fluctuations of the temperature do not contribute
    second, fourth = squares.mean(axis=1), (squares**2).mean(axis=1)
    return {
        "temperature": run.temperature,
        "cumulant": float(dimension * fourth.mean() / ((dimension + 2) * (second**2).mean()) - 1.0),
        "given": float(run.growth("thermostat_energy")) / run.count,
        "lost": float(run.growth("dissipated_energy")) / run.count,
    }


HEATED = (
    "[van Noije 1998], first order in a2, derived again from the moments of the cooling gas; exact "
    "correction for the number of particles"
)


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims on the temperature at which collisions lose what kicks give, and on cumulants."""
    gases = Table(dataset, "gas")
    for gas in gases:
        e, dimension, power = gas.restitution, gas.dimension, gas.power
        which = f"{PARTICLES[dimension]}, restitution {e:g}"
        balance = float(theory.driven_temperature(e, dimension, power, gas.packing_fraction))
        cumulant = finite_size_cumulant(driven_cumulant(e, dimension), gas.count, dimension)
        yield Claim(
            f"steady temperature over that of the energy balance, {which}",
            gas.temperature / balance, 1.0, 0.015,
            "kicks against contacts at Enskog's rate; [van Noije 1998], first order in a2; no correlations, "
            "which amount to less than 0.2 % at this density",
            "kicks that give another energy, or contacts that lose another",
        )  # fmt: skip
        yield Claim(
            f"fourth cumulant of the velocities, {which}", gas.cumulant, float(cumulant), 0.01, HEATED,
            "a distribution that is not that of the heated gas",
        )  # fmt: skip
        yield Claim(
            f"energy given by kicks over the power of the thermostat, {which}",
            gas.given / (power * (1.0 - 1.0 / gas.count)), 1.0, 0.02,
            "exact, less the share 1/N of the centre of mass", "kicks of the wrong width, or too few of them",
            kind="identity",
        )  # fmt: skip
    for dimension, own in gases.by("dimension"):
        # All gases of a dimension by least squares; a single gas is not conclusive.
        heated, cooling = (
            finite_size_cumulant(of(own.restitution, dimension), own.count, dimension)
            for of in (driven_cumulant, theory.fourth_cumulant)
        )
        weight = (cooling - heated) / own.cumulant.error**2
        norm = float(weight @ (cooling - heated))
        yield Claim(
            f"fourth cumulants of {PARTICLES[dimension]} from those of the heated gas (0) to those of the "
            "cooling gas (1)",
            Estimate(weight @ (own.cumulant.value - heated) / norm, norm**-0.5), 0.0, 0.5, HEATED,
            "the distribution of the cooling gas", alternative=1.0, follows=True,
        )  # fmt: skip


def draw(dataset: xr.Dataset) -> Figure:
    """Draw the steady temperature over theory, and the fourth cumulant."""
    figure, (upper, lower) = style.new((2.5,), (2.5,))
    table = Table(dataset, "gas")
    curve = np.linspace(0.95 * table.restitution.min(), 1.0, 200)
    style.level(upper, 1.0)
    style.level(lower, 0.0)
    for kind, (dimension, gases) in enumerate(table.by("dimension")):
        e, name = gases.restitution, PARTICLES[dimension]
        balance = theory.driven_temperature(e, dimension, gases.power, gases.packing_fraction)
        style.points(upper, e, gases.temperature / balance, kind=kind, label=name)
        style.points(lower, e, gases.cumulant, kind=kind, label=name)
        for of, line in ((driven_cumulant, "-"), (theory.fourth_cumulant, ":")):
            own = finite_size_cumulant(of(curve, dimension), gases.count[0], dimension)
            lower.plot(curve, own, color=style.COLOURS[kind], linestyle=line, zorder=1)
    style.label_axes(upper, r"restitution $\epsilon$", r"$T$ / $T$ of energy balance")
    style.label_axes(lower, r"restitution $\epsilon$", r"fourth cumulant $a_2$", "upper right")
    style.letters(upper, lower)
    return figure


FIGURES = {"driven_gas": Parts({}, measure, claims, draw)}
