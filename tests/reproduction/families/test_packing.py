"""A made dataset of the densest packings."""

from __future__ import annotations

import math

import numpy as np
import pytest
import xarray as xr
from reproduction.families.drawn import draw, varied
from scenes import gas

from gaspart.reproduction.claims import judge
from gaspart.reproduction.families.insertion import figure
from gaspart.reproduction.families.insertion.claims import densest_fill
from gaspart.reproduction.families.insertion.measure import contacts
from gaspart.reproduction.jobs.pack import pack


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


# Packings by chance: insertion that is full, growth that is jammed, and the contacts in between.


def test_contacts_of_a_crystal_are_twelve_and_a_loose_sphere_has_none():
    basis = np.array([[0, 0, 0], [0, 1, 1], [1, 0, 1], [1, 1, 0]]) / 2
    cells = np.stack(np.meshgrid(*[np.arange(4)] * 3), axis=-1).reshape(-1, 1, 3)
    places, lengths = (cells + basis).reshape(-1, 3), np.full(3, 4.0)
    radius = math.sqrt(1 / 8)
    assert contacts(places, radius, lengths) == 12.0
    holes = places[1:]
    assert contacts(holes, radius, lengths) == pytest.approx((12 * 243 + 11 * 12) / 255)
    assert contacts(places[::5], radius, lengths) == 0.0


def test_packings_by_insertion_and_by_growth():
    scene = gas(3, 120, 0.6)
    grown, inserted = (xr.Dataset(*pack(scene, attempts, [(1,), (2,)])) for attempts in (None, 200))
    assert (grown["packing_fraction"] > 0.6).all()
    assert (inserted["packing_fraction"] < 0.4).all()
    assert (grown["pressure"] > 1e6).all()
    assert np.isfinite(grown["position"]).all()
    placed = np.isfinite(inserted["position"]).all("axis").sum("particle")
    assert np.allclose(inserted["packing_fraction"], scene.packing_fraction * placed / 120)


# The claims of the densest packings, right and wrong.


def verdicts(**changes):
    return judge(densest_fill(packings(**changes)))


def test_packings_as_they_should_be_agree():
    assert verdicts() == ["agrees", "agrees", "no verdict"]


@pytest.mark.parametrize(("changes", "wrong"), [({"inserted": 0.42}, 0), ({"compressed": 0.55}, 1)])
def test_packings_that_are_not_disagree(changes, wrong):
    assert verdicts(**changes)[wrong] == "disagrees"


# The pictures of the densest packings.


def test_the_first_and_the_last_packing_are_drawn_with_their_packing_fractions(monkeypatch):
    """Without a renderer, which the pictures of a gas have; one packing has fewer particles."""
    drawn = []

    def picture(particles, size, colours):
        drawn.append(particles)
        return np.full((*size, 3), len(drawn), dtype=np.uint8)

    monkeypatch.setattr(figure, "picture", picture)
    ds = varied(packings(), "packing_fraction", "error")
    ds["position"][0, 5:] = np.nan
    axes = draw(figure.densest_fill, ds).axes
    for axis, number in zip(axes, ("0.3760(10)", "0.6410(10)"), strict=True):
        assert number in axis.get_title()
    for k, (axis, particles) in enumerate(zip(axes, drawn, strict=True)):
        one = ds.isel(packing=k)
        assert np.all(axis.images[0].get_array() == k + 1)
        assert np.array_equal(particles.positions, one["position"].dropna(one["position"].dims[0]))
        assert np.all(particles.radii == float(one["radius"]))
        assert np.array_equal(particles.lengths, one["length"])
