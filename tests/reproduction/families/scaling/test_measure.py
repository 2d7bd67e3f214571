"""The scaling figures' measurements, on jobs whose costs are known."""

import math

import numpy as np
import pytest
from reproduction.families.scaling.data import BOX, LIST, TEST


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
