"""Scatter of the deviations of all claims, read from the tables of the other figures."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from gaspart.analysis.flow import Grid
from gaspart.analysis.statistics import jackknife
from gaspart.keys import TEXT, list_of
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim, Estimate, read
from gaspart.reproduction.figure import Parts
from gaspart.reproduction.table import Table

TITLE, CHAPTER = "All claims together", "Pictures and checks"
OF_CLAIMS = True
SETTINGS = {
    "experiments": list_of(TEXT, "none: it is made of the claims of all other figures", least=0, most=0)
}
BINS = 10  # classes of equal probability


def measure(tables: Sequence[str | Path], settings: dict) -> xr.Dataset:
    """Collect the deviations of all claimed values, with sums over those `scattered` by figure and by class.
    An allowance for the uncertainty of the theory makes deviations smaller; such claims are not scattered.
    """
    from scipy.special import ndtr

    rows = [
        (n, row["deviation_sigma"], row["scattered"] == 1.0)
        for n, path in enumerate(tables)
        for row in read(path)
        if _is_deviation(row)
    ]
    figure, deviation, scattered = np.array(rows, dtype=float).reshape(-1, 3).T
    alone = scattered == 1.0
    own = [deviation[alone & (figure == n)] for n in range(len(tables))]
    grid, units = Grid.line(0.0, 1.0, BINS), {"units": "1"}
    return xr.Dataset(
        {
            "deviation": ("claim", deviation, units),
            "figure": ("claim", figure.astype(int), units),
            "scattered": ("claim", alone),
            "number": ("name", np.array([len(values) for values in own], dtype=int), units),
            "chi_square": ("name", np.array([np.sum(values**2) for values in own], dtype=float), units),
            "total": ("name", np.array([np.sum(values) for values in own], dtype=float), units),
            "counts": ("class", grid.sums(grid.cells(ndtr(deviation[alone])[:, None])), units),
        },
        coords={"name": [Path(path).stem for path in tables]},
    )


def _is_deviation(row: dict) -> bool:
    is_value = row["form"] == "value" and row["kind"] == "test" and row["verdict"] != "no verdict"
    return bool(is_value and np.isfinite(row["deviation_sigma"]) and row["uncertainty"] > 0.0)


NORMAL = "a standard Gaussian distribution, if all claims are true and all uncertainties correct"
# Many small errors of equal sign cause a mean; one of 0.3 is then detected, and adds 9 % to the mean square.
MEAN_ERROR = 0.1


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims that all scattered deviations are standard Gaussian numbers."""
    rows, classes = Table(dataset, "claim"), Table(dataset, "class")
    deviations = rows.deviation[rows.scattered]
    if not deviations.size:
        return
    yield Claim.joint(
        "deviations of all values claimed without an allowance", deviations, NORMAL,
        "uncertainties that are too small or too large, or false claims",
    )  # fmt: skip
    expected = deviations.size / len(classes)
    yield Claim.chi_square(
        claim=f"probabilities of these deviations in {len(classes)} equal classes "
        "(chi-square per degree of freedom)",
        chi_square=float(((classes.counts - expected) ** 2).sum() / expected),
        degrees_of_freedom=len(classes) - 1,
        source=NORMAL,
        fails_if="deviations of one sign, too many near 0, or too many far away",
    )
    yield Claim(
        "mean of these deviations, signed", mean_deviation(Table(dataset, "name")), 0.0, MEAN_ERROR, NORMAL,
        "finite numbers, starts or normalisations that shift many values by little, to one side",
    )  # fmt: skip


def mean_deviation(figures: Table) -> Estimate:
    """Compute the mean of all scattered deviations; NaN for fewer than two figures. Values of one figure come
    from the same runs, and may deviate together. Therefore the error is the jackknife error over figures.
    """
    stating = figures[figures.number > 0]
    if len(stating) < 2:
        return Estimate(math.nan, math.nan)
    mean = jackknife(lambda total, number: total / number, stating.total, stating.number)
    return Estimate(*mean, len(stating) - 1)


FURTHEST = 5.0  # deviations beyond this value are drawn at the edge


def draw(dataset: xr.Dataset) -> Figure:
    """Draw the distribution of the deviations, with the Gaussian, and deviations by figure."""
    rows, names = Table(dataset, "claim"), Table(dataset, "name")
    shown = np.unique(rows.figure)
    figure, (upper, lower) = style.new((2.2,), (0.5 + 0.155 * max(1, shown.size),))
    _distribution(upper, rows.deviation[rows.scattered], mean_deviation(names))
    _by_figure(lower, rows, names.assign(figure=np.arange(len(names)))[shown])
    style.letters(upper, lower)
    return figure


def _distribution(axis: Axes, alone: np.ndarray, mean: Estimate) -> None:
    z = np.linspace(-FURTHEST, FURTHEST, 400)
    axis.plot(z, np.exp(-0.5 * z**2) / math.sqrt(2.0 * math.pi), color=style.REFERENCE, label="Gaussian")
    if alone.size:
        label = f"{alone.size}, rms {np.sqrt(np.mean(alone**2)):.2f},\nmean {mean}"
        edges = np.arange(-FURTHEST, FURTHEST + 0.25, 0.5).tolist()
        inside = np.clip(alone, -FURTHEST, FURTHEST)
        axis.hist(inside, edges, density=True, color=style.GREY, alpha=0.5, label=label)
    style.label_axes(axis, "deviation / standard deviations", "density", "upper right", ylim=(0.0, 0.6))


def _by_figure(axis: Axes, rows: Table, figures: Table) -> None:
    """Plot a row of deviations by figure, with the probability of a smaller chi-square; hollow: allowance."""
    from scipy.special import chdtr

    axis.axvspan(-3.0, 3.0, color=style.GREY, alpha=0.18, linewidth=0, zorder=0)
    for position, figure in enumerate(figures):
        own = rows[rows.figure == figure.figure]
        for hollow in (True, False):
            z = np.clip(own.deviation[own.scattered != hollow], -FURTHEST, FURTHEST)
            style.points(axis, z, np.full(z.size, position), hollow=hollow, kind=0, markersize=2.5, alpha=0.8)
        if figure.number:
            axis.annotate(
                f"{chdtr(figure.number, figure.chi_square):.3f}", (1.0, position),
                xycoords=("axes fraction", "data"), xytext=(3, 0), textcoords="offset points", va="center",
            )  # fmt: skip
    axis.set_yticks(range(len(figures)), figures.name)
    axis.set_ylim(max(1, len(figures)) - 0.5, -0.5)
    style.label_axes(axis, "deviation / standard deviations", xlim=(-FURTHEST - 0.2, FURTHEST + 0.2))


FIGURES = {"claims_scatter": Parts(SETTINGS, measure, claims, draw)}
