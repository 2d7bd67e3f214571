import numpy as np
from tradeoff_data import SECONDS, speed_accuracy_measurement

from gaspart.figures import style, tradeoff


def test_errors_are_drawn_against_the_step_and_costs_against_errors(tmp_path):
    with style.applied():
        figure = tradeoff.speed_accuracy(speed_accuracy_measurement(tmp_path))
        style.save(figure, tmp_path / "figure.png")
    assert len(figure.axes) == 3
    assert "error of $Z$ (%)" in [axis.get_ylabel() for axis in figure.axes]
    events = figure.axes[2].lines[-1].get_ydata()
    assert np.allclose(events, 1e6 * SECONDS)
