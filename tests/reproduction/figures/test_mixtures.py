"""Settings of points of mixtures."""

import pytest

import gaspart as gp
from gaspart import theory
from gaspart.reproduction.points.point import Point

GAS = {
    "dimension": 3, "count": 200, "radius": 0.5, "packing_fraction": 0.2, "boundary": "periodic",
    "temperature": 1.0, "exact_temperature": True, "engine": "event", "collisions_per_particle": 300,
    "equilibration": 20, "samples": 32, "replicas": 2,
}  # fmt: skip
TWO = {"size_ratio": 0.6, "small_fraction": 0.5, "pairs": True}


def point(**settings):
    return Point("mixture", "one", "simulate", GAS | settings, "results", 1)


def test_points_of_two_sizes_and_of_many():
    scene = point(**TWO).scene
    assert [kind.count for kind in scene.species] == [100, 100]
    assert [kind.radius for kind in scene.species] == [0.5, 0.3]
    assert scene.packing_fraction == pytest.approx(0.2, rel=1e-12)
    many = point(polydispersity=0.1, radius_distribution="uniform")
    assert many.scene.packing_fraction == pytest.approx(0.2, rel=1e-12)
    rate = theory.mixture_collision_rates(*many.scene.mixture.sizes).sum(axis=1).mean()
    assert many.schedule.sample_interval * 32 == pytest.approx(300 / rate, rel=2e-3)


@pytest.mark.parametrize(
    ("key", "settings"),
    [
        ("size_ratio", {"size_ratio": 0.5}),
        ("small_fraction", {"small_fraction": 0.5}),
        ("size_ratio", {**TWO, "polydispersity": 0.1}),
        ("radius_distribution", {"radius_distribution": "uniform"}),
        ("size_ratio", {**TWO, "count": None, "side": 10.0}),
    ],
)
def test_keys_that_need_or_exclude_each_other(key, settings):
    given = {name: value for name, value in (GAS | settings).items() if value is not None}
    with pytest.raises(gp.SceneError, match=rf"^experiments\.mixture\.{key} = "):
        _ = Point("mixture", "one", "simulate", given, "results", 1).scene
