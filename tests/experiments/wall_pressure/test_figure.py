from experiments.wall_pressure.data import pressures

from gaspart.experiments.wall_pressure.figure import wall_pressure
from gaspart.rendering import style


def test_it_draws_all_its_panels(tmp_path):
    with style.applied():
        figure = wall_pressure(pressures())
        style.save(figure, tmp_path / "figure.svg")
    assert len(figure.axes) == 3 and all(axis.get_ylabel() for axis in figure.axes)


def test_it_draws_one_dimension_without_temperatures(tmp_path):
    with style.applied():
        style.save(wall_pressure(pressures().isel(point=[0, 1, 6])), tmp_path / "figure.png")
