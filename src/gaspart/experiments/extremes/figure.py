"""The table of extremes as a figure: rows against engines, the drift of the energy in each cell."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.colors import Colormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from gaspart.rendering import style

HEADS = {
    "event": "event",
    "event, all pairs": "all\npairs",
    "step": "step\nf8",
    "step, float32": "step\nf4",
}
FLOOR = 1e-17
"""Drifts below this are drawn as 0."""


def stability_extremes(dataset: xr.Dataset) -> Figure:
    """A line per row, a column per engine: the drift of the energy, or that the row was refused or failed."""
    rows, engines = dataset.sizes["row"], dataset.sizes["engine"]
    figure, (axis,) = style.new((0.8 + 0.165 * rows,))
    colours, norm = colormaps["YlGnBu"], Normalize(-18.0, 2.0)
    verdicts, energies = dataset["verdict"].values, dataset["energy"].values
    size = 6 if style.width() <= style.COLUMN else 8  # a power of ten must fit into a cell
    for n in range(rows):
        for k in range(engines):
            text, colour, ink = _cell(verdicts[n, k], energies[n, k], colours, norm)
            axis.add_patch(_box(k, n, colour))
            axis.text(k + 0.5, n + 0.53, text, ha="center", va="center", color=ink, size=size)
    groups = dataset["group"].values
    for n in np.flatnonzero(groups[1:] != groups[:-1]) + 1:
        axis.axhline(float(n), color="black", linewidth=0.6)
    axis.set_xlim(0, engines)
    axis.set_ylim(rows, 0)
    axis.set_xticks(np.arange(engines) + 0.5, [HEADS[name] for name in dataset["engine"].values])
    axis.set_yticks(np.arange(rows) + 0.5, [str(name) for name in dataset["row"].values])
    axis.tick_params(length=0, labeltop=True, labelbottom=False)
    axis.tick_params("x", labelsize=size)
    axis.set_xlabel("drift of the energy\n(– is refused)")
    return figure


def _cell(verdict: str, energy: float, colours: Colormap, norm: Normalize) -> tuple[str, object, str]:
    """Text, background and ink of one cell."""
    if verdict == "refused":
        return "–", "#e6e6e6", "black"
    if verdict != "passes":
        return verdict, style.COLOURS[1], "white"
    if not energy > FLOOR:
        return "0", "white", "black"
    power = np.log10(energy)
    return f"$10^{{{power:.0f}}}$", colours(norm(power)), "black" if power < -6.5 else "white"


def _box(left: float, top: float, colour: Any) -> Rectangle:
    return Rectangle((left, top), 1, 1, facecolor=colour, edgecolor="white", linewidth=0.4)
