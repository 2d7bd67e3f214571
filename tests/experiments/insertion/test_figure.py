import numpy as np
import pytest

from gaspart.experiments.insertion import figure as insertion
from gaspart.experiments.insertion.measure import fill_failures
from gaspart.experiments.jobs.fill import fill
from gaspart.planning import grid
from gaspart.rendering import style


@pytest.fixture
def dataset(tmp_path):
    common = {"radius": 0.5, "attempts": 40, "replicas": 3}
    containers = {
        "source": {"dimension": 3, "count": 230, "side": 5.65, "boundary": "wall", "centres_to_walls": True},
        "discs": {"dimension": 2, "count": 200, "side": 15, "boundary": "periodic"},
        "dilute": {"dimension": 3, "count": 300, "packing_fraction": 0.05, "boundary": "periodic"},
    }
    points = []
    for name, settings in containers.items():
        point = grid.Point(name, "single", "fill", common | settings, str(tmp_path), 1)
        (tmp_path / name).mkdir()
        fill(grid.scene(point), 40, [point.seed(k) for k in range(3)]).to_netcdf(point.path)
        points.append(point)
    return fill_failures(
        points, {"saturated": ["source", "discs"], "bins": 8, "windows": [10], "dilute": 0.04}
    )


def test_it_draws_saturation_and_low_density(dataset, tmp_path):
    with style.applied():
        figure = insertion.fill_failures(dataset)
        style.save(figure, tmp_path / "figure.svg")
    assert len(figure.axes) == 3
    assert [text.get_text() for text in figure.legends[0].get_texts()] == [
        insertion.SERIES[3, "centres_to_walls"], insertion.SERIES[2, "periodic"]
    ]  # fmt: skip
    assert np.isfinite(dataset["saturation"].values[:2]).all()
