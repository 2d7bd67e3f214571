"""What a reader may choose on the page, from data that the figures have measured: the packing fraction of a
virial series, and the observable, the packing fraction and the accuracy for which an engine is wanted."""

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


def states(paths: Mapping[str, str]) -> list[dict[str, Any]]:
    """`series` of the measurements of figures, {figure: path}, that are equations of state."""
    import xarray as xr

    stated = {figure: one for figure, one in registry.series().items() if figure in paths}
    return series({figure: xr.load_dataset(paths[figure]) for figure in stated}, stated)


def choice_of_engine(paths: Mapping[str, str]) -> dict[str, Any] | None:
    """`engines` of the figure of the cost of an accuracy, with its name; None unless it is on the page."""
    import xarray as xr

    found = [figure for figure in registry.costs() if figure in paths]
    return {"figure": found[0], **engines(xr.load_dataset(paths[found[0]]))} if found else None


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


def engines(dataset: xr.Dataset) -> dict[str, Any]:
    """Costs and errors of all engines, from a dataset of `families.tradeoff.maps`.

    `count` of particles; `accuracies`; `engines`: name and colour of each; `parts`: what makes errors;
    `observables`: of each its name, its packing fractions and over packing fraction, accuracy and engine
    `cost` in s (None if the engine was not run, -1 where none of its settings is so accurate) and, over part
    too, `error`, relative (None where it is not known).
    """
    from matplotlib.colors import to_hex

    from gaspart.reproduction.families.tradeoff import panels

    found = []
    for quantity in dataset["quantity"].values:
        of = dataset.sel(quantity=quantity)
        of = of.isel(fraction=np.isfinite(of["cost"]).any(("accuracy", "solver")).values)
        if of.sizes["fraction"]:
            cost = of["cost"].transpose("fraction", "accuracy", "solver")
            found.append(
                {
                    "key": str(quantity),
                    "name": panels.TITLES[str(quantity)].replace("$", ""),
                    "fractions": _numbers(of["fraction"].values),
                    "cost": _nested(np.where(np.isposinf(cost), -1.0, cost)),
                    "error": _nested(of["error"].transpose(*cost.dims, "part").values),
                }
            )
    return {
        "count": int(dataset["count"].values[0]),
        "accuracies": _numbers(dataset["accuracy"].values),
        "engines": [
            {"name": panels.NAMES[engine], "colour": to_hex(panels.tint(engine))}
            for engine in map(str, dataset["solver"].values)
        ],
        "parts": list(panels.PART_NAMES),
        "observables": found,
    }


def _nested(values: np.ndarray) -> list:
    """An array as nested lists of numbers as JSON has them, with three digits."""
    if values.ndim > 1:
        return [_nested(part) for part in values]
    return [float(f"{value:.3g}") if math.isfinite(value) else None for value in values.tolist()]


def _numbers(values: np.ndarray) -> list[float | None]:
    """Numbers as JSON has them, with six digits; None for what is not finite."""
    return [
        float(f"{value:.6g}") if math.isfinite(value) else None for value in np.asarray(values, dtype=float)
    ]
