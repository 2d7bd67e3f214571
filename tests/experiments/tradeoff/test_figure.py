import numpy as np
from experiments.tradeoff.data import SECONDS, speed_accuracy_measurement, time_to_accuracy_measurement

from gaspart.experiments.tradeoff import figure as tradeoff
from gaspart.rendering import style


def test_errors_are_drawn_against_the_step_and_costs_against_errors(tmp_path):
    with style.applied():
        figure = tradeoff.speed_accuracy(speed_accuracy_measurement(tmp_path))
        style.save(figure, tmp_path / "figure.png")
    assert len(figure.axes) == 3
    assert "error of $Z$ (%)" in [axis.get_ylabel() for axis in figure.axes]
    events = figure.axes[2].lines[-1].get_ydata()
    assert np.allclose(events, 1e6 * SECONDS)


def test_costs_are_drawn_against_the_accuracy_for_each_gas(tmp_path):
    with style.applied():
        figure = tradeoff.time_to_accuracy(time_to_accuracy_measurement())
        style.save(figure, tmp_path / "figure.png")
    assert len(figure.axes) == 6
    assert [axis.get_title() for axis in figure.axes[:2]] == [
        r"spheres, $\eta = 0.05$",
        r"spheres, $\eta = 0.2$",
    ]
