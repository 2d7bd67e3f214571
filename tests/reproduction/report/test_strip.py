"""Claims on the axis of deviations."""

import math

import pytest

from gaspart.reproduction.report.page import LIMIT, deviation, dots


def row(sigma=math.nan, low=math.nan, high=math.nan, measured=1.0):
    return {"deviation_sigma": sigma, "lowest": low, "highest": high, "measured": measured}


@pytest.mark.parametrize(
    ("claim", "place"),
    [
        (row(-1.5), -1.5),
        (row(0.0, 0.8, 1.2, 1.1), 1.5),
        (row(2.0, -math.inf, 1.2, 1.3), 2.0),
        (row(0.0, 0.8, 1.2, math.nan), 0.0),
        (row(), 0.0),
    ],
)
def test_a_value_is_at_its_deviation_and_a_bounded_number_at_its_place(claim, place):
    assert deviation(claim) == pytest.approx(place)


def test_dots_do_not_hide_one_another_and_stay_on_the_axis():
    found = dots([row(0.1), row(0.0), row(0.05), row(99.0), row(-math.inf)])
    assert [dot.position for dot in found] == pytest.approx([0.0, 50.0, 50.5, 51.0, 100.0])
    assert [dot.level for dot in found] == [0, 0, 1, 2, 0]
    assert max(dot.level for dot in dots([row(0.0)] * 20)) == 3
    assert LIMIT > 3.0
