"""Made-up measurements of estimators with known answers."""

import numpy as np
import xarray as xr


def measured(**changed):
    """What `measure.estimators` gives of two gases in two widths of bins."""
    columns = {
        "packing_fraction": [0.05, 0.05, 0.4, 0.4],
        "width": [0.1, 0.5, 0.1, 0.5],
        "mixture": [30.0, 9.0, 1.8, 1.1],
        "impulses": [29.0, 8.0, 1.7, 0.8],
        "at_walls": [70.0, 20.0, 6.0, 1.5],
        "mean_square": [1.05, 0.9, 1.1, 0.95],
        "additions": [0.03, 0.03, 0.07, 0.07],
        "pressure": [15.0, 15.0, 1.3, 1.3],
        "pressures_apart": [0.002, 0.002, -0.001, -0.001],
    } | changed
    ds = xr.Dataset({name: ("case", np.array(values)) for name, values in columns.items()})
    for name in (
        "mixture",
        "impulses",
        "at_walls",
        "mean_square",
        "additions",
        "pressure",
        "pressures_apart",
    ):
        ds[f"{name}_error"] = 0.02 * ds[name]
        ds[f"{name}_freedom"] = "case", np.full(4, 7.0)
    ds["pressures_apart_error"] = "case", np.full(4, 0.002)
    return ds
