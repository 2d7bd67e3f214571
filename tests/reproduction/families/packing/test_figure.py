"""The pictures of the densest packings."""

import numpy as np
from reproduction.families.drawn import draw, varied
from reproduction.families.packing.data import packings

from gaspart.reproduction.families.packing import figure as packing


def test_the_first_and_the_last_packing_are_drawn_with_their_packing_fractions(monkeypatch):
    """Without a renderer, which the pictures of a gas have; one packing has fewer particles."""
    drawn = []

    def picture(particles, size, colours):
        drawn.append(particles)
        return np.full((*size, 3), len(drawn), dtype=np.uint8)

    monkeypatch.setattr(packing, "picture", picture)
    ds = varied(packings(), "packing_fraction", "error")
    ds["position"][0, 5:] = np.nan
    axes = draw(packing.densest_fill, ds).axes
    for axis, number in zip(axes, ("0.3760(10)", "0.6410(10)"), strict=True):
        assert number in axis.get_title()
    for k, (axis, particles) in enumerate(zip(axes, drawn, strict=True)):
        one = ds.isel(packing=k)
        assert np.all(axis.images[0].get_array() == k + 1)
        assert np.array_equal(particles.positions, one["position"].dropna(one["position"].dims[0]))
        assert np.all(particles.radii == float(one["radius"]))
        assert np.array_equal(particles.lengths, one["length"])
