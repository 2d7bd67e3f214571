import numpy as np
import pytest
from experiments.buoyancy.data import measurement

from gaspart.experiments.buoyancy import figure as buoyancy
from gaspart.rendering import style


def test_the_two_radii_and_theory_are_drawn(tmp_path):
    ds = measurement()
    with style.applied():
        figure = buoyancy.buoyancy(ds)
        style.save(figure, tmp_path / "buoyancy.png")
    _, middle, bottom = figure.axes
    own, margin, theory = (line.get_ydata() for line in middle.lines[:3])
    assert np.all(own == 0.0) and margin == pytest.approx(np.ones(len(margin)))
    assert theory[0] == pytest.approx(1.0) and np.all(np.diff(theory) < 0.0)
    assert bottom.lines[0].get_xdata() == pytest.approx(ds["displaced"].values)
