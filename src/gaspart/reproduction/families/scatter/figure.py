"""Figure of the scatter of all claims."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy import stats

from gaspart.rendering import style
from gaspart.reproduction.claims import Estimate
from gaspart.reproduction.families.scatter.claims import mean_deviation
from gaspart.reproduction.table import Table

FURTHEST = 5.0
"""Deviations beyond this value are drawn at the edge."""


def claims_scatter(ds: xr.Dataset) -> Figure:
    """Draw the distribution of the deviations, with the Gaussian, and deviations by figure."""
    claims, names = Table(ds, "claim"), Table(ds, "name")
    indices = np.unique(claims.figure)
    figure, (upper, lower) = style.new((2.2,), (0.5 + 0.155 * max(1, indices.size),))
    _distribution(upper, claims.deviation[claims.scattered], mean_deviation(names))
    _figures(lower, claims, names.assign(figure=np.arange(len(names)))[indices])
    style.letters(upper, lower)
    return figure


def _distribution(axis: Axes, alone: np.ndarray, mean: Estimate) -> None:
    """Draw the density of the deviations without an allowance, and the standard Gaussian."""
    z = np.linspace(-FURTHEST, FURTHEST, 400)
    axis.plot(z, stats.norm.pdf(z), color=style.REFERENCE, label="Gaussian")
    if alone.size:
        inside = np.clip(alone, -FURTHEST, FURTHEST)
        rms = np.sqrt(np.mean(alone**2))
        axis.hist(
            inside,
            np.arange(-FURTHEST, FURTHEST + 0.25, 0.5).tolist(),
            density=True,
            color=style.GREY,
            alpha=0.5,
            label=f"{alone.size}, rms {rms:.2f},\nmean {mean}",
        )
    style.label_axes(axis, "deviation / standard deviations", "density", "upper right", ylim=(0.0, 0.6))


def _figures(axis: Axes, claims: Table, figures: Table) -> None:
    """Plot the deviations of each figure in a row, with the probability of a smaller chi-square.

    Deviations of claims with an allowance are hollow.
    """
    axis.axvspan(-3.0, 3.0, color=style.GREY, alpha=0.18, linewidth=0, zorder=0)
    for position, figure in enumerate(figures):
        own = claims[claims.figure == figure.figure]
        for hollow in (True, False):
            z = np.clip(own.deviation[own.scattered != hollow], -FURTHEST, FURTHEST)
            style.points(axis, z, np.full(z.size, position), hollow=hollow, kind=0, markersize=2.5, alpha=0.8)
        if figure.number:
            chance = stats.chi2.cdf(figure.chi_square, figure.number)
            axis.annotate(
                f"{chance:.3f}", (1.0, position), xycoords=("axes fraction", "data"), xytext=(3, 0),
                textcoords="offset points", va="center",
            )  # fmt: skip
    axis.set_yticks(range(len(figures)), figures.name)
    axis.set_ylim(max(1, len(figures)) - 0.5, -0.5)
    style.label_axes(axis, "deviation / standard deviations", xlim=(-FURTHEST - 0.2, FURTHEST + 0.2))
