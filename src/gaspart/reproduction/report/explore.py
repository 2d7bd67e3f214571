"""Quantities that a reader may vary on the page, from data that the figures have measured: the packing
fraction of a virial series, and the accuracy for which a run is to be paid."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from gaspart.reproduction.families import registry
from gaspart.theory.state import compressibility_factor
from gaspart.theory.virial import HIGHEST_ORDER, partial_sum

if TYPE_CHECKING:
    import xarray as xr

_STEPS = 100


def explanations(paths: Mapping[str, str]) -> dict[str, Any] | None:
    """Quantities that a reader may vary, from the measurements of figures, {figure: path}; None unless there
    are an equation of state and costs."""
    import xarray as xr

    states = {figure: stated for figure, stated in registry.series().items() if figure in paths}
    prices = [figure for figure in registry.costs() if figure in paths]
    if not states or not prices:
        return None
    return {
        "series": series({figure: xr.load_dataset(paths[figure]) for figure in states}, states),
        "costs": [row for figure in prices for row in costs(xr.load_dataset(paths[figure]))],
    }


def series(
    datasets: Mapping[str, xr.Dataset], states: Mapping[str, tuple[int, float]]
) -> list[dict[str, Any]]:
    """For each figure of an equation of state the packing fractions to choose from, the partial sums of the
    virial series to each order, Z of the best equation of state, and the measured Z with its standard error.

    states: the dimension of each figure, and the largest packing fraction to choose.
    """
    rows = []
    for figure, (dimension, largest) in states.items():
        eta = np.linspace(0.0, largest, _STEPS + 1)
        orders = range(1, HIGHEST_ORDER + 1)
        measured = datasets[figure]
        rows.append(
            {
                "name": "discs" if dimension == 2 else "spheres",
                "figure": figure,
                "packing_fraction": _numbers(eta),
                "sums": [_numbers(partial_sum(eta, order, dimension)) for order in orders],
                "reference": _numbers(compressibility_factor(eta, dimension)),
                "measured": [
                    _numbers(measured[name].values) for name in ("packing_fraction", "Z", "Z_error")
                ],
            }
        )
    return rows


def costs(dataset: xr.Dataset) -> list[dict[str, Any]]:
    """For each gas, number of particles and observable of a figure of costs the accuracies, and by engine the
    seconds of processor time that reach them by the fitted model, None where the engine does not."""
    rows = []
    for gas in range(dataset.sizes["gas"]):
        for count in dataset["count"].values:
            for observable in ("Z", "D"):
                at = dataset.isel(gas=gas).sel(count=count, observable=observable)
                kind = "discs" if int(at["gas_dimension"]) == 2 else "spheres"
                eta = float(at["gas_packing_fraction"])
                rows.append(
                    {
                        "name": f"{observable} of {count} {kind} at packing fraction {eta:g}",
                        "accuracy": _numbers(dataset["accuracy"].values),
                        "seconds": {
                            str(engine): _numbers(at["model"].sel(engine=engine).values)
                            for engine in dataset["engine"].values
                        },
                    }
                )
    return rows


def _numbers(values: np.ndarray) -> list[float | None]:
    """Numbers as JSON has them, with six digits; None for what is not finite."""
    return [
        float(f"{value:.6g}") if math.isfinite(value) else None for value in np.asarray(values, dtype=float)
    ]
