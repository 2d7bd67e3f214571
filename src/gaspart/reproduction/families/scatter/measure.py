"""Scatter of the deviations of all claims, read from the tables of the other figures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr
from scipy.special import ndtr

from gaspart.analysis.flow import Grid
from gaspart.reproduction.claims import read

BINS = 10
"""Number of classes of equal probability; true claims are equally frequent in all classes."""


def claims_scatter(tables: Sequence[str | Path], settings: dict) -> xr.Dataset:
    """Collect the deviations of claimed values, and compare them with their errors.

    `tables` are paths of claims tables, one for each figure. There are no settings.

    deviation : deviation in standard deviations, over `claim`
    figure : index of the figure, over `claim`
    scattered : True if the deviation of a true claim is a standard Gaussian number, over `claim`
    number : number of scattered claims, over `name`, the figures
    chi_square, total : chi-square, and signed sum of the deviations of scattered claims, over `name`
    counts : scattered claims in classes of equal probability, over `class`

    An allowance for the uncertainty of the theory makes deviations smaller. Such claims are not scattered.
    """
    by_figure = {Path(path).stem: [row for row in read(path) if _is_deviation(row)] for path in tables}
    rows = [
        (n, row["deviation_sigma"], row["scattered"] == 1.0)
        for n, group in enumerate(by_figure.values())
        for row in group
    ]
    figure, deviation, scattered = (
        (np.array(column) for column in zip(*rows, strict=True)) if rows else (np.empty(0),) * 3
    )
    scattered = scattered.astype(bool)
    own = [deviation[scattered & (figure == n)] for n in range(len(by_figure))]
    grid = Grid.line(0.0, 1.0, BINS)
    counts = grid.sums(grid.cells(ndtr(deviation[scattered])[:, None]))
    units = {"units": "1"}
    return xr.Dataset(
        {
            "deviation": ("claim", deviation, units),
            "figure": ("claim", figure.astype(int), units),
            "scattered": ("claim", scattered),
            "number": ("name", np.array([len(values) for values in own], dtype=int), units),
            "chi_square": ("name", np.array([np.sum(values**2) for values in own], dtype=float), units),
            "total": ("name", np.array([np.sum(values) for values in own], dtype=float), units),
            "counts": ("class", counts, units),
        },
        coords={"name": list(by_figure)},
    )


def _is_deviation(row: dict) -> bool:
    """Return True if a row states a value, and its deviation is finite."""
    is_value = row["form"] == "value" and row["kind"] == "test" and row["verdict"] != "no verdict"
    return bool(is_value and np.isfinite(row["deviation_sigma"]) and row["uncertainty"] > 0.0)
