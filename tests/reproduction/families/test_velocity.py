"""A made-up velocity autocorrelation with known answers, as `measure.velocity_autocorrelation` gives it."""

from __future__ import annotations

import numpy as np
import pytest
from reproduction.families.drawn import Points, column, draw, shows, varied

import gaspart as gp
from gaspart import theory
from gaspart.analysis.motion import autocorrelation
from gaspart.reproduction.claims import judge
from gaspart.reproduction.families.motion import measure
from gaspart.reproduction.families.motion.claims import (
    velocity_autocorrelation as claims_of_velocity_autocorrelation,
)
from gaspart.reproduction.families.motion.figure import (
    velocity_autocorrelation as draw_velocity_autocorrelation,
)
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table


def correlations(start=1.0, tail=1.0, error=0.01, seed=1):
    """Two finely sampled points and two long ones; start and tail: over theory's."""
    rng = np.random.default_rng(seed)

    def gas(stated):
        dimension, eta, interval = stated
        s = interval * np.arange(41)
        time = s / theory.collision_rate(eta, dimension)
        late = theory.velocity_autocorrelation_tail(np.maximum(time, 0.1), eta, dimension)
        correlation = np.exp(-2.0 / dimension * s) + tail * late * (s > 5.0)
        row = {"dimension": dimension, "packing_fraction": eta, "count": 2048, "sound": 60.0, "time": time}
        row |= {"collisions": s, "correlation": (correlation, np.full(41, 2e-4))}
        if interval == 1.0:
            ratio = tail + error * rng.standard_normal(), error
            return row | {"tail_from": 16.0, "tail_to": 60.0, "tail_ratio": ratio, "tail_correction": 4.0}
        rate = 2.0 / dimension * (start + 0.002 * rng.standard_normal())
        return row | {"start_rate": (rate, 2.0 / dimension * 0.002)}

    gases = (2, 0.3, 0.05), (3, 0.3, 0.05), (2, 0.2, 1.0), (3, 0.3, 1.0)
    return table("point", gases, gas, inner=("lag",))


# The autocorrelation from frames: of independent and of moving-average velocities, and of a real gas.


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
    ds = measure.velocity_autocorrelation([point], fitted).isel(point=0)
    assert abs(ds["start_rate"].item() - 2.0 / 3.0) < 4.0 * ds["start_rate_error"].item() < 0.1
    assert ds["correlation"][0].item() == pytest.approx(1.0, rel=1e-12)  # (1 - 1/N) + 1/N
    assert ds["collisions"][1].item() == pytest.approx(0.05, rel=0.1)
    assert np.isnan(ds["tail_ratio"].item())
    ds = measure.velocity_autocorrelation([point], fitted | {"start_to": 0.1}).isel(point=0)
    assert np.isnan(ds["start_rate"].item()) and np.isfinite(ds["tail_ratio"].item())


def test_the_initial_rate_is_that_of_the_logarithm():
    s = np.linspace(0.05, 0.3, 6)
    assert measure._initial_rate(s, np.exp(-0.7 * s + 0.1 * s**2)) == pytest.approx(0.7, rel=1e-10)


def test_the_tail_is_extrapolated_over_the_modes():
    s = np.linspace(16.0, 60.0, 45)
    modes = s**-1.5
    fitted = measure._tail(s, modes * (1.1 + 5.0 / s), modes)
    np.testing.assert_allclose(fitted, [1.1, 5.0], rtol=1e-9)


def verdicts(dataset, beginning=""):
    claims = claims_of_velocity_autocorrelation(dataset)
    return {
        verdict
        for claim, verdict in zip(claims, judge(claims), strict=True)
        if claim.claim.startswith(beginning)
    }


def test_right_data_agree():
    assert verdicts(correlations()) == {"agrees"}


@pytest.mark.parametrize(
    ("wrong", "beginning"),
    [({"start": 1.02}, "initial decay"), ({"tail": 0.5}, "long-time")],
)
def test_a_wrong_memory_is_found(wrong, beginning):
    assert "disagrees" in verdicts(correlations(**wrong), beginning)


def test_short_runs_are_inconclusive():
    assert "inconclusive" in verdicts(correlations(error=0.4), "long-time")


@pytest.mark.parametrize("points", [[0, 1, 2, 3], [0], [3]])
def test_the_tail_the_start_and_their_ratio_are_drawn(points):
    ds = correlations().isel(point=points)
    whole = varied(ds, "packing_fraction", "sound", "start_rate", "tail_ratio", "tail_correction")
    ds = whole.assign({name: ds[name] for name in ("tail_from", "tail_to")})
    tails, starts, ratios = draw(draw_velocity_autocorrelation, ds).axes
    fine = [ds.isel(point=k) for k in range(len(points)) if np.isfinite(ds["start_rate"][k])]
    long = [ds.isel(point=k) for k in range(len(points)) if np.isfinite(ds["tail_ratio"][k])]
    for axis, rows in ((tails, long), (starts, fine)):
        shows(axis, *(column(row, "collisions", "correlation", some=True) for row in rows))
    expected = []
    for row in long:
        at = row.isel(lag=np.flatnonzero(row["collisions"].values > 5.0))
        gas = float(row["packing_fraction"]), int(row["dimension"]), int(row["count"])
        modes = theory.velocity_autocorrelation_modes(at["time"].values, *gas)
        share = 1.0 / int(row["count"])
        seen = (at["correlation"] - share) / (modes - share), at["correlation_error"] / (modes - share)
        expected.append(Points(at["collisions"], *seen, some=True))
    shows(ratios, *expected)
