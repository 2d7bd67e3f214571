"""Made-up trajectories and measurements of speeds, with known answers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.patches import StepPatch
from reproduction.claims.data import about, judged
from reproduction.families.drawn import Points, column, draw, follows, lines, shows, varied
from reproduction.families.stored import runs_of

import gaspart as gp
from gaspart import theory
from gaspart.errors import SceneError
from gaspart.reproduction.families.speeds import claims, figure, measure
from gaspart.reproduction.points.point import Point


def point(dimension=3, count=200, experiment="speeds", **more):
    """One point of a grid; nothing of it is run."""
    settings = {
        "dimension": dimension,
        "count": count,
        "radius": 0.2,
        "packing_fraction": 0.01,
        "speed": 1.0,
        "engine": "event",
        "duration": 3.0,
        "samples": 3,
        "replicas": 4,
    }
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


def relaxation_measurement(error=0.003, seed=5):
    """What `measure.speed_relaxation` gives if kinetic theory is right, with noise of the errors' size."""
    rng = np.random.default_rng(seed)
    theoretical = theory.relaxation(3)
    s = np.linspace(0.0, 3.6, 16)
    edges = np.linspace(0.0, 2.5, 26)
    shape = (2, s.size)
    density = np.diff(theory.maxwell_cdf(edges, 3, 1 / 3)) / np.diff(edges)

    def noisy(values, error):
        return ("engine", "frame"), values + error * rng.uniform(-1.0, 1.0, shape)

    rate = 3.55 / 150.0
    end = float(theoretical.collisions(rate * 150.0))
    return xr.Dataset(
        {
            "collisions": (("engine", "frame"), np.tile(s * end / 3.6, (2, 1))),
            "collisions_error": (("engine", "frame"), np.full(shape, 0.01)),
            "kurtosis": noisy(theoretical.kurtosis(s * end / 3.6), error),
            "kurtosis_error": (("engine", "frame"), np.full(shape, error)),
            "never_hit": noisy(theoretical.never_hit(s * end / 3.6), 0.3 * error),
            "never_hit_error": (("engine", "frame"), np.full(shape, 0.3 * error)),
            "temperature_drift": (("engine", "frame"), np.full(shape, 1e-16)),
            "temperature_drift_error": (("engine", "frame"), np.full(shape, 1e-17)),
            "density": (("engine", "snapshot", "bin"), np.tile(density, (2, 3, 1))),
            "density_error": (("engine", "snapshot", "bin"), np.full((2, 3, 25), 0.01)),
            "initial_slope": ("engine", np.full(2, 8 / 35)),
            "initial_slope_error": ("engine", np.full(2, 0.004)),
            "replicas": ("engine", np.array([6, 24])),
        },
        coords={
            "engine": ["step", "event"],
            "time": ("frame", 10.0 * np.arange(16)),
            "shown": ("snapshot", [5, 10, 15]),
            "lower": ("bin", edges[:-1]),
            "upper": ("bin", edges[1:]),
        },
        attrs={"dimension": 3, "count": 4000, "packing_fraction": 0.0012, "collision_rate": rate},
    )


RELAXATION = {"times": [1.0, 2.0], "bins": 20, "highest": 2.5}
DISTRIBUTION = {"bins": 20, "highest": 2.5, "classes": 20}


@pytest.fixture
def stored(monkeypatch):
    """Stands in for the files: `stored[path] = dataset`."""
    files = {}
    monkeypatch.setattr(measure, "runs", runs_of(files))
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


@pytest.mark.parametrize("dimension", [2, 3])
def test_kurtosis_of_equal_and_of_maxwellian_speeds(dimension):
    rng = np.random.default_rng(1)
    assert measure.kurtosis(np.full((3, 7), 2.5)) == pytest.approx(np.ones(3))
    sample = np.linalg.norm(rng.standard_normal((200_000, dimension)), axis=1)
    assert measure.kurtosis(sample) == pytest.approx(theory.kurtosis(dimension), abs=0.02)


def test_walls_do_not_hit_but_the_last_bit_does():
    first = np.array([[0.6, -0.8], [1.0, 0.5]], dtype=np.float32)
    signs = np.array([[1, -1], [-1, -1], [1, 1]], dtype=np.float32)
    later = first * signs[:, None, :]
    later[2, 1, 0] = np.nextafter(later[2, 1, 0], np.float32(2))
    assert measure.never_hit(later).tolist() == [1.0, 1.0, 0.5]


def test_a_mixture_of_hit_and_never_hit_particles_is_told_apart(stored):
    rng = np.random.default_rng(2)
    event, step = {"engine": "event", "replicas": 6}, {"engine": "step", "time_step": 0.1}
    chosen = [point(count=4000, **event), point(count=4000, experiment="other", **step)]
    for one in chosen:
        for path in one.replica_paths:
            stored[path] = trajectory(mixture(rng, 0.25)[[0, 1, 1]], [0.0, 1.0, 2.0])
    ds = measure.speed_relaxation(chosen, RELAXATION)
    assert ds["engine"].values.tolist() == ["event", "step"]
    assert ds["never_hit"].values == pytest.approx(np.array([[1.0, 0.25, 0.25]] * 2))
    expected = 0.25 + 0.75 * 5 / 3
    assert np.all(np.abs(ds["kurtosis"][:, 1:] - expected) < 4 * ds["kurtosis_error"][:, 1:])
    assert float(ds["kurtosis_error"].max()) < 0.02
    assert ds["collisions"].values == pytest.approx(np.array([[0.0, 1.0, 2.0]] * 2))
    widths = (ds["upper"] - ds["lower"]).values
    assert (ds["density"].values * widths).sum(axis=-1) == pytest.approx(np.ones((2, 2)), abs=2e-3)


def test_the_smaller_group_takes_the_scatter_of_both():
    rng = np.random.default_rng(3)
    few, many = rng.normal(0.0, 1.0, (2, 5)), rng.normal(7.0, 1.0, (400, 5))
    for errors, count in zip(measure.shared_error([few, many]), (2, 400), strict=True):
        assert errors * np.sqrt(count) == pytest.approx(np.ones(5), rel=0.15)
    with pytest.raises(ValueError):
        measure.shared_error([few[:1], many[:1]])


def test_other_scenes_or_times_are_refused(stored):
    rng = np.random.default_rng(4)
    one, other = point(), point(experiment="other", count=100)
    for made, count in ((one, 200), (other, 100)):
        for path in made.replica_paths:
            stored[path] = trajectory(mixture(rng, 0.5, count=count)[[0, 1, 1]], [0.0, 1.0, 2.0])
    with pytest.raises(SceneError, match="scene and times"):
        measure.speed_relaxation([one, other], RELAXATION)
    with pytest.raises(SceneError, match="sampled time"):
        measure.speed_relaxation([one], {**RELAXATION, "times": [1.5]})


@pytest.mark.parametrize("dimension", [2, 3])
def test_maxwellian_speeds_pass_and_others_do_not(stored, dimension):
    rng = np.random.default_rng(5)
    one = point(dimension=dimension, count=3000)
    for path in one.replica_paths:
        stored[path] = trajectory(equilibrium(rng, 4, 3000, dimension), [5.0, 10.0, 15.0, 20.0])
    ds = measure.distribution([one], DISTRIBUTION).isel(point=0)
    assert int(ds["samples"]) == 48_000
    assert int(ds["degrees_of_freedom"]) == 18
    assert float(ds["chi_square"]) < 45.0
    assert float(ds["kolmogorov_distance"]) * 48_000**0.5 < 1.5
    assert abs(float(ds["kurtosis"]) - theory.kurtosis(dimension, 3000)) < 4 * float(ds["kurtosis_error"])
    assert float(ds["temperature"]) == pytest.approx(1 / dimension, rel=1e-6)
    assert float(ds["collisions_between"]) == 5.0
    for path in one.replica_paths:
        stored[path] = trajectory(mixture(rng, 0.02, 3000, dimension)[[1, 1, 1, 1]], [5.0, 10.0, 15.0, 20.0])
    wrong = measure.distribution([one], DISTRIBUTION).isel(point=0)
    assert float(wrong["chi_square"]) > 100.0
    assert float(wrong["kolmogorov_distance"]) * 48_000**0.5 > 2.0


def test_the_conserved_energy_takes_a_degree_of_freedom(stored):
    rng = np.random.default_rng(6)
    one = point(count=400, replicas=1)
    found = []
    for _ in range(300):
        stored[one.replica_path(0)] = trajectory(equilibrium(rng, 1, 400, 3), [5.0])
        run = measure.read(one, first=0)[0]
        cdf = lambda u: theory.maxwell_cdf(u, 3, 1 / 3)  # noqa: E731
        found.append(measure.histogram_chi_square(run.speeds.ravel(), cdf, 10).chi_square)
    assert np.mean(found) == pytest.approx(8.0, abs=4 * np.sqrt(16 / 300))


def test_a_real_gas_relaxes(tmp_path):
    one = point(count=500, packing_fraction=0.05, duration=8.0, samples=8, replicas=2, boundary="wall")
    one = replace(one, root=str(tmp_path))
    times = one.schedule
    for k, path in enumerate(one.replica_paths):
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        gp.run(one.scene, one.engine, one.seed(k), times.duration, times.sample_interval, path)
    ds = measure.speed_relaxation([one], {"times": [2.0, 8.0], "bins": 10, "highest": 2.5}).isel(engine=0)
    s = ds["collisions"].values
    assert s[-1] > 4.0
    theoretical = theory.relaxation(3)
    assert ds["kurtosis"].values == pytest.approx(theoretical.kurtosis(s), abs=0.12)
    assert ds["never_hit"].values == pytest.approx(theoretical.never_hit(s), abs=0.06)
    assert float(ds["temperature_drift"].max()) < 1e-13
    assert s[-1] == pytest.approx(float(theoretical.collisions(ds.attrs["collision_rate"] * 8.0)), rel=0.15)


def distribution(dimension=3, **changes):
    """What `measure.distribution` gives of a gas in equilibrium."""
    values = {
        "packing_fraction": 0.1,
        "samples": 100_000,
        "count": 1000,
        "chi_square": 47.0,
        "degrees_of_freedom": 48,
        "kolmogorov_distance": 0.0025,
        "kurtosis": theory.kurtosis(dimension, 1000) + 0.002,
        "kurtosis_error": 0.003,
        "temperature": 1.0 / dimension,
        "given_temperature": 1.0 / dimension,
        "collisions_between": 5.0,
    }
    return xr.Dataset(
        {name: ("point", [value]) for name, value in (values | changes).items()},
        attrs={"dimension": dimension},
    )


def test_kinetic_theory_agrees_with_itself():
    found = judged(claims.speed_relaxation(relaxation_measurement()))
    assert len(found) == 18
    assert set(found.values()) == {"agrees"}


@pytest.mark.parametrize(
    ("name", "factor", "text"),
    [
        ("kurtosis", 1.05, "kurtosis of the speeds at"),
        ("never_hit", 1.3, "never hit"),
        ("collisions", 1.05, "collisions per particle until"),
        ("initial_slope", 1.1, "initial slope"),
        ("temperature_drift", 1e6, "drift of the energy"),
    ],
)
def test_each_claim_about_relaxation_can_fail(name, factor, text):
    ds = relaxation_measurement()
    ds[name] = ds[name] * factor
    assert "disagrees" in about(claims.speed_relaxation(ds), text)


def test_too_few_runs_are_inconclusive():
    assert about(claims.speed_relaxation(relaxation_measurement(error=0.02)), "kurtosis of") == {
        "inconclusive"
    }


@pytest.mark.parametrize("statement", [claims.speed_distribution_spheres, claims.speed_distribution_discs])
def test_maxwell_agrees(statement):
    dimension = 3 if statement is claims.speed_distribution_spheres else 2
    assert set(judged(statement(distribution(dimension))).values()) == {"agrees"}


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"chi_square": 110.0}, "chi-square"),
        ({"chi_square": 12.0}, "chi-square"),
        ({"kolmogorov_distance": 0.012}, "Kolmogorov"),
        ({"kurtosis": 1.64}, "kurtosis"),
        ({"temperature": np.nextafter(1 / 3, 1) + 1e-10}, "temperature"),
        ({"collisions_between": 2.0}, "between snapshots"),
    ],
)
def test_each_claim_about_maxwell_can_fail(changes, text):
    assert about(claims.distribution(distribution(3, **changes)), text) == {"disagrees"}


def distributions(dimension, points):
    """What `measure.distribution` gives of gases in equilibrium."""
    edges, steps = np.linspace(0.0, 2.5, 21), np.linspace(0.0, 2.5, 51)
    expected = np.diff(theory.maxwell_cdf(edges, dimension, 1 / dimension)) / np.diff(edges)
    bins, columns = ("point", "bin"), ("point", "step")
    return xr.Dataset(
        {
            "density": (bins, np.tile(expected, (points, 1))),
            "density_error": (bins, np.full((points, 20), 0.01)),
            "residual": (bins, np.ones((points, 20))),
            "difference": (columns, np.full((points, 51), 0.01)),
            "samples": ("point", np.full(points, 1000)),
            "packing_fraction": ("point", 0.1 * np.arange(1, points + 1)),
            "engine": ("point", ["event"] * points),
        },
        coords={"lower": ("bin", edges[:-1]), "upper": ("bin", edges[1:]), "speed": ("step", steps)},
        attrs={"dimension": dimension},
    )


def test_histograms_kurtosis_and_the_fraction_never_hit():
    ds = varied(relaxation_measurement())
    histograms, kurtosis, kurtosis_residual, unhit, unhit_residual = draw(figure.speed_relaxation, ds).axes
    middle = 0.5 * (ds["lower"] + ds["upper"])
    event, step = (ds.sel(engine=name) for name in ("event", "step"))
    shows(histograms, *(Points(middle, event["density"][k], event["density_error"][k]) for k in range(3)))
    outlines = [patch.get_data() for patch in histograms.patches if isinstance(patch, StepPatch)]
    for k, (values, edges, _) in enumerate(outlines):
        assert values == pytest.approx(step["density"][k].values)
        assert edges[:-1] == pytest.approx(ds["lower"].values)
    assert len(outlines) == 3
    relaxation = theory.relaxation(3)
    rows = [one.isel(frame=slice(1, None)) for one in (step, event)]
    for top, bottom, name in (
        (kurtosis, kurtosis_residual, "kurtosis"),
        (unhit, unhit_residual, "never_hit"),
    ):
        curve = getattr(relaxation, name)
        shows(top, *(column(row, "collisions", name) for row in rows))
        sigmas = [(row[name] - curve(row["collisions"])) / row[f"{name}_error"] for row in rows]
        shows(bottom, *(Points(row["collisions"], s) for row, s in zip(rows, sigmas, strict=True)))


@pytest.mark.parametrize(
    ("function", "dimension", "points"),
    [(figure.speed_distribution_spheres, 3, 3), (figure.speed_distribution_discs, 2, 1)],
)
def test_density_residuals_tails_and_the_difference_of_the_distribution(function, dimension, points):
    ds = varied(distributions(dimension, points), "packing_fraction")
    ds["density"][:, -1] = 0.0  # a bin in which nothing was seen
    density, residual, tail, difference = draw(function, ds).axes
    middle, width = 0.5 * (ds["lower"] + ds["upper"]), 0.125
    rows = [ds.isel(point=k) for k in range(points)]
    beside = [middle + width * 0.25 * (k - 0.5 * (points - 1)) for k in range(points)]
    shows(density, *(Points(middle, row["density"], row["density_error"]) for k, row in enumerate(rows)))
    shows(residual, *(Points(beside[k], row["residual"]) for k, row in enumerate(rows)))
    seen = [row.isel(bin=slice(-1)) for row in rows]
    shows(tail, *(Points(beside[k][:-1], row["density"], row["density_error"]) for k, row in enumerate(seen)))
    for k, row in enumerate(rows):
        follows(lines(difference)[k], ds["speed"], 1000**0.5 * row["difference"])
