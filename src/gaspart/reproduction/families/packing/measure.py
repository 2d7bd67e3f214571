"""The densest random packings: packing fractions, and contacts per particle."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from scipy.spatial import cKDTree

from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table

TOUCH = 1e-4
"""Gap, in diameters, up to which two particles of a jammed packing count as touching: contacts that carry the
reduced pressure of 10^6 have gaps of some 10^-6, and few other neighbours are as near."""
BACKBONE = 4
"""Contacts that hold a sphere in place; one with fewer rattles in its cage."""


def densest_fill(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure packing fractions with standard errors over replicas, and contacts.

    Contacts are per sphere where the spheres were grown; the first replica of each packing is returned for
    the picture. Returns a dataset with packing_fraction, error, contacts, contacts_error (packing,), contacts
    of spheres that do not rattle, NaN for insertions; rule (packing,); position (packing, particle, axis),
    radius (packing,), length (packing, axis). freedom are the degrees of freedom of the errors.
    """
    inner = {"position": ("particle", "axis"), "length": ("axis",)}
    units = dict.fromkeys(("position", "radius", "length"), "length")
    return table("packing", points, _packing, inner=inner, units=units)


def _packing(point: Point) -> dict[str, Any]:
    dataset = xr.load_dataset(point.path)
    fractions, positions, radii = (
        dataset[name].values for name in ("packing_fraction", "position", "radius")
    )
    length, compressed = dataset["length"].values, point.settings.get("arrangement") == "compressed"
    rule = "centres_to_walls" if point.settings.get("centres_to_walls") else point.settings["boundary"]
    touching = [np.nan]
    if compressed:
        touching = [contacts(*packing, length) for packing in zip(positions, radii, strict=True)]
    fraction, error = _mean(fractions)
    return {
        "rule": "compressed" if compressed else rule,
        "packing_fraction": fraction,
        "error": error,
        "freedom": max(1, fractions.size - 1),
        "contacts": _mean(np.array(touching)),
        "position": positions[0],
        "radius": float(radii[0]),
        "length": length,
    }


def _mean(values: np.ndarray) -> tuple[float, float]:
    """Compute the mean and its standard error."""
    error = values.std(ddof=1) / np.sqrt(len(values)) if len(values) > 1 else np.nan
    return float(values.mean()), float(error)


def contacts(positions: np.ndarray, radius: float, lengths: np.ndarray) -> float:
    """Count contacts per sphere of a periodic packing (N, 3), among spheres that do not rattle.

    Each of these has at least four contacts with others of them. An isostatic packing has 6, less 6/N.
    """
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
