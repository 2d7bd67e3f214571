import numpy as np
from experiments.adsorption.data import walls

from gaspart.experiments.adsorption import figure as adsorption
from gaspart.rendering import style


def test_it_draws_all_its_panels(tmp_path):
    with style.applied():
        figure = adsorption.adsorption(walls())
        style.save(figure, tmp_path / "figure.svg")
    assert len(figure.axes) == 6
    assert all(axis.get_xlabel() or axis is figure.axes[0] for axis in figure.axes)
    off = figure.axes[1].containers[0].lines[0].get_ydata()
    assert np.abs(off).max() < 1e-9  # made as theory says
