"""The cheapest time-stepped setting for each accuracy of a collision, beside the event-driven engine."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.reproduction.families.tradeoff.uniform import OBSERVABLES

SEEN = 3.5
"""An error counts as seen if it is so many standard errors from 0."""


def frontier(dataset: xr.Dataset) -> xr.Dataset:
    """The cheapest time-stepped setting whose error, with two standard errors of it, is within each accuracy;
    and with what is known to build up over many steps.

    Over ``gas``: ``gas_dimension``, ``gas_packing_fraction``. Over (``gas``, ``observable``, ``accuracy``):
    ``best_seconds`` per exact collision (NaN if none is known to reach it), ``best_ratio`` of it to the
    event-driven engine's with ``best_ratio_error``, ``best_step``, ``best_setting``.
    """
    gases = list(dict.fromkeys(zip(dataset.dimension.values, dataset.packing_fraction.values, strict=True)))
    shape = (len(gases), dataset.sizes["observable"], dataset.sizes["accuracy"])
    found = {name: np.full(shape, np.nan) for name in ("seconds", "ratio", "ratio_error", "step")}
    chosen = np.full(shape, "none", dtype=object)
    for g, (dimension, fraction) in enumerate(gases):
        of = dataset.isel(
            row=np.flatnonzero((dataset.dimension == dimension) & (dataset.packing_fraction == fraction))
        )
        within = (np.abs(of.bias) + 2.0 * of.bias_error).values
        built_up = [_built_up(dataset, of.isel(row=k)) for k in range(of.sizes["row"])]
        within[:, OBSERVABLES.index("Z")] += np.array(built_up)[:, None]
        cost = of.seconds.values
        for o in range(shape[1]):
            for a, accuracy in enumerate(dataset.accuracy.values):
                fit = np.where((within[:, o] <= accuracy) & np.isfinite(cost), cost, np.inf)
                best = np.unravel_index(np.argmin(fit), fit.shape)
                if not np.isfinite(fit[best]):
                    continue
                event, event_error = (float(of[name][best[0]]) for name in ("event_seconds", "event_error"))
                ratio = cost[best] / event
                spread = np.hypot(float(of.seconds_error.values[best]) / cost[best], event_error / event)
                values = (cost[best], ratio, ratio * spread, float(of.time_step.values[best]))
                for name, value in zip(found, values, strict=True):
                    found[name][g, o, a] = value
                chosen[g, o, a] = str(of.setting.values[best[0]])
    axes = ("gas", "observable", "accuracy")
    return xr.Dataset(
        {f"best_{name}": (axes, values) for name, values in found.items()}
        | {
            "best_setting": (axes, chosen.astype(str)),
            "gas_dimension": ("gas", [int(dimension) for dimension, _ in gases]),
            "gas_packing_fraction": ("gas", [float(fraction) for _, fraction in gases]),
        }
    )


def _built_up(dataset: xr.Dataset, at: xr.Dataset) -> float:
    """The largest error of Z of a gas and setting that builds up over many steps, 0 if none is seen."""
    if "steady" not in dataset.dims:
        return 0.0
    same = (
        (dataset.steady_dimension == at.dimension)
        & (dataset.steady_packing_fraction == at.packing_fraction)
        & (dataset.steady_setting == at.setting)
        & (np.abs(dataset.build_up) > SEEN * dataset.build_up_error)
    )
    return float(np.abs(dataset.build_up).where(same, 0.0).max())
