"""Memory of a gas: growth of the echo after a reversal, and of the distance of neighbouring runs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import mean_of
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.figure import PARTICLES, Parts
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, table

TITLE, CHAPTER = "Stability and reversibility", "Speed and accuracy"
# Distances, in diameters, between which exponential growth is fitted: below saturation, and three decades
# above the first deviations, which grow faster until they have the direction of fastest growth. In spheres at
# packing fraction 0.001, two runs with the initial distance 1e-10 grow with 1.13(3) times the exponent from
# 1e-9 on, and with 1.03(4) times from 1e-7 on.
WINDOW = {"float64": (1e-10, 1e-2), "float32": (1e-5, 1e-2)}
FORGOTTEN = 0.1  # distance of the echo from the start, in diameters, at which the memory ends
ROUNDINGS = math.log(0.1 * 2.0**53)  # ln of that distance over the rounding error of a coordinate of 1


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure growth per collision of a particle, and memory in collisions, over seeds of `echo` jobs."""
    rows = table("row", points, _row, inner=("sample",))
    return rows.sortby(["dimension", "packing_fraction"])


def _row(point: Point) -> dict[str, Any]:
    run = xr.load_dataset(point.path)
    window = WINDOW[run.attrs["precision"]]
    collisions, echoes, apart = (run[name].values for name in ("collisions", "echo", "divergence"))
    kept = ("dimension", "count", "side", "engine", "precision")
    return {name: run.attrs[name] for name in kept} | {
        "packing_fraction": round(run.attrs["packing_fraction"], 12),
        "collisions": collisions.mean(axis=0),
        "echo": np.median(echoes, axis=0),
        "jumps": float(np.mean([_jumps(echo, *window) for echo in echoes])),
        "growth": _mean(map(partial(_slope, window), collisions, echoes)),
        "divergence": _mean(map(partial(_slope, WINDOW["float64"]), collisions, apart)),
        "memory": _mean(map(_memory, collisions, echoes)),
        "exponent": _mean(run.exponent.values),
    }


def _mean(values: Iterable[float]) -> Estimate:
    """Average over the seeds with a finite value; NaN for fewer than two."""
    finite = [value for value in values if np.isfinite(value)]
    return mean_of(finite) if len(finite) > 1 else Estimate(math.nan, math.nan, math.nan)


def _slope(window: tuple[float, float], s: np.ndarray, distance: np.ndarray) -> float:
    """Fit the growth of ln distance until it first leaves the window; NaN for fewer than three points."""
    low, high = window
    out = np.flatnonzero(distance >= high)
    end = out[0] if out.size else distance.size
    inside = np.flatnonzero(distance[:end] > low)
    if inside.size < 3:
        return np.nan
    return float(np.polyfit(s[inside], np.log(distance[inside]), 1)[0])


def _memory(s: np.ndarray, distance: np.ndarray) -> float:
    """Find the collisions at which the distance first is `FORGOTTEN`, interpolated; NaN if it never is."""
    out = np.flatnonzero(distance >= FORGOTTEN)
    if not out.size or out[0] == 0:
        return np.nan
    before, after = np.log(distance[out[0] - 1 : out[0] + 1])
    part = (np.log(FORGOTTEN) - before) / (after - before)
    return float(s[out[0] - 1] + part * (s[out[0]] - s[out[0] - 1]))


def _jumps(distance: np.ndarray, low: float, high: float) -> bool:
    """Return True if the distance passes over the upper half of the window (of its logarithm) at once."""
    out = np.flatnonzero(distance >= high)
    return bool(out.size and out[0] > 0 and distance[out[0] - 1] < np.sqrt(low * high))


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims on growth and memory of exact runs; there is no theory for time steps."""
    runs = Table(dataset, "row")
    for run in runs[runs.engine == "event"]:
        gas = f"{PARTICLES[run.dimension]}, packing fraction {run.packing_fraction:g}"
        yield Claim(
            f"growth of the echo over that of two neighbouring runs, {gas}",
            run.growth / run.divergence, 1.0, 0.1,
            "time reversal: a flow and its reverse have the same exponents",
            "the backward run is not the reverse of the forward run",
        )  # fmt: skip
        yield Claim(
            f"growth of the echo over the largest Lyapunov exponent, {gas}",
            run.growth / run.exponent, 1.0, 0.1,
            "the linearised dynamics of the same gas, by gaspart.analysis.lyapunov; the growth of the "
            "exponent with dilution is that of [van Zon 1998]",
            "the engine amplifies errors more or less than collisions of hard particles do",
        )  # fmt: skip
        yield Claim.within(
            f"growth of the echo times the memory, {gas}",
            run.growth * run.memory, ROUNDINGS - math.log(run.side), 5.0,
            "ln(0.1 2^53 sigma / L): only the rounding of coordinates up to L is lost",
            "an error larger than rounding is made, or the engine replays instead of integrating",
        )  # fmt: skip


LINES = {
    ("event", "float64"): ("event-driven", "-"),
    ("step", "float64"): ("time-stepped", "--"),
    ("step", "float32"): ("time-stepped, float32", ":"),
}
ETA = r"packing fraction $\eta$"


def draw(dataset: xr.Dataset) -> Figure:
    """Draw echoes against collisions, growth of echoes against density, and memory by engine."""
    figure, axes = style.new((2.8,), (2.1,), (2.1,))
    runs = Table(dataset, "row")
    _echoes(axes[0], runs)
    _growth(axes[1], runs[runs.engine == "event"])
    _memories(axes[2], runs)
    style.letters(*axes)
    return figure


def _echoes(axis: Axes, runs: Table) -> None:
    gases = [gas for *gas, _ in runs.by("dimension", "packing_fraction")]
    for run in runs:
        gas = [run.dimension, run.packing_fraction]
        _, line = LINES[run.engine, run.precision]
        label = f"{gas[0]}D, {gas[1]:g}" if line == "-" else None
        colour = style.COLOURS[gases.index(gas) % len(style.COLOURS)]
        axis.plot(run.collisions, run.echo, color=colour, ls=line, label=label)
    for name, line in LINES.values():
        axis.plot([], [], color=style.GREY, ls=line, label=name)
    labels = "collisions per particle before the reversal", r"echo: distance / $\sigma$"
    style.label_axes(axis, *labels, xscale="log", yscale="log", ylim=(1e-20, 1e3))
    axis.legend(title=r"$\eta$", ncols=2, loc="lower right", columnspacing=0.6, handletextpad=0.4)


def _growth(axis: Axes, exact: Table) -> None:
    for dimension, runs in exact.by("dimension"):
        kind, eta, name = dimension - 2, runs.packing_fraction, PARTICLES[dimension]
        style.points(axis, eta, runs.growth, kind=kind, label=f"{name}, echo")
        style.points(axis, 1.12 * eta, runs.divergence, kind=kind, hollow=True, label=f"{name}, two runs")
        label = "Lyapunov exponent" if kind else None
        exponent = runs.exponent
        axis.errorbar(eta, exponent.value, exponent.error, color=style.GREY, zorder=1, label=label)
    style.label_axes(axis, ETA, "growth per collision", xscale="log", yscale="log")
    if exact:
        eta = exact.packing_fraction
        axis.set_xlim(0.5 * eta.min(), 2.0 * eta.max())
    axis.legend()


def _memories(axis: Axes, runs: Table) -> None:
    for kind, ((engine, precision), (name, _)) in enumerate(LINES.items()):
        of_engine = runs[(runs.engine == engine) & (runs.precision == precision)]
        for dimension in PARTICLES:
            part = of_engine[of_engine.dimension == dimension]
            look: dict[str, Any] = {"hollow": dimension == 2, "label": name if dimension == 3 else None}
            style.points(axis, part.packing_fraction, part.memory, kind=kind, **look)
    style.label_axes(axis, ETA, "memory (collisions)", xscale="log", yscale="log")
    axis.legend(title="spheres; discs hollow")


FIGURES = {"reversibility": Parts({}, measure, claims, draw)}
