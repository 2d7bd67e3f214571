"""Packings by chance: insertion that is full, growth that is jammed, and the contacts in between."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from reproduction.claims.data import judged
from scenes import gas

from gaspart.errors import SceneError
from gaspart.reproduction.figures.densest_fill import claims, contacts, measure
from gaspart.reproduction.jobs.pack import GROWTH, arguments, pack
from gaspart.reproduction.points.point import Point


def test_contacts_of_a_crystal_are_twelve_and_a_loose_sphere_has_none():
    places, lengths = crystal(4), np.full(3, 4.0)
    radius = math.sqrt(1 / 8)
    assert contacts(places, radius, lengths) == 12.0
    holes = places[1:]
    assert contacts(holes, radius, lengths) == pytest.approx((12 * 243 + 11 * 12) / 255)
    assert contacts(places[::5], radius, lengths) == 0.0


def crystal(cells):
    """Centres (4 cells^3, 3) of a face-centred cubic crystal, with cells of side 1."""
    basis = np.array([[0, 0, 0], [0, 1, 1], [1, 0, 1], [1, 1, 0]]) / 2
    corners = np.stack(np.meshgrid(*[np.arange(cells)] * 3), axis=-1).reshape(-1, 1, 3)
    return (corners + basis).reshape(-1, 3)


def test_ordered_packings_grown_slowly_contradict_the_bound_of_random_ones(tmp_path):
    settings = {"dimension": 3, "count": 32, "boundary": "periodic", "arrangement": "compressed"}
    settings |= {"replicas": 2, "radius": 0.5, "packing_fraction": 0.6}
    rates = {"fast": {}, "slow": {"growth_rate": GROWTH / 32}, "loose": {"growth_rate": GROWTH / 64}}
    points = [Point("slow", name, "pack", settings | own, str(tmp_path), 1) for name, own in rates.items()]
    for point, radius in zip(points, (0.34, 0.3535, 0.336), strict=True):
        fraction = 32 * 4 / 3 * math.pi * radius**3 / 8
        centres = np.stack([crystal(2)] * 2)
        Path(point.path).parent.mkdir(parents=True, exist_ok=True)
        xr.Dataset(
            {
                "position": (("replica", "particle", "axis"), centres),
                "radius": ("replica", [radius, radius]),
                "packing_fraction": ("replica", [fraction, 0.6]),
                "length": ("axis", [2.0] * 3),
            }
        ).to_netcdf(point.path)
    found = judged(list(claims(measure(points, {}))))
    slow = {claim: verdict for claim, verdict in found.items() if "densest of 2" in claim}
    assert [verdict for _, verdict in sorted(slow.items())] == ["agrees", "disagrees"]


def test_packings_by_insertion_and_by_growth():
    scene = gas(3, 120, 0.6)
    with pytest.raises(SceneError, match="growth_rate = 0.1: excludes attempts"):
        arguments(Point("fill", "one", "pack", {"attempts": 9, "growth_rate": 0.1}, "points", 1))
    grown, inserted = (xr.Dataset(*pack(scene, attempts, [(1,), (2,)])) for attempts in (None, 200))
    assert (grown["packing_fraction"] > 0.6).all()
    assert (inserted["packing_fraction"] < 0.4).all()
    assert (grown["pressure"] > 1e6).all()
    assert np.isfinite(grown["position"]).all()
    placed = np.isfinite(inserted["position"]).all("axis").sum("particle")
    assert np.allclose(inserted["packing_fraction"], scene.packing_fraction * placed / 120)
