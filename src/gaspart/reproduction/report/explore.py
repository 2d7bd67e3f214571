"""What a reader may vary on the page, from data that the figures have measured: the packing fraction of a
virial series, and the accuracy for which a run is to be paid."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from gaspart.theory.state import compressibility_factor
from gaspart.theory.virial import HIGHEST_ORDER, partial_sum

if TYPE_CHECKING:
    import xarray as xr

SERIES = {"virial_discs": (2, 0.65), "virial_spheres": (3, 0.49)}
"""The figures of the equation of state: dimension, and the largest packing fraction to choose."""
COSTS = "time_to_accuracy"
"""The figure of the cost of an accuracy."""
_STEPS = 100


def series(datasets: Mapping[str, xr.Dataset]) -> list[dict[str, Any]]:
    """Of discs and of spheres: the packing fractions to choose from, the partial sums of the virial series
    to each order, Z of the best equation of state, and the measured Z with its standard error."""
    found = []
    for figure, (dimension, largest) in SERIES.items():
        eta = np.linspace(0.0, largest, _STEPS + 1)
        orders = range(1, HIGHEST_ORDER + 1)
        measured = datasets[figure]
        found.append(
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
    return found


def costs(dataset: xr.Dataset) -> list[dict[str, Any]]:
    """Of each gas, number of particles and observable of `time_to_accuracy`: the accuracies, and by engine
    the seconds of processor time that reach them by the fitted model, None where the engine does not."""
    found = []
    for gas in range(dataset.sizes["gas"]):
        for count in dataset["count"].values:
            for observable in ("Z", "D"):
                at = dataset.isel(gas=gas).sel(count=count, observable=observable)
                kind = "discs" if int(at["gas_dimension"]) == 2 else "spheres"
                eta = float(at["gas_packing_fraction"])
                found.append(
                    {
                        "name": f"{observable} of {count} {kind} at packing fraction {eta:g}",
                        "accuracy": _numbers(dataset["accuracy"].values),
                        "seconds": {
                            str(engine): _numbers(at["model"].sel(engine=engine).values)
                            for engine in dataset["engine"].values
                        },
                    }
                )
    return found


def _numbers(values: np.ndarray) -> list[float | None]:
    """Numbers as JSON has them, with six digits; None for what is not finite."""
    return [
        float(f"{value:.6g}") if math.isfinite(value) else None for value in np.asarray(values, dtype=float)
    ]
