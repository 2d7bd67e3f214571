import pytest
from experiments.virial.data import equation_of_state

from gaspart.experiments.virial import figure as virial
from gaspart.rendering import style


@pytest.mark.parametrize("dimension", [2, 3])
def test_it_draws_all_its_panels(dimension, tmp_path):
    draw = {2: virial.virial_discs, 3: virial.virial_spheres}[dimension]
    with style.applied():
        figure = draw(equation_of_state(dimension))
        style.save(figure, tmp_path / "figure.svg")
    assert len(figure.axes) == 3 and all(axis.get_ylabel() for axis in figure.axes)


def test_it_draws_without_fits(tmp_path):
    with style.applied():
        figure = virial.virial_discs(equation_of_state(2).isel(fit=slice(0, 0)))
        style.save(figure, tmp_path / "figure.png")
