"""Figures of extreme scenes, and of reversibility."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from gaspart.rendering import style
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.table import Row, Table

HEADS = {
    "event": "event",
    "event, all pairs": "all pairs",
    "step": "step f8",
    "step, float32": "step f4",
}
BLOCKS = {
    "energy": "drift of\nenergy",
    "momentum": "drift of\nmomentum",
    "overlap": "overlap",
    "missed": "missed\ncontacts",
}
"""Drawn quantities, and the headings of their columns."""
GAP = 0.5
"""Gap between blocks, in columns."""
FLOOR = 1e-17
"""Errors below this are drawn as 0."""
MAP, NORM = colormaps["YlGnBu"], LogNorm(FLOOR, 1.0, clip=True)
"""Colour map of errors, and its scale."""
REASONS = (
    ("a", "step too long: contacts late or missed", ("step too late", "misses")),
    ("b", "step too short for float32", ("than float32 resolves",)),
    ("c", "lengths or speeds beyond float32", ("float32 needs", "float32 does not")),
    ("d", "speeds whose squares overflow", ("of a size from",)),
    ("e", "particles too small for the container", ("too small to resolve",)),
    ("f", "no room to move", ("no room",)),
    ("g", "inelastic collapse", ("inelastic collapse",)),
)
"""Reasons for which scenes are rejected: a letter, the reason, and parts of the messages that state it."""
OTHER = "?", "another reason, in the data"


def stability_extremes(dataset: xr.Dataset) -> Figure:
    """Draw a table with a row for each scene and a column for each engine.

    A cell has an error, or the letter of a rejection.
    """
    scenes = Table(dataset, "row")
    rows, engines = scenes.verdict.shape
    wide = style.width() > style.COLUMN
    letters = (6.0, 7.0, 8.0) if wide else (4.5, 5.5, 6.0)  # heights of rows, key and headings, in cells
    figure, (axis,) = style.new((2.1 + (0.165 if wide else 0.11) * rows,))
    starts = {name: n * (engines + GAP) for n, name in enumerate(BLOCKS)}
    for name, start in starts.items():
        for n, scene in enumerate(scenes):
            for k, outcome in enumerate(Table(scene.dataset, "engine")):
                _draw_cell(axis, start + k, n, _cell(outcome, name, wide), letters[0])
    for n in np.flatnonzero(scenes.group[1:] != scenes.group[:-1]) + 1:
        axis.axhline(float(n), color="black", linewidth=0.6)
    axis.set(xlim=(0, starts["missed"] + engines), ylim=(rows, 0))
    heads = [HEADS[name] for name in scenes.engine] * len(BLOCKS)
    ticks = [start + k + 0.5 for start in starts.values() for k in range(engines)]
    axis.set_xticks(ticks, heads, rotation=90, size=letters[1])
    axis.set_yticks(np.arange(rows) + 0.5, scenes.row, size=letters[1])
    axis.tick_params(length=0, labeltop=True, labelbottom=False, pad=2)
    above = axis.secondary_xaxis(1.0)
    above.set_xticks(
        [start + 0.5 * engines for start in starts.values()], [*BLOCKS.values()], size=letters[2]
    )
    above.tick_params(length=0, pad=34 if wide else 28)
    for part in (*axis.spines.values(), *above.spines.values()):
        part.set_visible(False)
    axis.set_xlabel(_key(scenes, 3 if wide else 1), size=letters[1])
    bar = figure.colorbar(ScalarMappable(NORM, MAP), ax=axis, location="bottom", aspect=50, pad=0.01)
    bar.set_label("relative to energy, momenta,\ncontact distance, number of contacts", size=letters[1])
    bar.ax.tick_params(labelsize=letters[1])
    return figure


def _size(outcome: Row, name: str) -> float:
    """Return an error as a number below 1.

    For contacts, it is the fraction of missed or spurious contacts.
    """
    if name == "missed":
        return abs(outcome.missed) / max(1, outcome.contacts + outcome.missed)
    return abs(getattr(outcome, name))


def _draw_cell(axis: Axes, x: float, top: int, cell: tuple[str, Any, str], letters: float) -> None:
    """Draw a cell (text, background, ink) with its upper left corner at (x, top)."""
    text, colour, ink = cell
    axis.add_patch(Rectangle((x, top), 1, 1, facecolor=colour, edgecolor="white", linewidth=0.4))
    if text:
        axis.text(x + 0.5, top + 0.53, text, ha="center", va="center", color=ink, size=letters)


def _cell(outcome: Row, name: str, wide: bool) -> tuple[str, Any, str]:
    """Return text, background and ink of a cell.

    The text is the power of ten of an error. For contacts it is their number, if there is space. A dot means
    that walls absorb momentum.
    """
    if outcome.verdict == "refused":
        return _reason(outcome.message)[0], "#e6e6e6", "black"
    if outcome.verdict != "passes":
        return outcome.verdict, style.COLOURS[1], "white"
    size = _size(outcome, name)
    if not size > FLOOR:
        return ("·" if np.isnan(size) else "0" if wide else ""), "white", style.GREY
    power = np.log10(size)
    text = f"{outcome.missed:.0f}" if name == "missed" else f"$10^{{{power:.0f}}}$"
    return text if wide else "", MAP(NORM(size)), "black" if power < -6.5 else "white"


def _reason(message: str) -> tuple[str, str]:
    """Return the letter and the text of the reason for a rejection."""
    return next(
        ((letter, text) for letter, text, parts in REASONS if any(part in message for part in parts)), OTHER
    )


def _key(scenes: Table, columns: int) -> str:
    """Return lines with the letters and texts of the reasons that occur."""
    reasons = sorted({_reason(message) for message in scenes.message[scenes.verdict == "refused"]})
    texts = [f"{letter}: {text}" for letter, text in reasons]
    lines = ["; ".join(texts[n : n + columns]) for n in range(0, len(texts), columns)]
    return "\n".join(["Rejected" if texts else "None rejected", *lines])


LINES_OF_ENGINES = {
    ("event", "float64"): ("event-driven", "-"),
    ("step", "float64"): ("time-stepped", "--"),
    ("step", "float32"): ("time-stepped, float32", ":"),
}
ETA = r"packing fraction $\eta$"


def reversibility(ds: xr.Dataset) -> Figure:
    """Draw echoes against collisions, growth of echoes against density, and memory by engine."""
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
