"""The ideal number of boxes, from jobs whose costs are known."""

import math

import pytest
from reproduction.families.scaling.data import BOX, PARTICLE, TEST


def test_ideal_boxes(dataset):
    ds = dataset("ideal_boxes")
    ideal = math.sqrt(13.5 * TEST / BOX)
    found = ds.ideal_interior.values.astype(bool)
    assert ds.ideal.values[found] == pytest.approx(ideal, rel=0.3)
    assert not found[ds["count"].values == 1_200_000].any()  # the limit of a diameter a box is below it
    assert ds.most.values[ds["count"].values == 1_200_000] == pytest.approx(13.02, abs=0.01)
    assert float(ds.exponent[0]) == pytest.approx(1.0, abs=0.15)
    assert ds.source_number.values.tolist() == [10, 7, 10]


def test_plateaus(dataset):
    """Where the ideal number follows N, the gas farthest from it pays most."""
    ds = dataset("ideal_boxes")
    plateau = ds.isel(plateau=0)
    assert plateau.plateau_boxes == 25**3 and plateau.plateau_count == 2000
    number = 25**3 / 2000
    least = PARTICLE + 2.0 * math.sqrt(13.5 * TEST * BOX)
    cost = PARTICLE + TEST * 13.5 / number + BOX * number
    assert float(plateau.plateau_penalty) == pytest.approx(cost / least, abs=0.03)
    assert (ds.plateau_penalty >= 1.0).all() and (ds.plateau_penalty_error < 0.03).all()
