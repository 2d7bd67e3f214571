"""Figure of how long a gas remembers its initial state."""

from __future__ import annotations

from typing import Any

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.table import Table

LINES_OF_ENGINES = {
    ("event", "float64"): ("event-driven", "-"),
    ("step", "float64"): ("time-stepped", "--"),
    ("step", "float32"): ("time-stepped, float32", ":"),
}
ETA = r"packing fraction $\eta$"


def reversibility(ds: xr.Dataset) -> Figure:
    """Draw echoes against collisions, their growth against density, and the memory of each engine."""
    figure, axes = style.new((2.8,), (2.1,), (2.1,))
    runs = Table(ds, "row")
    _echoes(axes[0], runs)
    _growth(axes[1], runs[runs.engine == "event"])
    _memory(axes[2], runs)
    style.letters(*axes)
    return figure


def _echoes(axis: Axes, runs: Table) -> None:
    gases = [gas for *gas, _ in runs.by("dimension", "packing_fraction")]
    for run in runs:
        gas = [run.dimension, run.packing_fraction]
        _, line = LINES_OF_ENGINES[run.engine, run.precision]
        label = f"{gas[0]}D, {gas[1]:g}" if line == "-" else None
        colour = style.COLOURS[gases.index(gas) % len(style.COLOURS)]
        axis.plot(run.collisions, run.echo, color=colour, ls=line, label=label)
    for name, line in LINES_OF_ENGINES.values():
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


def _memory(axis: Axes, runs: Table) -> None:
    for kind, ((engine, precision), (name, _)) in enumerate(LINES_OF_ENGINES.items()):
        of_engine = runs[(runs.engine == engine) & (runs.precision == precision)]
        for dimension in PARTICLES:
            part = of_engine[of_engine.dimension == dimension]
            look: dict[str, Any] = {"hollow": dimension == 2, "label": name if dimension == 3 else None}
            style.points(axis, part.packing_fraction, part.memory, kind=kind, **look)
    style.label_axes(axis, ETA, "memory (collisions)", xscale="log", yscale="log")
    axis.legend(title="spheres; discs hollow")
