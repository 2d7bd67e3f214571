"""Made-up trajectories and measurements of speeds, with known answers."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from reproduction.figures.stored import runs_of

from gaspart import theory
from gaspart.analysis.statistics import histogram_chi_square
from gaspart.errors import SceneError
from gaspart.reproduction.figures import speeds
from gaspart.reproduction.figures.speeds import measure_distribution, measure_relaxation
from gaspart.reproduction.points.point import Point


def point(dimension=3, count=200, experiment="speeds", **more):
    """One point of a grid; nothing of it is run."""
    settings = {
        "dimension": dimension, "count": count, "radius": 0.2, "packing_fraction": 0.01, "speed": 1.0,
        "engine": "event", "duration": 3.0, "samples": 3, "replicas": 4,
    }  # fmt: skip
    return Point(experiment, "single", "simulate", settings | more, "results/points", 1)


def trajectory(velocities, collisions):
    """What `open_trajectory` gives of speeds: velocities (T, N, d), collisions per particle (T,)."""
    frames, count, _ = velocities.shape
    return xr.Dataset(
        {
            "velocities": (("frame", "atom", "spatial"), velocities.astype(np.float32)),
            "collisions": ("frame", 0.5 * count * np.asarray(collisions, dtype=float)),
            "kinetic_energy": ("frame", 0.5 * (velocities**2).sum(axis=(1, 2))),
        },
        coords={"time": ("frame", np.arange(float(frames)))},
    )


def directions(rng, count, dimension):
    """(count, dimension) random unit vectors."""
    vectors = rng.standard_normal((count, dimension))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def equilibrium(rng, frames, count, dimension):
    """(frames, count, dimension) exactly microcanonical velocities, <v^2> = 1."""
    velocities = rng.standard_normal((frames, count, dimension))
    return velocities / np.sqrt((velocities**2).sum(axis=(1, 2), keepdims=True) / count)


RELAXATION = {"times": [1.0, 2.0], "bins": 20, "highest": 2.5}
DISTRIBUTION = {"bins": 20, "highest": 2.5, "classes": 20}


@pytest.fixture
def stored(monkeypatch):
    """Stands in for the files: `stored[path] = dataset`."""
    files = {}
    monkeypatch.setattr(speeds, "runs", runs_of(files))
    return files


def mixture(rng, never, count=4000, dimension=3):
    """(2, count, dimension): frame 0 of equal speeds; later, all but the share `never` are in equilibrium.

    Those never hit have met walls, which turn signs.
    """
    first = directions(rng, count, dimension)
    later = equilibrium(rng, 1, count, dimension)[0]
    untouched = round(never * count)
    later[untouched:] /= np.sqrt((later[untouched:] ** 2).sum() / (count - untouched))
    later[:untouched] = first[:untouched] * rng.choice([-1.0, 1.0], (untouched, dimension))
    return np.stack([first, later])


def test_walls_do_not_hit_but_the_last_bit_does():
    first = np.array([[0.6, -0.8], [1.0, 0.5]], dtype=np.float32)
    signs = np.array([[1, -1], [-1, -1], [1, 1]], dtype=np.float32)
    later = first * signs[:, None, :]
    later[2, 1, 0] = np.nextafter(later[2, 1, 0], np.float32(2))
    assert speeds.never_hit(later).tolist() == [1.0, 1.0, 0.5]


def test_a_mixture_of_hit_and_never_hit_particles_is_told_apart(stored):
    rng = np.random.default_rng(2)
    event, step = {"engine": "event", "replicas": 6}, {"engine": "step", "time_step": 0.1}
    chosen = [point(count=4000, **event), point(count=4000, experiment="other", **step)]
    for one in chosen:
        for path in one.replica_paths:
            stored[path] = trajectory(mixture(rng, 0.25)[[0, 1, 1]], [0.0, 1.0, 2.0])
    ds = measure_relaxation(chosen, RELAXATION | {"highest": 2.6})  # speed 1 is inside a bin
    assert ds["engine"].values.tolist() == ["event", "step"]
    assert ds["never_hit"].values == pytest.approx(np.array([[1.0, 0.25, 0.25]] * 2))
    expected = 0.25 + 0.75 * 5 / 3
    assert np.all(np.abs(ds["kurtosis"][:, 1:] - expected) < 4 * ds["kurtosis_error"][:, 1:])
    assert float(ds["kurtosis_error"].max()) < 0.02
    assert ds["collisions"].values == pytest.approx(np.array([[0.0, 1.0, 2.0]] * 2))
    widths = (ds["upper"] - ds["lower"]).values
    classes = np.diff([*theory.maxwell_cdf(np.append(ds["lower"], ds["upper"][-1]), 3, 1 / 3), 1.0])
    first = np.searchsorted(ds["upper"], 1.0)
    mixed = 0.25 * (np.arange(21) == first) + 0.75 * classes
    deficits = [-np.log(classes[first]), *[(mixed * np.log(mixed / classes)).sum()] * 2]
    assert np.all(np.abs(ds["entropy_deficit"] - deficits) <= 4 * ds["entropy_deficit_error"] + 1e-12)
    assert (ds["entropy_deficit_error"] < 0.03).all()
    assert (ds["density"].values * widths).sum(axis=-1) == pytest.approx(np.ones((2, 2)), abs=2e-3)


def test_the_smaller_group_takes_the_scatter_of_both():
    rng = np.random.default_rng(3)
    few, many = rng.normal(0.0, 1.0, (2, 5)), rng.normal(7.0, 1.0, (400, 5))
    for (_, errors), count in zip(speeds.shared_means([few, many]), (2, 400), strict=True):
        assert errors * np.sqrt(count) == pytest.approx(np.ones(5), rel=0.15)
    with pytest.raises(ValueError):
        speeds.shared_means([few[:1], many[:1]])


def test_other_scenes_or_times_are_refused(stored):
    rng = np.random.default_rng(4)
    one, other = point(), point(experiment="other", count=100)
    for made, count in ((one, 200), (other, 100)):
        for path in made.replica_paths:
            stored[path] = trajectory(mixture(rng, 0.5, count=count)[[0, 1, 1]], [0.0, 1.0, 2.0])
    with pytest.raises(SceneError, match="scene and times"):
        measure_relaxation([one, other], RELAXATION)
    with pytest.raises(SceneError, match="sampled time"):
        measure_relaxation([one], {**RELAXATION, "times": [1.5]})


@pytest.mark.parametrize("dimension", [2, 3])
def test_maxwellian_speeds_pass_and_others_do_not(stored, dimension):
    rng = np.random.default_rng(5)
    one = point(dimension=dimension, count=3000)
    for path in one.replica_paths:
        stored[path] = trajectory(equilibrium(rng, 4, 3000, dimension), [5.0, 10.0, 15.0, 20.0])
    ds = measure_distribution([one], DISTRIBUTION).isel(point=0)
    assert int(ds["samples"]) == 48_000
    assert int(ds["degrees_of_freedom"]) == 18
    assert float(ds["chi_square"]) < 45.0
    assert float(ds["kolmogorov_distance"]) * 48_000**0.5 < 1.5
    assert abs(float(ds["kurtosis"]) - theory.kurtosis(dimension, 3000)) < 4 * float(ds["kurtosis_error"])
    assert float(ds["temperature"]) == pytest.approx(1 / dimension, rel=1e-6)
    assert float(ds["collisions_between"]) == 5.0
    for path in one.replica_paths:
        stored[path] = trajectory(mixture(rng, 0.02, 3000, dimension)[[1, 1, 1, 1]], [5.0, 10.0, 15.0, 20.0])
    wrong = measure_distribution([one], DISTRIBUTION).isel(point=0)
    assert float(wrong["chi_square"]) > 100.0
    assert float(wrong["kolmogorov_distance"]) * 48_000**0.5 > 2.0


def test_the_conserved_energy_takes_a_degree_of_freedom(stored):
    rng = np.random.default_rng(6)
    one = point(count=400, replicas=1)
    found = []
    for _ in range(300):
        stored[one.replica_path(0)] = trajectory(equilibrium(rng, 1, 400, 3), [5.0])
        (run,) = map(speeds.Velocities, speeds.runs(one, 0))
        cdf = lambda u: theory.maxwell_cdf(u, 3, 1 / 3)  # noqa: E731
        found.append(histogram_chi_square(run.speeds.ravel(), cdf, 10).chi_square)
    assert np.mean(found) == pytest.approx(8.0, abs=4 * np.sqrt(16 / 300))
