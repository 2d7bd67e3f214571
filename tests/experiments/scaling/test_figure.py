"""The scaling figures can be drawn, from whole datasets and from those without a minimum."""

import math

import pytest
from experiments.scaling.data import SCALING, points, settings

from gaspart.experiments.scaling import figure as scaling
from gaspart.experiments.scaling import measure as measured
from gaspart.rendering import style


@pytest.mark.parametrize("figure", SCALING)
def test_draws(figure, tmp_path):
    ds = getattr(measured, figure)(points(figure, tmp_path), settings(figure))
    with style.applied():
        picture = getattr(scaling, figure)(ds)
        style.save(picture, tmp_path / "figure.png")
        style.save(picture, tmp_path / "figure.svg")
    assert all(axis.get_ylabel() for axis in picture.axes)
    assert picture.axes[-1].get_xlabel()
    assert (tmp_path / "figure.png").stat().st_size > 10_000


def test_draws_a_scan_without_a_minimum(tmp_path):
    ds = measured.box_count(points("box_count", tmp_path), settings("box_count"))
    ds["ideal_low"], ds["ideal_high"] = 0.0, math.inf
    with style.applied():
        style.save(scaling.box_count(ds), tmp_path / "figure.png")
