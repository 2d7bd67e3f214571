"""The scaling figures' measurements, on jobs whose costs are known."""

import math

import numpy as np
import pytest
from reproduction.families.scaling.data import BOX, CONTACTS, LIST, NEAR, PARTICLE, TEST


def test_naive_scaling(dataset):
    ds = dataset("naive_scaling")
    assert float(ds.tests_excess) == 0.0
    assert float(ds.exponent) == pytest.approx(2.0, abs=0.02)
    assert float(ds.test_seconds) == pytest.approx(TEST, rel=0.03)


def test_box_count(dataset):
    ds = dataset("box_count")
    ideal = math.sqrt(13.5 * TEST / BOX)
    assert float(ds.ideal) == pytest.approx(ideal, rel=0.3)
    assert float(ds.model) == pytest.approx(ideal, rel=0.1)
    assert (ds.pair_tests / ds.expected_tests).values == pytest.approx(1.0, rel=1e-3)
    assert (np.abs(ds.advantage) < 4.0 * ds.advantage_error).all()
    assert float(ds.event_searches) == pytest.approx(2.0, rel=0.01)
    assert float(ds.crossing_searches) == pytest.approx(1.0 / 3.0, rel=0.01)
    assert float(ds.crossing_exponent) == pytest.approx(1.0, rel=1e-3)


def test_linear_scaling(dataset):
    ds = dataset("linear_scaling")
    assert float(ds.work_exponent) == pytest.approx(1.0, abs=0.02)
    assert ds.exponent.values == pytest.approx(1.0, abs=0.06)
    assert ds.list_pair_tests.values == pytest.approx(1.0)
    assert ds.list_seconds.values == pytest.approx(LIST + TEST, rel=0.03)
    assert (ds.list_share.values < 0.5).all()  # boxes cost PARTICLE at least, and some tests
    count = float(ds.extrapolated_count)
    assert float(ds.extrapolated_seconds) == pytest.approx(TEST * count * (count - 1) / 2, rel=0.03)


def test_event_scaling(dataset):
    ds = dataset("event_scaling")
    work = dict(zip(ds.method_search.values.tolist(), ds.work_exponent.values.tolist(), strict=True))
    assert work["pairs"] == pytest.approx(2.0, abs=0.01)
    assert work["direct"] == pytest.approx(1.0, abs=0.01)
    assert work["boxes"] == pytest.approx(0.0, abs=0.01)
    assert float(ds.pairs_excess) < 1e-12


def test_remarks(dataset):
    """On a machine on which it costs more to leave out boxes than to look into them."""
    ds = dataset("box_count")
    assert (ds.near_box_visits / ds.near_expected_visits).values == pytest.approx(1.0, abs=1e-3)
    least = PARTICLE + 2.0 * math.sqrt(13.5 * TEST * BOX)
    assert float(ds.near_least) == pytest.approx(1.0 + NEAR / least, rel=0.03)
    assert float(ds.near_least_freedom) == 7.0
    assert float(ds.near_missed) == 0.0
    assert float(ds.own_first) == pytest.approx(2.0 * CONTACTS / 1e5 * 0.917, rel=0.01)
    assert float(ds.huge_tests) == pytest.approx(1.0)
    assert float(ds.huge_ratio) == pytest.approx(1.0 + TEST / (PARTICLE + 12.5 * BOX + 1.05 * TEST), rel=0.01)


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
    """The gas farthest from the ideal number pays most, where that number follows N."""
    ds = dataset("ideal_boxes")
    plateau = ds.isel(plateau=0)
    assert plateau.plateau_boxes == 25**3 and plateau.plateau_count == 2000
    number = 25**3 / 2000
    least = PARTICLE + 2.0 * math.sqrt(13.5 * TEST * BOX)
    cost = PARTICLE + TEST * 13.5 / number + BOX * number
    assert float(plateau.plateau_penalty) == pytest.approx(cost / least, abs=0.03)
    assert (ds.plateau_penalty >= 1.0).all() and (ds.plateau_penalty_error < 0.03).all()
