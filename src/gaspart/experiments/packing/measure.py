"""The densest random packings: packing fractions, and contacts per particle."""

from __future__ import annotations

import numpy as np
import xarray as xr
from scipy.spatial import cKDTree

from gaspart.planning import grid

TOUCH = 1e-4
"""Gap, in diameters, up to which two particles of a jammed packing count as touching: contacts that carry the
reduced pressure of 10^6 have gaps of some 10^-6, and few other neighbours are as near."""
BACKBONE = 4
"""Contacts that hold a sphere in place; one with fewer rattles in its cage."""


def densest_fill(points: list[grid.Point], settings: dict) -> xr.Dataset:
    """Packing fractions with standard errors over replicas, contacts per sphere where the spheres were grown,
    and the first replica of each packing for the picture.

    Returns a dataset: packing_fraction, error, contacts, contacts_error (packing,), contacts of those that do
    not rattle, NaN for insertions; rule (packing,); position (packing, body, axis), radius (packing,), length
    (packing, axis).
    """
    made, columns = [], []
    for point in points:
        with xr.open_dataset(point.path) as dataset:
            made.append(dataset.load())
        compressed = point.settings.get("arrangement") == "compressed"
        rule = "centres_to_walls" if point.settings.get("centres_to_walls") else point.settings["boundary"]
        touching = [
            contacts(places, radius, made[-1]["length"].values)
            for places, radius in zip(made[-1]["position"].values, made[-1]["radius"].values, strict=True)
            if compressed
        ] or [np.nan]
        filled, touched = _mean(made[-1]["packing_fraction"].values), _mean(np.array(touching))
        freedom = max(1, made[-1]["packing_fraction"].size - 1)
        columns.append(("compressed" if compressed else rule, *filled, *touched, freedom))
    rules, fractions, errors, numbers, number_errors, freedoms = zip(*columns, strict=True)
    bodies = max(one.sizes["body"] for one in made)
    shown = np.full((len(made), bodies, 3), np.nan)
    for place, one in zip(shown, made, strict=True):
        place[: one.sizes["body"]] = one["position"][0]
    return xr.Dataset(
        {
            "rule": ("packing", list(rules)),
            "packing_fraction": ("packing", list(fractions), {"units": "1"}),
            "error": ("packing", list(errors), {"units": "1"}),
            "freedom": ("packing", list(freedoms), {"units": "1", "long_name": "of the errors"}),
            "contacts": ("packing", list(numbers), {"units": "1"}),
            "contacts_error": ("packing", list(number_errors), {"units": "1"}),
            "position": (("packing", "body", "axis"), shown, {"units": "length"}),
            "radius": ("packing", [float(one["radius"][0]) for one in made], {"units": "length"}),
            "length": (("packing", "axis"), np.array([one["length"] for one in made]), {"units": "length"}),
        }
    )


def _mean(values: np.ndarray) -> tuple[float, float]:
    """Mean and its standard error."""
    error = values.std(ddof=1) / np.sqrt(len(values)) if len(values) > 1 else np.nan
    return float(values.mean()), float(error)


def contacts(positions: np.ndarray, radius: float, lengths: np.ndarray) -> float:
    """Contacts per sphere of a periodic packing (N, 3), of those spheres that do not rattle: each has at
    least four contacts with others that do not. An isostatic packing has 6, less 6/N."""
    tree = cKDTree(positions % lengths, boxsize=lengths)
    pairs = tree.query_pairs(2.0 * radius * (1.0 + TOUCH), output_type="ndarray")
    held = np.ones(len(positions), dtype=bool)
    while True:
        pairs = pairs[held[pairs].all(axis=1)]
        degree = np.bincount(pairs.ravel(), minlength=len(positions))
        loose = held & (degree < BACKBONE)
        if not loose.any():
            return 2.0 * len(pairs) / max(1, int(held.sum()))
        held &= ~loose
