"""The price of features, by engine."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.price.claims import LARGEST_RATIO

TIMED_ENGINES = ("event", "step")
WORK = {"pair_tests": "pair tests", "crossings": "crossings"}


def price_of_features(ds: xr.Dataset) -> Figure:
    """Time per event over that without the feature, and the counted work per event, for each feature."""
    figure, (left, right) = style.new((2.9,), (2.9,))
    names = list(dict.fromkeys(ds["feature"].values))
    place = {name: -k for k, name in enumerate(names)}
    left.axvline(1.0, color=style.GREY, linewidth=0.6, zorder=1)
    left.axvspan(0.0, LARGEST_RATIO, color=style.GREY, alpha=0.18, linewidth=0, zorder=0)
    for kind, engine in enumerate(TIMED_ENGINES):
        one = ds.isel(point=np.flatnonzero(ds["engine"].values == engine))
        if not one.sizes["point"]:
            continue
        rows = np.array([place[name] for name in one["feature"].values]) + 0.12 * (0.5 - kind)
        plain = float(one["seconds"].values[list(one["feature"].values).index("plain")])
        label = f"{engine}: plain {1e6 * plain:.3g} µs"
        style.points(left, one["ratio"], rows, kind=kind, xerr=one["ratio_error"], label=label)
        for hollow, name in enumerate(WORK):
            if one[name].values.any():
                look: dict[str, Any] = {"hollow": bool(hollow), "label": f"{engine}: {WORK[name]}"}
                style.points(right, one[name], rows, kind=kind, **look)
    for axis in (left, right):
        axis.set_yticks(list(place.values()), names)
        axis.set_ylim(-len(names) + 0.4, 1.6)
        axis.tick_params(axis="y", which="both", length=0)
        axis.legend(loc="upper right", ncols=2 if axis is right else 1)
    most = float((ds["ratio"] + ds["ratio_error"]).max())
    left.set_xlim(0.0, max(1.6, 1.1 * most))
    left.set_xlabel("time per event over that without the feature")
    right.set_xscale("log")
    right.set_xlabel("counted work per event")
    style.letters(left, right)
    return figure
