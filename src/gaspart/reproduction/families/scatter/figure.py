"""Figure of the scatter of all claims."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy import stats

from gaspart.rendering import style

FURTHEST = 5.0
"""Deviations beyond are drawn at the edge."""


def claims_scatter(ds: xr.Dataset) -> Figure:
    """Two panels: the distribution of the deviations, with the Gaussian; and those of each figure."""
    shown = ds.isel(name=np.unique(ds["figure"].values))
    rows = max(1, shown.sizes["name"])
    figure, (upper, lower) = style.new((2.2,), (0.5 + 0.155 * rows,))
    _distribution(upper, ds)
    _figures(lower, ds, shown)
    style.letters(upper, lower)
    return figure


def _distribution(axis: Axes, ds: xr.Dataset) -> None:
    """Density of the deviations without an allowance, and the standard Gaussian."""
    z = np.linspace(-FURTHEST, FURTHEST, 400)
    axis.plot(z, stats.norm.pdf(z), color=style.REFERENCE, label="Gaussian")
    alone = ds["deviation"].values[ds["scattered"].values]
    if alone.size:
        inside = np.clip(alone, -FURTHEST, FURTHEST)
        rms = np.sqrt(np.mean(alone**2))
        axis.hist(
            inside,
            np.arange(-FURTHEST, FURTHEST + 0.25, 0.5).tolist(),
            density=True,
            color=style.GREY,
            alpha=0.5,
            label=f"{alone.size}, rms {rms:.2f}",
        )
    axis.set_ylabel("density")
    axis.set_xlabel("deviation / standard deviations")
    axis.set_ylim(0.0, 0.6)
    axis.legend(loc="upper right")


def _figures(axis: Axes, ds: xr.Dataset, shown: xr.Dataset) -> None:
    """A row for each figure: its deviations (hollow: with an allowance), and the probability of a smaller
    chi-square."""
    axis.axvspan(-3.0, 3.0, color=style.GREY, alpha=0.18, linewidth=0, zorder=0)
    names = list(shown["name"].values)
    for row, name in enumerate(names):
        own = ds["figure"].values == list(ds["name"].values).index(name)
        for hollow in (True, False):
            chosen = own & (ds["scattered"].values != hollow)
            z = np.clip(ds["deviation"].values[chosen], -FURTHEST, FURTHEST)
            style.points(axis, z, np.full(z.size, row), hollow=hollow, kind=0, markersize=2.5, alpha=0.8)
        at = shown.isel(name=row)
        if int(at["number"]):
            chance = stats.chi2.cdf(float(at["chi_square"]), int(at["number"]))
            axis.annotate(
                f"{chance:.3f}", (1.0, row), xycoords=("axes fraction", "data"), xytext=(3, 0),
                textcoords="offset points", va="center",
            )  # fmt: skip
    axis.set_yticks(range(len(names)), names)
    axis.set_ylim(max(1, len(names)) - 0.5, -0.5)
    axis.set_xlim(-FURTHEST - 0.2, FURTHEST + 0.2)
    axis.set_xlabel("deviation / standard deviations")
