"""A table of extremes, small and made up."""

import numpy as np
import xarray as xr


def extremes_data(verdict="passes", missed=0, message=""):
    """Two rows in two engines: one passes, the other is refused; the first cell of all as given."""
    shape = ("row", "engine")
    energy = np.array([[1e-15, 0.0], [np.nan, np.nan]])
    return xr.Dataset(
        {
            "verdict": (shape, np.array([[verdict, "passes"], ["refused", "refused"]])),
            "message": (shape, np.array([[message, ""], ["speed = 1: too fast", "speed = 1: too fast"]])),
            "refusal": (shape, np.array([[False, False], [True, True]])),
            "energy": (shape, energy),
            "momentum": (shape, 0.0 * energy),
            "overlap": (shape, 0.0 * energy),
            "contacts": (shape, np.array([[100, 100], [-1, -1]])),
            "missed": (shape, np.array([[missed, 0], [0, 0]])),
            "group": ("row", ["masses", "speeds"]),
        },
        coords={"row": ["mass ratio 1e2", "speeds 1e300"], "engine": ["event", "step"]},
    )
