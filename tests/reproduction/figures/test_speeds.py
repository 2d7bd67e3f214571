"""Particles that no other has hit, groups that share their scatter, and what speeds are refused for."""

import numpy as np
import pytest
import xarray as xr
from reproduction.figures.stored import runs_of

from gaspart.errors import SceneError
from gaspart.reproduction.figures import speeds
from gaspart.reproduction.points.point import Point


def test_walls_do_not_hit_but_the_last_bit_does():
    first = np.array([[0.6, -0.8], [1.0, 0.5]], dtype=np.float32)
    signs = np.array([[1, -1], [-1, -1], [1, 1]], dtype=np.float32)
    later = first * signs[:, None, :]
    later[2, 1, 0] = np.nextafter(later[2, 1, 0], np.float32(2))
    assert speeds.never_hit(later).tolist() == [1.0, 1.0, 0.5]


def test_the_smaller_group_takes_the_scatter_of_both():
    rng = np.random.default_rng(3)
    few, many = rng.normal(0.0, 1.0, (2, 5)), rng.normal(7.0, 1.0, (400, 5))
    for (_, errors), count in zip(speeds.shared_means([few, many]), (2, 400), strict=True):
        assert errors * np.sqrt(count) == pytest.approx(np.ones(5), rel=0.15)
    with pytest.raises(ValueError):
        speeds.shared_means([few[:1], many[:1]])


def point(count, experiment):
    settings = {
        "dimension": 3, "count": count, "radius": 0.2, "packing_fraction": 0.01, "speed": 1.0,
        "engine": "event", "duration": 2.0, "samples": 2, "replicas": 2,
    }  # fmt: skip
    return Point(experiment, "single", "simulate", settings, "results/points", 1)


def test_other_scenes_or_times_are_refused(monkeypatch):
    one, other, files = point(200, "speeds"), point(100, "other"), {}
    for made, count in ((one, 200), (other, 100)):
        velocities = np.random.default_rng(4).standard_normal((3, count, 3))
        columns = {"velocities": (("frame", "atom", "spatial"), velocities)}
        columns |= {name: ("frame", np.arange(3.0)) for name in ("time", "collisions", "kinetic_energy")}
        files |= dict.fromkeys(made.replica_paths, xr.Dataset(columns))
    monkeypatch.setattr(speeds, "runs", runs_of(files))
    settings = {"times": [1.0, 2.0], "bins": 20, "highest": 2.5}
    with pytest.raises(SceneError, match="scene and times"):
        speeds.measure_relaxation([one, other], settings)
    with pytest.raises(SceneError, match="sampled time"):
        speeds.measure_relaxation([one], settings | {"times": [1.5]})
