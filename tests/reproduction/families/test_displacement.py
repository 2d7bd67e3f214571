"""Made-up trajectories and measurements of displacements, with known answers."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from reproduction.claims.data import about, judged
from reproduction.families.drawn import Points, column, draw, shows, varied
from scenes import centred

import gaspart as gp
from gaspart import theory
from gaspart.analysis.motion import Curves, correlate, line, mask_between
from gaspart.errors import SceneError
from gaspart.reproduction.families.motion import claims, figure, measure
from gaspart.reproduction.families.shared import runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, from_rows
from gaspart.trajectory.correlator import SUMS


def point(dimension=3, count=100, packing_fraction=0.02, experiment="msd", name="single", **more):
    """One point of a grid at temperature 1; nothing of it is run."""
    settings = {
        "dimension": dimension,
        "count": count,
        "radius": 0.5,
        "packing_fraction": packing_fraction,
        "boundary": "periodic",
        "arrangement": "lattice",
        "temperature": 1.0,
        "engine": "event",
        "collisions_per_particle": 120,
        "samples": 120,
        "displacements": True,
        "lags": 120,
        "replicas": 4,
    }
    return Point(experiment, name, "simulate", settings | more, "results/points", 1)


def langevin(rng, one, drift=0.0, length=1.0, speed=1.0):
    """What a run of `one` accumulates of independent particles with <v(0).v(t)> / d = exp(-rate t), at
    Enskog's D: exact steps of the Ornstein-Uhlenbeck process.

    Their D is speed^2 / rate. drift: a velocity that all share; length: unit of the displacements.
    """
    times, asked = one.schedule, one.parameters["correlations"]
    frames, interval = times.samples + 1, times.sample_interval
    count, dimension = one.settings["count"], one.settings["dimension"]
    rate = enskog_rate(one.settings["packing_fraction"], dimension)
    decay = math.exp(-rate * interval)
    velocity_variance = 1.0 - decay**2
    place_variance = (2.0 * rate * interval - 3.0 + 4.0 * decay - decay**2) / rate**2
    covariance = (1.0 - decay) ** 2 / rate
    noise = np.linalg.cholesky([[velocity_variance, covariance], [covariance, place_variance]])
    place = np.zeros((count, dimension))
    velocity = rng.standard_normal((count, dimension))
    places, velocities = [], []
    for _ in range(frames):
        places.append(place)
        velocities.append(velocity)
        kicks = np.einsum("ij,jnd->ind", noise, rng.standard_normal((2, count, dimension)))
        place = place + velocity * (1.0 - decay) / rate + kicks[1]
        velocity = velocity * decay + kicks[0]
    shared = drift * interval * np.arange(frames)[:, None, None]
    moved, velocities = length * (np.array(places) + shared), speed * (np.array(velocities) + drift)
    lags = asked["lags"] + 1
    curves = correlate(centred(moved), centred(velocities), interval * length / speed, lags)
    pairs = frames - np.arange(lags)
    sums = (dimension * curves.correlation, curves.msd, 2 * dimension * curves.running)
    return xr.Dataset(
        {name: (("frame", "lag"), (values * pairs)[None]) for name, values in zip(SUMS, sums, strict=True)}
        | {"correlated_samples": ("frame", [float(frames)])},
        coords={"lag": curves.time, "spatial": list("xyz"[:dimension])},
    )


def enskog_rate(packing_fraction, dimension=3):
    """Decay rate of the velocity in a Langevin gas with Enskog's D."""
    return 1.0 / float(theory.enskog_diffusion(packing_fraction, dimension))


def _curves(eta, dimension, interval, lags):
    """Columns of a point's curves by Enskog's theory."""
    rate = float(theory.collision_rate(eta, dimension))
    time = interval / rate * np.arange(lags)
    diffusion = float(theory.enskog_diffusion(eta, dimension))
    running = -diffusion * np.expm1(-time / diffusion)
    return {
        "packing_fraction": eta,
        "collision_rate": rate,
        "interval": interval,
        "viscosity": float(theory.enskog_viscosity(eta, dimension)),
        "time": time,
        "msd": theory.enskog_mean_squared_displacement(time, eta, dimension),
        "msd_error": 4e-4 * theory.enskog_mean_squared_displacement(time, eta, dimension),
        "running": running,
        "running_error": np.full(lags, 1e-4),
    }


def _table(rows, dimension, **more):
    return from_rows("point", rows, ("lag",)).assign(more).assign_attrs(dimension=dimension)


def _short(eta, dimension, **more):
    curves = _curves(eta, dimension, 0.25, 100)
    integral = {"integral": curves["running"], "integral_error": np.full(100, 1e-4)}
    difference = {"integral_difference": 0.001, "integral_difference_error": 0.002}
    return {**curves, **integral, **difference, **more}


def spheres():
    """What `measure.msd_spheres` gives where Erpenbeck & Wood and Yeh & Hummer hold."""
    rows = []
    for eta, count in ((0.01, 864), (0.1, 864), (0.3, 256), (0.3, 864), (0.3, 2048)):
        side = (count / float(theory.number_density(eta, 3))) ** (1 / 3)
        correction = float(theory.yeh_hummer(side, float(theory.enskog_viscosity(eta, 3))))
        diffusion = float(theory.erpenbeck_wood_diffusion(eta))
        rows.append(
            {
                **_curves(eta, 3, 2.0, 40),
                "count": count,
                "side": side,
                "diffusion": diffusion - correction,
                "diffusion_error": 0.002 * diffusion,
                "correction": correction,
                "correction_uncertainty": 0.05 * correction,
                "largest": (eta, count) != (0.3, 256) and (eta, count) != (0.3, 864),
                "in_series": eta == 0.3,
            }
        )
    slope = -rows[-1]["correction"] * rows[-1]["side"]
    rows.append(_short(0.3, 3, count=864, side=1.0, largest=False, in_series=False))
    intercept = float(theory.erpenbeck_wood_diffusion(0.3))
    fitted = {
        "size_slope": slope,
        "size_slope_error": 0.02,
        "size_intercept": intercept,
        "size_limit": intercept,
    }
    return _table(rows, 3, **fitted, size_intercept_error=0.001)


def discs():
    """What `measure.msd_discs` gives where mode coupling holds."""
    rows = []
    for eta in (0.1, 0.3):
        expected = float(theory.logarithmic_slope(eta))
        curves = _curves(eta, 2, 3.0, 30)
        late = curves["time"] > curves["time"][5]
        curves["running"][late] += expected * np.log(curves["time"][late] / curves["time"][5])
        fit = {"fit_from": curves["time"][5], "fit_to": curves["time"][25]}
        slope = {"logarithmic_slope": expected, "logarithmic_slope_error": 0.05 * expected}
        slope["slope_expected"] = expected
        rows.append({**curves, **fit, **slope, "count": 4096, "side": 100.0})
    rows.append(_short(0.3, 2, count=1024, side=50.0))
    return _table(rows, 2)


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
    ds = measure.msd_spheres([one], {}).isel(point=0)
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
    ds = measure.msd_spheres([one], {}).isel(point=0)
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
    ds = measure.msd_spheres(chosen, {})
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

    monkeypatch.setattr(measure, "replicas", ramp)
    ds = measure.msd_discs([one], {}).isel(point=0)
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
        measure.msd_spheres([one], {})


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
        measure.msd_spheres([one], {})


def test_a_real_gas_diffuses_as_enskog_says(tmp_path):
    one = replace(point(count=108, packing_fraction=0.03, equilibration=10, replicas=3), root=str(tmp_path))
    recipe = one.parameters
    given = {key: recipe[key] for key in ("duration", "sample_interval", "displacements")}
    given["correlations"] = gp.Correlations(**recipe["correlations"])
    for k, path in enumerate(one.replica_paths):
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        gp.run(one.scene, one.engine, one.seed(k), **given, path=path)
    ds = measure.msd_spheres([one], {}).isel(point=0)
    assert float(ds["diffusion"]) == pytest.approx(float(theory.enskog_diffusion(0.03, 3)), rel=0.15)
    theoretical = theory.enskog_mean_squared_displacement(ds["time"].values, 0.03, 3)
    assert ds["msd"].values[1] == pytest.approx(theoretical[1], rel=0.03)


def test_spheres_as_theory_says_agree():
    found = judged(claims.msd_spheres(spheres()))
    assert len(found) == 6
    assert sum("Erpenbeck and Wood" in text for text in found) == 2
    assert set(found.values()) == {"agrees"}


def test_discs_as_mode_coupling_says_agree():
    found = judged(claims.msd_discs(discs()))
    assert len(found) == 4
    assert set(found.values()) == {"agrees"}


def scaled(ds, name, factor, where):
    """A copy in which a column is multiplied at some points."""
    column = ds[name].values.copy()
    column[where] *= factor
    return ds.assign({name: (ds[name].dims, column)})


@pytest.mark.parametrize(
    ("name", "factor", "where", "text"),
    [
        ("diffusion", 0.97, [0], "dilute limit"),
        ("msd", 1.02, [5], "msd over Enskog's"),
    ],
)
def test_each_claim_about_spheres_can_fail(name, factor, where, text):
    assert about(claims.msd_spheres(scaled(spheres(), name, factor, where)), text) == {"disagrees"}


def test_a_limit_that_does_not_exclude_the_first_approximation_is_inconclusive():
    ds = spheres()
    ds["diffusion_error"] = 6.0 * ds["diffusion_error"]
    assert about(claims.msd_spheres(ds), "dilute") == {"inconclusive"}


def test_no_size_dependence_disagrees_and_a_noisy_one_is_inconclusive():
    text = "slope of D against 1/L at packing fraction 0.3"
    ds = spheres()
    assert judged(claims.msd_spheres(ds.assign(size_slope=0.0)))[text] == "disagrees"
    assert judged(claims.msd_spheres(ds.assign(size_slope_error=0.1)))[text] == "inconclusive"


def test_without_dilute_points_the_limit_is_inconclusive():
    ds = spheres().isel(point=slice(1, None))
    assert about(claims.msd_spheres(ds), "dilute") == {"inconclusive"}


def test_a_plateau_of_discs_disagrees_and_a_noisy_slope_is_inconclusive():
    flat = scaled(discs(), "logarithmic_slope", 0.0, [0, 1])
    assert about(claims.msd_discs(flat), "ln t") == {"disagrees"}
    noisy = scaled(discs(), "logarithmic_slope_error", 10.0, [0, 1])
    assert about(claims.msd_discs(noisy), "ln t") == {"inconclusive"}


def test_velocities_that_are_not_the_displacements_disagree():
    ds = discs()
    assert about(claims.msd_discs(scaled(ds, "integral_difference", 30.0, [2])), "Green-Kubo") == {
        "disagrees"
    }


KEPT = ("packing_fraction", "time", "interval")


def running(row, eta, dimension):
    """D(t) of a row over Enskog's, against collisions per particle."""
    enskog = float(theory.enskog_diffusion(eta, dimension))
    time = float(theory.collision_rate(eta, dimension)) * row["time"]
    return Points(time, row["running"] / enskog, row["running_error"] / enskog, some=True)


def test_spheres():
    ds = varied(spheres(), *KEPT)
    msd, slope, density, size = draw(figure.msd_spheres, ds).axes
    long, fine = ds.isel(point=4), ds.isel(point=5)
    shows(msd, column(fine, "time", "msd", some=True), column(long, "time", "msd", some=True))
    shows(slope, running(fine, 0.3, 3), running(long, 0.3, 3))
    row = ds.isel(point=[0, 1, 4])
    enskog = theory.enskog_diffusion(row["packing_fraction"].values, 3)
    both = np.hypot(row["diffusion_error"], row["correction_uncertainty"])
    shows(
        density,
        Points(row["packing_fraction"], row["diffusion"] / enskog, row["diffusion_error"] / enskog),
        Points(row["packing_fraction"], (row["diffusion"] + row["correction"]) / enskog, both / enskog),
    )
    row = ds.isel(point=[2, 3, 4])
    known = float(theory.erpenbeck_wood_diffusion(0.3))
    shows(
        size,
        Points([0.0], [known], [theory.ERPENBECK_WOOD_UNCERTAINTY * known]),
        Points(1.0 / row["side"], row["diffusion"], row["diffusion_error"]),
    )
    ds["in_series"] = ("point", np.zeros(ds.sizes["point"], dtype=bool))
    assert not draw(figure.msd_spheres, ds).axes[3].axison  # no series of sizes


def test_discs():
    ds = varied(discs(), *KEPT)
    msd, slope, logarithm = draw(figure.msd_discs, ds).axes
    dilute, long, fine = (ds.isel(point=k) for k in range(3))
    shows(msd, column(fine, "time", "msd", some=True), column(long, "time", "msd", some=True))
    shows(slope, running(dilute, 0.1, 2), running(fine, 0.3, 2), running(long, 0.3, 2))
    shows(logarithm, column(ds.isel(point=[0, 1]), "packing_fraction", "logarithmic_slope"))


@pytest.mark.parametrize("data", [discs, spheres])
def test_no_lag_is_drawn_twice(data):
    pieces = list(figure._pieces(Table(data(), "point"), 0.3))
    drawn = [time for run, lags in pieces for time in run.time[lags]]
    assert len(pieces) >= 2 and np.all(np.diff(drawn) > 0.0)
