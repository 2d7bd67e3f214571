import pytest
from reproduction.families.drawn import Points, draw, follows, lines, obeys, shows, varied

from gaspart import theory
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
    kept = ("side_over_diameter", "packing_fraction")
    ds = varied(dataset, *kept)
    figure = draw(insertion.fill_failures, ds)
    failures, dilute, filled = figure.axes
    source, discs, thin = (ds.isel(container=k) for k in range(3))
    names = [insertion.SERIES[key] for key in ((3, "centres_to_walls"), (2, "periodic"), (3, "periodic"))]

    def series(one, label):
        positive = one["failures_per_particle"].where(one["failures_per_particle"] > 0)
        return Points(label, one["packing_fraction"], positive, one["failures_per_particle_error"])

    shows(failures, "packing fraction", "failed", series(source, names[0]), series(discs, names[1]))
    shows(dilute, "packing fraction", "failures", series(thin, names[2]))
    for one, dimension in zip(lines(dilute), (2, 3), strict=True):
        obeys(one, lambda eta, d=dimension: theory.failures_per_particle(eta, d))
    drawn = lines(filled)
    for n, (one, dimension) in enumerate(((source, 3), (discs, 2))):
        points, fit, limit = drawn[3 * n : 3 * n + 3]
        follows(points, one["time"] ** (-1.0 / dimension), one["filled"])
        slope, end = (float(one[name][0]) for name in ("saturation_slope", "saturation"))
        obeys(fit, lambda x, a=end, b=slope: a + b * x)
        rule, side = one["rule"].item(), float(one["side_over_diameter"])
        follows(limit, [0.0], [theory.insertion_saturation(dimension, side, rule)])
    assert "attempts" in filled.get_xlabel() and "packing fraction" in filled.get_ylabel()
    assert [text.get_text() for text in figure.legends[0].get_texts()] == names[:2]
