"""Cheapest time-stepped setting for each accuracy of a collision, and the event-driven engine."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.families.tradeoff.uniform import OBSERVABLES
from gaspart.reproduction.table import Row, Table

SEEN = 3.5
"""Number of standard errors from 0 above which an error counts as seen."""


def frontier(dataset: xr.Dataset) -> xr.Dataset:
    """Find the cheapest time-stepped setting whose error is within each accuracy.

    Two standard errors, and the error that is known to build up over many steps, are added.

    Over ``gas``: ``gas_dimension``, ``gas_packing_fraction``. Over (``gas``, ``observable``, ``accuracy``):
    ``best_seconds`` per exact collision (NaN if none is known to reach it), ``best_ratio`` of it to the
    event-driven engine's with ``best_ratio_error``, ``best_step``, ``best_setting``.
    """
    errors, steady = Table(dataset, "row"), Table(dataset, "steady")
    gases = list(dict.fromkeys(zip(errors.dimension, errors.packing_fraction, strict=True)))
    shape = (len(gases), len(errors.observable), len(errors.accuracy))
    columns = {name: np.full(shape, np.nan) for name in ("seconds", "ratio", "ratio_error", "step")}
    chosen = np.full(shape, "none", dtype=object)
    for g, (dimension, fraction) in enumerate(gases):
        of = errors[(errors.dimension == dimension) & (errors.packing_fraction == fraction)]
        within = np.abs(of.bias.value) + 2.0 * of.bias.error  # row, observable, step
        within[:, OBSERVABLES.index("Z")] += np.array([_built_up(steady, row) for row in of])[:, None]
        cost = of.seconds.value
        for o, a in np.ndindex(shape[1:]):
            fit = np.where((within[:, o] <= errors.accuracy[a]) & np.isfinite(cost), cost, np.inf)
            best = np.unravel_index(np.argmin(fit), fit.shape)
            if not np.isfinite(fit[best]):
                continue
            event = Estimate(of.event_seconds[best[0]], of.event_error[best[0]])
            ratio = of.seconds[best] / event
            values = (cost[best], ratio.value, ratio.error, of.time_step[best])
            for name, value in zip(columns, values, strict=True):
                columns[name][g, o, a] = value
            chosen[g, o, a] = of.setting[best[0]]
    axes = ("gas", "observable", "accuracy")
    return xr.Dataset(
        {f"best_{name}": (axes, values) for name, values in columns.items()}
        | {
            "best_setting": (axes, chosen.astype(str)),
            "gas_dimension": ("gas", [int(dimension) for dimension, _ in gases]),
            "gas_packing_fraction": ("gas", [float(fraction) for _, fraction in gases]),
        }
    )


def _built_up(steady: Table, row: Row) -> float:
    """Return the largest error of Z that builds up over many steps, or 0.

    It is of a gas and a setting; 0 means that no such error is seen.
    """
    if not steady:
        return 0.0
    own = steady[
        (steady.steady_dimension == row.dimension)
        & (steady.steady_packing_fraction == row.packing_fraction)
        & (steady.steady_setting == row.setting)
    ]
    size = np.abs(own.build_up.value)
    return float(size[size > SEEN * own.build_up.error].max(initial=0.0))
