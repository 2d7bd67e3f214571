"""Made-up fills with known answers."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from reproduction.claims.data import judged
from reproduction.families.drawn import Points, draw, follows, lines, shows, varied

from gaspart import theory
from gaspart.reproduction.families.insertion import figure
from gaspart.reproduction.families.insertion.claims import fill_failures as claims_of_fill_failures
from gaspart.reproduction.families.insertion.measure import (
    Fill,
    approach_exponent,
    dilute_failures,
    failures_by_density,
    saturation,
)
from gaspart.reproduction.families.insertion.measure import fill_failures as measure_fill_failures
from gaspart.reproduction.jobs.fill import fill
from gaspart.reproduction.points.point import Point


def fill_to(saturation, amplitude, dimension, particle=1e-4, last_time=5e3, replicas=6, seed=3):
    """Fills whose packing fraction is saturation - amplitude t^(-1/dimension), to a particle, from t = 1 on.

    Each replica's saturation is shifted by a little noise.
    """
    rng = np.random.default_rng(seed)
    ends = saturation + 2e-4 * rng.standard_normal(replicas)
    particles = int((saturation + 0.01) / particle)
    failures = np.full((replicas, particles), -1)
    for row, end in zip(failures, ends, strict=True):
        eta = particle * (np.arange(particles) + 1.0)
        gap = end - eta
        times = np.where(gap > 0.0, (np.maximum(gap, 1e-30) / amplitude) ** -float(dimension), np.inf)
        placed = np.flatnonzero(times <= last_time)
        attempts = np.maximum.accumulate(np.maximum(np.round(times[placed] / particle), placed + 1)).astype(
            int
        )
        row[placed] = np.maximum(np.diff(attempts, prepend=0) - 1, 0)
    return Fill(failures, np.full(replicas, int(last_time / particle)), particle, dimension)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_straight_approach_leads_to_its_end(dimension):
    value, error, slope = saturation(fill_to(0.4, 0.2, dimension), window=10.0)
    assert abs(value - 0.4) < 4.0 * error + 1e-4
    assert 2e-5 < error < 4e-4
    assert slope == pytest.approx(-0.2, rel=0.02)


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_exponent_of_the_approach(dimension):
    value, error = approach_exponent(fill_to(theory.RSA_SATURATION[dimension], 0.2, dimension), window=10.0)
    assert value == pytest.approx(1.0 / dimension, abs=4.0 * error + 0.01)


def test_attempts_that_found_no_place_count_where_they_were_made():
    one = Fill(np.array([[0, 3, -1, -1], [1, 1, 5, -1]]), np.array([20, 40]), 0.1, 2)
    failures, successes = one.trials()
    assert failures.tolist() == [[0, 3, 15, 0], [1, 1, 5, 30]]
    assert successes.tolist() == [[1, 1, 0, 0], [1, 1, 1, 0]]
    assert (failures + successes).sum(axis=1).tolist() == [20, 40]


def test_packing_fraction_counts_the_particles_placed_in_time():
    one = Fill(np.array([[0, 3, -1]]), np.array([20]), 0.1, 2)  # placed at attempts 1 and 5
    assert one.packing_fraction(np.array([0.05, 0.1, 0.45, 0.5, 2.0])) == pytest.approx(
        np.array([[0.0, 0.1, 0.1, 0.2, 0.2]])
    )


def test_failures_of_a_geometric_distribution():
    rng = np.random.default_rng(1)
    failures = rng.geometric(0.25, size=(8, 400)) - 1
    one = Fill(failures, failures.sum(axis=1) + 400, 1e-3, 2)
    eta, mean, error = failures_by_density(one, bins=4)
    assert eta == pytest.approx([0.0495, 0.1495, 0.2495, 0.3495])
    assert np.all(np.abs(mean - 3.0) < 4.0 * error)
    assert error == pytest.approx(np.full(4, np.sqrt(12.0 / 800)), rel=0.8)


def test_bins_that_few_replicas_reach_are_left_out():
    one = Fill(np.array([[0] * 10, [0] * 4 + [-1] * 6, [0] * 4 + [-1] * 6]), np.array([10, 50, 50]), 0.01, 2)
    _, mean, _ = failures_by_density(one, bins=5)
    assert np.isfinite(mean[:2]).all() and np.isnan(mean[3:]).all()


def point(tmp_path, name, **settings):
    found = Point(name, "single", "fill", settings, str(tmp_path), 5)
    data = fill(found.scene, settings["attempts"], [found.seed(k) for k in range(found.replicas)])
    (tmp_path / name).mkdir()
    data.write(found.path)
    return found


def test_real_fills(tmp_path):
    periodic = {"radius": 0.5, "boundary": "periodic", "replicas": 4}
    source = {"radius": 1.77, "side": 20, "boundary": "wall", "centres_to_walls": True, "replicas": 4}
    points = [
        point(tmp_path, "discs", dimension=2, count=600, side=27, attempts=300, **periodic),
        point(tmp_path, "source", dimension=3, count=230, attempts=300, **source),
        point(tmp_path, "dilute", dimension=3, count=3000, packing_fraction=0.05, attempts=20, **periodic),
    ]
    settings = {"saturated": ["discs", "source"], "bins": 12, "windows": [10, 3], "dilute": 0.04}
    dataset = measure_fill_failures(points, settings)
    assert dataset["rule"].values.tolist() == ["periodic", "centres_to_walls", "periodic"]
    ends = dataset["saturation"].values[:, 0]
    assert ends[0] == pytest.approx(0.547, abs=0.02) and ends[1] == pytest.approx(0.53, abs=0.04)
    assert np.isnan(ends[2])
    ratio, error = (float(dataset[name][2]) for name in ("dilute_failures", "dilute_failures_error"))
    assert abs(ratio - 1.0) < 4.0 * error
    assert error < 0.05
    assert float(dataset["failures_per_particle"][0, -1]) > 100.0


def test_low_density_failures_are_compared_particle_by_particle():
    expected = theory.failures_per_particle(np.arange(400) * 1e-4, 3)
    rng = np.random.default_rng(2)
    failures = rng.geometric(1.0 / (1.0 + expected), size=(200, 400)) - 1
    ratio, error = dilute_failures(Fill(failures, failures.sum(axis=1) + 400, 1e-4, 3), up_to=0.04)
    assert abs(ratio - 1.0) < 4.0 * error and error < 0.02


def fills(**changes):
    """Four containers, as a long run would measure them."""
    side = np.array([5.65, 14.0, 100.0, 50.0])
    rule = ["centres_to_walls", "periodic", "periodic", "periodic"]
    ends = [
        theory.insertion_saturation(3, 5.65, rule[0]),
        theory.RSA_SATURATION[3],
        theory.RSA_SATURATION[2],
        np.nan,
    ]
    columns = {
        "dimension": np.array([3, 3, 2, 3]),
        "side_over_diameter": side,
        "rule": np.array(rule),
        "final_spread": np.array([0.011, 0.002, 0.001, 0.0]),
        "approach": np.array([np.nan, 0.34, 0.49, np.nan]),
        "approach_error": np.array([np.nan, 0.01, 0.02, np.nan]),
        "dilute_failures": np.array([np.nan, 1.0, 1.0, 1.004]),
        "dilute_failures_error": np.array([np.nan, 0.05, 0.05, 0.006]),
        "saturation": np.array(ends),
        "saturation_error": np.array([0.0025, 0.0008, 0.0005, np.nan]),
    } | changes  # fmt: skip
    made = {
        name: (("container", "window"), values[:, None])
        if name.startswith("saturation")
        else ("container", values)
        for name, values in columns.items()
    }
    return xr.Dataset(made, attrs={"dilute_up_to": 0.04})


def verdicts(found):
    return judged(claims_of_fill_failures(found))


def test_right_data_agree():
    found = verdicts(fills())
    assert len(found) == 7
    assert sorted(found.values()) == ["agrees"] * 5 + ["no verdict", "reproduced"]


@pytest.mark.parametrize(
    ("changes", "start"),
    [
        ({"saturation": np.array([0.53, 0.390, 0.547, np.nan])}, "saturation of random insertion, spheres p"),
        ({"saturation": np.array([0.53, 0.3841, 0.544, np.nan])}, "saturation of random insertion, d"),
        ({"saturation": np.array([0.46, 0.3841, 0.547, np.nan])}, "packing fraction at which insertion ends"),
        ({"approach": np.array([np.nan, 0.5, 0.49, np.nan])}, "exponent p"),
        ({"dilute_failures": np.array([np.nan, 1.0, 1.0, 0.95])}, "failed attempts up to"),
    ],
)  # fmt: skip
def test_wrong_data_disagree(changes, start):
    found = verdicts(fills(**changes))
    assert {"disagrees", "source in error"} & {
        verdict for text, verdict in found.items() if text.startswith(start)
    }


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
    return measure_fill_failures(
        points, {"saturated": ["source", "discs"], "bins": 8, "windows": [10], "dilute": 0.04}
    )


def test_failures_and_the_approach_to_saturation_are_drawn(dataset):
    ds = varied(dataset, "side_over_diameter", "packing_fraction")
    failures, dilute, filled = draw(figure.fill_failures, ds).axes
    source, discs, thin = (ds.isel(container=k) for k in range(3))

    def series(one):
        positive = one["failures_per_particle"].where(one["failures_per_particle"] > 0)
        return Points(one["packing_fraction"], positive, one["failures_per_particle_error"])

    shows(failures, series(source), series(discs))
    shows(dilute, series(thin))
    for n, (one, dimension) in enumerate(((source, 3), (discs, 2))):
        follows(lines(filled)[3 * n], one["time"] ** (-1.0 / dimension), one["filled"])
