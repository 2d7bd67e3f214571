import numpy as np
import pytest
from experiments.gravity.data import capacities, columns

from gaspart.experiments.gravity import figure as gravity
from gaspart.rendering import style
from gaspart.theory.gravity import ideal_heat_capacity


@pytest.mark.parametrize(
    ("draw", "kinds", "panels"), [(gravity.barometric, 1, 5), (gravity.separation, 2, 4)]
)
def test_columns_are_drawn_with_theory(tmp_path, draw, kinds, panels):
    ds = columns(kinds)
    with style.applied():
        figure = draw(ds)
        style.save(figure, tmp_path / "columns.png")
    assert len(figure.axes) == panels
    lines = [line.get_ydata() for line in figure.axes[kinds - 1].lines]
    expected = ds["hydrostatic"].isel(point=-1, species=-1).values / 0.2
    assert any(len(line) == len(expected) and np.allclose(line, expected) for line in lines)


def test_heat_capacity_shows_the_formula(tmp_path):
    with style.applied():
        figure = gravity.heat_capacity(capacities())
        style.save(figure, tmp_path / "capacity.svg")
    curve = figure.axes[0].lines[0]
    assert curve.get_ydata() == pytest.approx(ideal_heat_capacity(curve.get_xdata(), 2))
