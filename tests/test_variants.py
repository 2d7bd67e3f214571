"""Kernel variants: what tells two of them apart, and that a name is enough to compile them."""

import pytest

from gaspart.grid import Point
from gaspart.variants import variant, warm


def point(job="simulate", **settings):
    return Point("gas", "single", job, {"dimension": 2, **settings}, "results/points", 1)


@pytest.mark.parametrize(
    ("settings", "name"),
    [
        ({}, "event-boxes-2d-ww"),
        ({"boundary": "periodic", "dimension": 3}, "event-boxes-3d-ppp"),
        ({"boundary": ["periodic", "wall"], "search": "direct"}, "event-direct-2d-pw"),
        ({"engine": "step", "time_step": 0.1}, "step-float64-2d-ww"),
        ({"engine": "step", "precision": "float32"}, "step-float32-2d-ww"),
        ({"job": "fill", "dimension": 3}, "fill-random-3d-www"),
    ],
)
def test_a_variant_is_named_after_what_is_compiled(settings, name):
    assert variant(point(**settings)) == name


def test_points_that_differ_in_numbers_share_their_kernels():
    assert variant(point(count=10, radius=0.5)) == variant(point(count=1000, radius=0.1, temperature=2.0))


@pytest.mark.parametrize("name", ["event-boxes-2d-pw", "step-float32-2d-ww", "fill-random-3d-ppp"])
def test_the_name_is_enough_to_warm_the_kernels(name):
    warm(name)
