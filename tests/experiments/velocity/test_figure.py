import pytest
from experiments.velocity.data import correlations

from gaspart.experiments.velocity.figure import velocity_autocorrelation
from gaspart.rendering import style


@pytest.mark.parametrize("points", [[0, 1, 2, 3], [0], [3]])
def test_it_draws_what_there_is(points, tmp_path):
    with style.applied():
        figure = velocity_autocorrelation(correlations().isel(point=points))
        style.save(figure, tmp_path / "figure.svg")
    assert len(figure.axes) == 3 and all(axis.get_ylabel() for axis in figure.axes)
