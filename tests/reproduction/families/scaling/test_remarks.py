"""Source A's remarks on the cost of a step, from jobs whose costs are known."""

import math

import pytest
from reproduction.families.scaling.data import BOX, CONTACTS, NEAR, PARTICLE, TEST


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
