"""The price of features, by engine."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.price.claims import LARGEST_RATIO
from gaspart.reproduction.table import Table

WORK = {"pair_tests": "pair tests", "crossings": "crossings"}


def price_of_features(ds: xr.Dataset) -> Figure:
    """Draw relative time per event, and counted work per event, for each feature.

    Times are relative to the scene without the feature.
    """
    figure, (times, counts) = style.new((2.9,), (2.9,))
    timed = Table(ds, "point")
    positions = {name: -k for k, name in enumerate(dict.fromkeys(timed.feature))}
    times.axvline(1.0, color=style.GREY, linewidth=0.6, zorder=1)
    times.axvspan(0.0, LARGEST_RATIO, color=style.GREY, alpha=0.18, linewidth=0, zorder=0)
    for kind, (engine, costs) in enumerate(timed.by("engine")):
        rows = np.array([positions[name] for name in costs.feature]) + 0.12 * (0.5 - kind)
        plain = costs[costs.feature == "plain"].seconds[0]
        style.points(times, costs.ratio, rows, kind=kind, label=f"{engine}: plain {1e6 * plain:.3g} µs")
        for hollow, (name, label) in enumerate(WORK.items()):
            work = getattr(costs, name)
            if work.any():
                style.points(counts, work, rows, kind=kind, hollow=bool(hollow), label=f"{engine}: {label}")
    for axis in (times, counts):
        axis.set_yticks(list(positions.values()), positions)
        axis.set_ylim(-len(positions) + 0.4, 1.6)
        axis.tick_params(axis="y", which="both", length=0)
        axis.legend(loc="upper right", ncols=2 if axis is counts else 1)
    most = (timed.ratio.value + timed.ratio.error).max()
    labels = "time per event / without the feature", "counted work per event"
    style.label_axes(times, labels[0], xlim=(0.0, max(1.6, 1.1 * most)))
    style.label_axes(counts, labels[1], xscale="log")
    style.letters(times, counts)
    return figure
