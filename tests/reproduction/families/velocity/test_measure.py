"""The autocorrelation from frames: of independent and of moving-average velocities, and of a real gas."""

import numpy as np
import pytest

import gaspart as gp
from gaspart.analysis.correlations import autocorrelation
from gaspart.reproduction.families.velocity import measure as velocity
from gaspart.reproduction.points.point import Point


def test_autocorrelation_is_the_mean_over_all_pairs_of_frames():
    values = np.random.default_rng(2).standard_normal((7, 5, 2))
    for lag, found in enumerate(autocorrelation(values, 4)):
        assert found == pytest.approx(np.mean(values[: 7 - lag] * values[lag:]), rel=1e-12)


def test_the_start_of_a_gas_is_enskogs_and_momentum_is_restored(tmp_path):
    settings = {
        "dimension": 3, "count": 256, "radius": 0.5, "boundary": "periodic", "packing_fraction": 0.2,
        "temperature": 2.0, "arrangement": "lattice", "collisions_per_particle": 12, "equilibration": 20,
        "samples": 240, "lags": 120, "replicas": 3,
    }  # fmt: skip
    point = Point("memory", "single", "simulate", settings, str(tmp_path), 3)
    recipe = point.parameters
    (tmp_path / "memory/single").mkdir(parents=True)
    for seed, path in zip(recipe["seeds"], point.replica_paths, strict=True):
        gp.run(
            point.scene,
            point.engine,
            tuple(seed),
            recipe["duration"],
            recipe["sample_interval"],
            path,
            correlations=gp.Correlations(**recipe["correlations"]),
        )
    fitted = {"start_to": 0.4, "tail": [2.0, 4.0]}
    ds = velocity.velocity_autocorrelation([point], fitted).isel(point=0)
    assert abs(ds["start_rate"].item() - 2.0 / 3.0) < 4.0 * ds["start_rate_error"].item() < 0.1
    assert ds["correlation"][0].item() == pytest.approx(1.0, rel=1e-12)  # (1 - 1/N) + 1/N
    assert ds["collisions"][1].item() == pytest.approx(0.05, rel=0.1)
    assert np.isnan(ds["tail_ratio"].item())
    ds = velocity.velocity_autocorrelation([point], fitted | {"start_to": 0.1}).isel(point=0)
    assert np.isnan(ds["start_rate"].item()) and np.isfinite(ds["tail_ratio"].item())


def test_the_initial_rate_is_that_of_the_logarithm():
    s = np.linspace(0.05, 0.3, 6)
    assert velocity._initial_rate(s, np.exp(-0.7 * s + 0.1 * s**2)) == pytest.approx(0.7, rel=1e-10)


def test_the_tail_is_extrapolated_over_the_modes():
    s = np.linspace(16.0, 60.0, 45)
    modes = s**-1.5
    fitted = velocity._tail(s, modes * (1.1 + 5.0 / s), modes)
    np.testing.assert_allclose(fitted, [1.1, 5.0], rtol=1e-9)
