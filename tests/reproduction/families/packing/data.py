"""A made dataset of the densest packings."""

import numpy as np
import xarray as xr


def packings(inserted=0.376, compressed=0.641, contacts=5.85):
    """Eight spheres by insertion, eight by growth."""
    corners = np.stack(np.meshgrid(*[[1.0, 3.0]] * 3), axis=-1).reshape(-1, 3)
    return xr.Dataset(
        {
            "rule": ("packing", ["periodic", "compressed"]),
            "packing_fraction": ("packing", [inserted, compressed]),
            "error": ("packing", [1e-3, 1e-3]),
            "freedom": ("packing", [7, 7]),
            "contacts": ("packing", [np.nan, contacts]),
            "contacts_error": ("packing", [np.nan, 0.03]),
            "position": (("packing", "particle", "axis"), np.array([corners, corners])),
            "radius": ("packing", [0.5, 0.9]),
            "length": (("packing", "axis"), np.full((2, 3), 4.0)),
        }
    )
