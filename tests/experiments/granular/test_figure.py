import pytest
from experiments.granular.data import inelastic, rough

from gaspart.experiments.granular import figure as granular
from gaspart.rendering import style


@pytest.mark.parametrize(
    ("draw", "dataset", "panels"), [(granular.equipartition, rough(), 3), (granular.cooling, inelastic(), 4)]
)
def test_it_draws_all_its_panels(draw, dataset, panels, tmp_path):
    with style.applied():
        figure = draw(dataset)
        style.save(figure, tmp_path / "figure.svg")
    assert len(figure.axes) == panels and all(axis.get_ylabel() for axis in figure.axes)
