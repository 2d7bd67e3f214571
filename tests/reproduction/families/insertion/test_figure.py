import pytest
from reproduction.families.drawn import Points, draw, follows, lines, shows, varied

from gaspart.reproduction.families.insertion import figure as insertion
from gaspart.reproduction.families.insertion.measure import fill_failures
from gaspart.reproduction.jobs.fill import fill
from gaspart.reproduction.points.point import Point


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
        point = Point(name, "single", "fill", common | settings, str(tmp_path), 1)
        (tmp_path / name).mkdir()
        fill(point.scene, 40, [point.seed(k) for k in range(3)]).write(point.path)
        points.append(point)
    return fill_failures(
        points, {"saturated": ["source", "discs"], "bins": 8, "windows": [10], "dilute": 0.04}
    )


def test_failures_and_the_approach_to_saturation_are_drawn(dataset):
    ds = varied(dataset, "side_over_diameter", "packing_fraction")
    failures, dilute, filled = draw(insertion.fill_failures, ds).axes
    source, discs, thin = (ds.isel(container=k) for k in range(3))

    def series(one):
        positive = one["failures_per_particle"].where(one["failures_per_particle"] > 0)
        return Points(one["packing_fraction"], positive, one["failures_per_particle_error"])

    shows(failures, series(source), series(discs))
    shows(dilute, series(thin))
    for n, (one, dimension) in enumerate(((source, 3), (discs, 2))):
        follows(lines(filled)[3 * n], one["time"] ** (-1.0 / dimension), one["filled"])
