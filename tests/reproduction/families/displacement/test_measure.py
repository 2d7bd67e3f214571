from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from reproduction.families.displacement.data import langevin, point

import gaspart as gp
from gaspart import theory
from gaspart.analysis.correlations import Curves, correlate
from gaspart.analysis.motion import line, mask_between
from gaspart.errors import SceneError
from gaspart.reproduction.families.displacement import measure as displacement
from gaspart.reproduction.families.shared import runs


@pytest.fixture
def stored(monkeypatch):
    """Stands in for the files: `stored[path] = dataset`."""
    files = {}
    monkeypatch.setattr(runs, "open_trajectory", files.__getitem__)
    return files


def fill(stored, one, seed, **unit):
    """Langevin particles with Enskog's D, sampled as the point says, in the place of its trajectories."""
    rng = np.random.default_rng(seed)
    for path in one.replica_paths:
        stored[path] = langevin(rng, one, **unit)


def test_correlations_are_the_averages_they_are_said_to_be():
    rng = np.random.default_rng(1)
    r, v = rng.normal(size=(30, 5, 3)).cumsum(axis=0), rng.normal(size=(30, 5, 3))
    found = correlate(r, v, 0.5, 9)
    assert found.time == pytest.approx(0.5 * np.arange(9))
    for lag in range(9):
        moved, late, early = r[lag:] - r[: 30 - lag], v[lag:], v[: 30 - lag]
        assert found.msd[lag] == pytest.approx((moved**2).sum(axis=-1).mean(), abs=1e-10)
        assert found.correlation[lag] == pytest.approx((late * early).sum(axis=-1).mean() / 3)
        assert found.running[lag] == pytest.approx(
            (moved * (late + early)).sum(axis=-1).mean() / 6, abs=1e-10
        )
    with pytest.raises(ValueError):
        correlate(r, v, 0.5, 31)


def test_free_flight_is_ballistic_at_any_distance():
    """Displacements 1e6 times the msd's root at the shortest lag lose no digit that matters."""
    v = np.random.default_rng(2).normal(size=(1, 50, 3))
    r = np.arange(1000.0)[:, None, None] * v
    found = correlate(r, np.repeat(v, 1000, axis=0), 1.0, 4)
    square = (v**2).sum() / 50
    assert found.msd[1:] == pytest.approx(square * np.arange(1, 4) ** 2, rel=1e-8)
    assert found.running == pytest.approx(square / 3 * np.arange(4), rel=1e-8, abs=1e-9)


def test_a_line_needs_four_points():
    x = np.arange(10.0)
    assert line(x, 3.0 * x + 1.0) == pytest.approx(3.0)
    assert np.isnan(line(x[:3], x[:3]))
    assert mask_between(x, 2.0, 4.0).sum() == 3


@pytest.mark.parametrize("unit", [{}, {"drift": 7.0}, {"length": 2.0, "speed": 3.0}], ids=str)
def test_diffusion_of_langevin_particles_in_any_unit(stored, unit):
    one = point(collisions_per_particle=240, samples=240, radius=0.5 * unit.get("length", 1.0))
    fill(stored, replace(one, settings={**one.settings, "radius": 0.5}), seed=4, **unit)
    ds = displacement.msd_spheres([one], {}).isel(point=0)
    expected, error = float(theory.enskog_diffusion(0.02, 3)), float(ds["diffusion_error"])
    assert error < 0.03 * expected
    assert abs(float(ds["diffusion"]) - expected) < 4 * error
    theoretical = theory.enskog_mean_squared_displacement(ds["time"].values, 0.02, 3)
    assert ds["msd"].values[1:] == pytest.approx(theoretical[1:], rel=0.06)
    assert ds["running"].values[-1] == pytest.approx(expected, rel=0.08)
    assert bool(ds["largest"]) and not bool(ds["in_series"])


def test_short_runs_compare_green_and_kubo_with_einstein(stored):
    one = point(experiment="short", collisions_per_particle=60, samples=240)
    fill(stored, one, seed=5)
    ds = displacement.msd_spheres([one], {}).isel(point=0)
    assert np.isnan(ds["diffusion"])
    assert float(ds["interval"]) == pytest.approx(0.25, rel=0.02)
    assert abs(float(ds["integral_difference"])) < max(4 * float(ds["integral_difference_error"]), 0.01)
    late = ds["time"] * ds["collision_rate"] > 12.0
    integral = ds["integral"].where(late).mean()
    assert float(integral) == pytest.approx(float(theory.enskog_diffusion(0.02, 3)), rel=0.1)


def test_sizes_at_one_packing_fraction_make_a_series(stored):
    chosen = [point(count=count, name=f"count={count}", packing_fraction=0.3) for count in (32, 48, 64)]
    chosen.append(point(count=32, packing_fraction=0.05))
    for seed, one in enumerate(chosen):
        fill(stored, one, seed=seed)
    ds = displacement.msd_spheres(chosen, {})
    assert ds["in_series"].values.tolist() == [True, True, True, False]
    assert ds["largest"].values.tolist() == [False, False, True, True]
    # Langevin particles do not feel each other: no slope, and Enskog's D in every container.
    assert abs(float(ds["size_slope"])) < 4 * float(ds["size_slope_error"])
    enskog = float(theory.enskog_diffusion(0.3, 3))
    assert abs(float(ds["size_intercept"]) - enskog) < 4 * float(ds["size_intercept_error"])
    side = ds["side"].values
    carried = float(theory.number_density(0.3, 3)) * float(ds["diffusion"][0])
    expected = theory.yeh_hummer(side[0], float(theory.enskog_viscosity(0.3, 3)) + carried)
    assert float(ds["correction"][0]) == pytest.approx(float(expected))


def test_the_slope_against_the_logarithm_is_found(monkeypatch):
    """D(t) = a + b ln t, less what zero total momentum takes away."""
    one = point(dimension=2, count=4096, packing_fraction=0.3)
    time = np.linspace(0.0, 60.0, 200)
    ramps = np.array([0.055, 0.06, 0.065])

    def ramp(*_):
        logarithm = np.log(np.maximum(time, 0.1))
        return [Curves(time, time, time, 0.4 + b * logarithm - time / 4096) for b in ramps]

    monkeypatch.setattr(displacement, "replicas", ramp)
    ds = displacement.msd_discs([one], {}).isel(point=0)
    assert float(ds["logarithmic_slope"]) == pytest.approx(0.06, rel=1e-9)
    assert float(ds["logarithmic_slope_error"]) == pytest.approx(0.005 / np.sqrt(3))
    assert "diffusion" not in ds
    assert float(ds["fit_from"] * ds["collision_rate"]) == pytest.approx(30.0)
    assert float(ds["slope_expected"]) == pytest.approx(float(theory.logarithmic_slope(0.3)), rel=0.4)
    assert float(ds["fit_to"]) == pytest.approx(float(ds["sound_time"]))


def test_a_point_without_lags_is_refused():
    one = point()
    del one.settings["lags"]
    with pytest.raises(SceneError, match="experiments.msd.lags.*is required"):
        displacement.msd_spheres([one], {})


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"displacements": False}, "displacements"),
        ({"replicas": 1}, "replicas"),
        ({"collisions_per_particle": 30, "samples": 30}, "collisions per particle"),
        ({"lags": 10}, "collisions per particle.*`lags` reach half of it"),
    ],
)
def test_runs_that_cannot_tell_are_refused(stored, change, key):
    one = point(**change)
    fill(stored, one, seed=6)
    with pytest.raises(SceneError, match=key):
        displacement.msd_spheres([one], {})


def test_a_real_gas_diffuses_as_enskog_says(tmp_path):
    one = replace(point(count=108, packing_fraction=0.03, equilibration=10, replicas=3), root=str(tmp_path))
    recipe = one.parameters
    given = {key: recipe[key] for key in ("duration", "sample_interval", "displacements")}
    given["correlations"] = gp.Correlations(**recipe["correlations"])
    for k, path in enumerate(one.replica_paths):
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        gp.run(one.scene, one.engine, one.seed(k), **given, path=path)
    ds = displacement.msd_spheres([one], {}).isel(point=0)
    assert float(ds["diffusion"]) == pytest.approx(float(theory.enskog_diffusion(0.03, 3)), rel=0.15)
    theoretical = theory.enskog_mean_squared_displacement(ds["time"].values, 0.03, 3)
    assert ds["msd"].values[1] == pytest.approx(theoretical[1], rel=0.03)
