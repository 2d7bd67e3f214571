import numpy as np
import pytest
from experiments.displacement.data import discs, spheres

from gaspart import theory
from gaspart.experiments.displacement import figure as displacement
from gaspart.rendering import style


@pytest.mark.parametrize(
    ("draw", "data", "panels"), [(displacement.msd_spheres, spheres, 4), (displacement.msd_discs, discs, 3)]
)
def test_all_panels_are_drawn_and_labelled(tmp_path, draw, data, panels):
    with style.applied():
        figure = draw(data())
        style.save(figure, tmp_path / "msd.png")
    assert len(figure.axes) == panels
    assert all(axis.get_xlabel() and axis.get_ylabel() for axis in figure.axes)


def test_no_series_of_sizes_leaves_its_panel_empty():
    ds = spheres()
    ds["in_series"] = ("point", np.zeros(ds.sizes["point"], dtype=bool))
    with style.applied():
        figure = displacement.msd_spheres(ds)
    assert not figure.axes[3].axison


def test_no_lag_is_drawn_twice():
    pieces = list(displacement._pieces(spheres(), 0.3))
    drawn = [time for row, lags in pieces for time in row["time"].values[lags]]
    assert len(pieces) >= 2 and np.all(np.diff(drawn) > 0.0)


def test_the_dilute_limit_is_marked_by_enskogs_line():
    with style.applied():
        axis = displacement.msd_spheres(spheres()).axes[2]
    curve = next(one for one in axis.lines if one.get_label().startswith("Erpenbeck"))
    assert curve.get_ydata() == pytest.approx(theory.erpenbeck_wood_ratio(curve.get_xdata()))
