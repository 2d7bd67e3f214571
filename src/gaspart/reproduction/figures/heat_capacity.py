"""Heat capacity of a dilute gas under gravity in a box, from energies and from fluctuations.

The box has a finite height H; the heat capacity is a function of x = m g H / (k_B T). Points come in pairs:
one scene at two energies. Expected values are exact for an ideal gas with the same number and energy.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.estimate import Estimate
from gaspart.keys import count
from gaspart.rendering import style
from gaspart.rendering.style import Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Blocks, Parts, runs
from gaspart.reproduction.figures._columns import field
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, table
from gaspart.state.initial import initial_state
from gaspart.theory.gravity import ideal_energy_moments, ideal_heat_capacity, lebowitz_percus_verlet

TITLE, CHAPTER = "Under gravity", "Gravity, heat and walls"
SETTINGS = {"blocks": count("stretches of each replica")}


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure C = dE/dT from each pair of points, and C from the fluctuations of each run."""
    if len(points) % 2:
        raise ValueError(f"points: {len(points)} (must be pairs)")
    ends = [_measure_run(point, settings["blocks"]) for point in points]
    pairs = list(zip(ends[::2], ends[1::2], strict=True))
    if any(a["gravity"] != b["gravity"] for a, b in pairs) or len({end["count"] for end in ends}) > 1:
        raise ValueError("points: the two of a pair must differ in their energy only")
    of = list(zip(points[::2], points[1::2], strict=True))
    return table("pair", pairs, _pair, inner=("run",), of=of).assign_attrs(count=ends[0]["count"])


def _pair(ends: tuple[dict, dict]) -> dict[str, Any]:
    cold, warm = ends
    names = "energy", "temperature_expected", "run_x", "fluctuation_expected"
    row: dict[str, Any] = {name: np.array([end[name] for end in ends]) for name in names}
    rise = np.diff(row["energy"])[0] / cold["count"]
    return row | {
        "temperature": Estimate.stack([end["temperature"] for end in ends]),
        "fluctuation": Estimate.stack([end["fluctuation"] for end in ends]),
        "slope": Estimate(rise) / (warm["temperature"] - cold["temperature"]),
        "slope_expected": rise / np.diff(row["temperature_expected"])[0],
        "x": row["run_x"].mean(),
        "gravity": cold["gravity"],
    }


def _measure_run(point: Point, blocks: int) -> dict[str, Any]:
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
    apart = parts - shift
    each = Blocks(zip(parts.mean(axis=1), apart.mean(axis=1), (apart**2).mean(axis=1), strict=True))
    temperature = each(lambda mean, *_: mean)
    mean, variance = ideal_energy_moments(float(energy), count, column.height, force, 2)
    return {
        "count": count,
        "gravity": column.strength,
        "energy": energy,
        "temperature": temperature,
        "fluctuation": each(
            lambda _, mean, square: lebowitz_percus_verlet(
                count * (mean + shift), count**2 * (square - mean**2), count, 2
            )
        ),
        "temperature_expected": mean / count,
        "run_x": force * column.height / temperature.value,
        "fluctuation_expected": lebowitz_percus_verlet(mean, variance, count, 2),
    }


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims on the heat capacity from energy differences and from fluctuations."""
    rounding = Estimate(0.0, 1e-9)  # without gravity both are exact except for this correction
    for pair in Table(dataset, "pair"):
        x = abs(pair.x)
        kind, at = "test" if x else "identity", f"gravity {pair.gravity:g}"
        ideal = f"d/2 + 1 - x^2 e^x/(e^x - 1)^2 = {float(ideal_heat_capacity(x, 2)):.4f}"
        finite = f"{ideal}, here for {pair.count} particles at the runs' energies"
        yield Claim(
            f"heat capacity C_V/Nk as dE/dT, {at}",
            pair.slope + rounding, pair.slope_expected, 0.02, finite,
            "an energy that is not distributed over height and motion by Boltzmann's factor", kind,
        )  # fmt: skip
        for number, run in enumerate(Table(pair.dataset, "run"), start=1):
            yield Claim(
                f"heat capacity C_V/Nk from fluctuations, {at}, run {number}",
                run.fluctuation + rounding, run.fluctuation_expected, 0.03, f"[Lebowitz 1967]; {finite}",
                "fluctuations that are not the microcanonical ones: not ergodic, or energy lost", kind,
            )  # fmt: skip


def draw(dataset: xr.Dataset) -> Figure:
    """Draw heat capacity against x, from energies and from fluctuations, and its deviation."""
    figure, (top, bottom) = style.new((2.6, 1.2))
    pairs, runs = Table(dataset, "pair"), Table(dataset.stack(each=("pair", "run")), "each")
    end = 1.15 * max(pairs.x.max(), runs.run_x.max())
    x = np.linspace(0.0, end, 300)
    top.plot(x, ideal_heat_capacity(x, 2), color=style.DATA, label="canonical, ideal gas")
    style.level(top, 1.0, ls="--")
    style.level(top, 2.0, ls="--")
    style.level(bottom, 0.0)
    series = (
        (pairs.x, pairs.slope, pairs.slope_expected, "from $dE/dT$"),
        (runs.run_x, runs.fluctuation, runs.fluctuation_expected, "from fluctuations"),
    )
    for kind, (at, capacity, expected, label) in enumerate(series):
        look: dict[str, Any] = {"kind": kind, "hollow": bool(kind)}
        style.points(top, at, capacity, **look, label=label)
        style.points(bottom, at, 100.0 * (capacity / expected - 1.0), **look)
    style.label_axes(top, y=r"heat capacity $C_V/Nk$", legend="lower right", ylim=(0.9, 2.1))
    labels = r"height of the box $x = mgH/kT$", "deviation from\nexact (%)"
    style.label_axes(bottom, *labels, xlim=(-0.03 * end, end), ylim=(-4.5, 4.5))
    style.letters(top, bottom)
    return figure


FIGURES = {"heat_capacity": Parts(SETTINGS, measure, claims, draw)}
