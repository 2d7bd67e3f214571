"""Overlaps that are counted, and what is kept of a scene."""

import numpy as np
import pytest

from gaspart import run
from gaspart.reproduction.figures import pictures
from gaspart.reproduction.points.point import Point

CUBE = np.full(3, 10.0)


@pytest.mark.parametrize(
    ("second", "periodic", "expected"),
    [
        ([2.9, 2.0, 2.0], False, 1),
        ([3.0 - 1e-6, 2.0, 2.0], False, 0),  # rounding
        ([3.01, 2.0, 2.0], False, 0),
        ([2.0, 2.0, 9.9], False, 0),
        ([2.0, 2.0, 9.9], True, 0),
        ([2.0, 2.0, 11.1], True, 1),
    ],
)
def test_overlapping_pairs(second, periodic, expected):
    places = np.array([[2.0, 2.0, 2.0], second, [7.0, 7.0, 7.0]])
    assert pictures.overlapping(places, np.full(3, 0.5), CUBE, (periodic,) * 3) == expected


def test_overlaps_across_a_face_and_with_a_large_particle():
    places = np.array([[0.2, 5.0, 5.0], [9.6, 5.0, 5.0], [5.0, 5.0, 5.0], [5.0, 7.4, 5.0], [5.0, 8.1, 5.0]])
    radii = np.array([0.5, 0.5, 2.0, 0.5, 0.5])
    assert pictures.overlapping(places, radii, CUBE, (False,) * 3) == 2
    assert pictures.overlapping(places, radii, CUBE, (True, False, False)) == 3


@pytest.mark.thorough
def test_a_scene_is_counted_and_kept_for_drawing(tmp_path):
    settings = {
        "scene": "config/scenes/brownian.yaml", "scene.species.0.count": 200, "duration": 2.0, "samples": 1,
    }  # fmt: skip
    point = Point("brownian_render", "single", "simulate", settings, str(tmp_path), 1)
    (tmp_path / "brownian_render/single").mkdir(parents=True)
    run(point.scene, point.engine, 1, 2.0, 2.0, point.replica_path(0))
    ds = pictures.measure([point], {})
    assert ds.sizes["particle"] == ds.attrs["count"] == 201
    assert float(ds["overlaps"]) == 0.0 and float(ds["resolved"]) == 0.0
    assert ds["radius"].values.tolist() == [10.0] + [0.5] * 200
    assert float(ds["mean_speed"]) == pytest.approx(1.0, abs=0.1)
    assert {claim.measured.value - claim.expected.value for claim in pictures.brownian_claims(ds)} == {0.0}
    lost = ds.isel(particle=slice(200))
    off = [claim for claim in pictures.brownian_claims(lost) if claim.measured != claim.expected]
    assert len(off) == 2
