"""What families that do not read their data as a `Table` take of it; goes with the last of them."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.reproduction.table import entries, from_rows

__all__ = ["entries", "estimates", "from_rows"]


def estimates(dataset: xr.Dataset, name: str) -> np.ndarray:
    """(2, ...) the values of a variable and their errors; of one number `Estimate.of` makes an Estimate."""
    return np.stack([dataset[name].values, dataset[f"{name}_error"].values])
