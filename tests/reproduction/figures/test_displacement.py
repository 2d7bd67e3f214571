"""Displacements and velocity autocorrelations of made-up trajectories."""

import math
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from scenes import centred

from gaspart import theory
from gaspart.analysis.motion import Curves, correlate
from gaspart.errors import SceneError
from gaspart.reproduction.figures import _displacement, msd_discs, msd_spheres, velocity_autocorrelation
from gaspart.reproduction.points.point import Point
from gaspart.trajectory.correlator import SUMS


def point(**more):
    """One point of a grid at temperature 1; nothing of it is run."""
    settings = {
        "dimension": 3, "count": 100, "radius": 0.5, "packing_fraction": 0.02, "boundary": "periodic",
        "arrangement": "lattice", "temperature": 1.0, "engine": "event", "collisions_per_particle": 120,
        "samples": 120, "displacements": True, "lags": 120, "replicas": 4,
    }  # fmt: skip
    return Point("msd", "single", "simulate", settings | more, "results/points", 1)


def langevin(rng, one, drift=0.0, length=1.0, speed=1.0):
    """What a run of `one` accumulates of 100 independent particles with <v(0).v(t)> / d = exp(-rate t), at
    Enskog's D: exact steps of the Ornstein-Uhlenbeck process.

    Their D is speed^2 / rate. drift: a velocity that all share; length: unit of the displacements.
    """
    frames, interval = one.schedule.samples + 1, one.schedule.sample_interval
    rate = 1.0 / float(theory.enskog_diffusion(0.02, 3))
    decay = math.exp(-rate * interval)
    place_variance = (2.0 * rate * interval - 3.0 + 4.0 * decay - decay**2) / rate**2
    covariance = (1.0 - decay) ** 2 / rate
    noise = np.linalg.cholesky([[1.0 - decay**2, covariance], [covariance, place_variance]])
    place, velocity = np.zeros((100, 3)), rng.standard_normal((100, 3))
    places, velocities = [], []
    for _ in range(frames):
        places.append(place)
        velocities.append(velocity)
        kicks = np.einsum("ij,jnd->ind", noise, rng.standard_normal((2, 100, 3)))
        place = place + velocity * (1.0 - decay) / rate + kicks[1]
        velocity = velocity * decay + kicks[0]
    shared = drift * interval * np.arange(frames)[:, None, None]
    moved, velocities = length * (np.array(places) + shared), speed * (np.array(velocities) + drift)
    lags = one.parameters["correlations"]["lags"] + 1
    curves = correlate(centred(moved), centred(velocities), interval * length / speed, lags)
    pairs = frames - np.arange(lags)
    sums = (3 * curves.correlation, curves.msd, 6 * curves.running)
    return xr.Dataset(
        {name: (("frame", "lag"), (values * pairs)[None]) for name, values in zip(SUMS, sums, strict=True)}
        | {"correlated_samples": ("frame", [float(frames)])},
        coords={"lag": curves.time, "spatial": list("xyz")},
    )


@pytest.fixture
def stored(monkeypatch):
    """Puts Langevin particles, sampled as a point says, in the place of its trajectories."""
    files = {}
    monkeypatch.setattr(_displacement, "open_trajectory", files.__getitem__)

    def fill(one, seed, **unit):
        rng = np.random.default_rng(seed)
        files.update({path: langevin(rng, one, **unit) for path in one.replica_paths})

    return fill


@pytest.mark.parametrize("unit", [{}, {"drift": 7.0}, {"length": 2.0, "speed": 3.0}], ids=str)
def test_diffusion_of_langevin_particles_in_any_unit(stored, unit):
    one = point(collisions_per_particle=240, samples=240, radius=0.5 * unit.get("length", 1.0))
    stored(replace(one, settings={**one.settings, "radius": 0.5}), seed=4, **unit)
    ds = msd_spheres.measure([one], {}).isel(point=0)
    expected, error = float(theory.enskog_diffusion(0.02, 3)), float(ds["diffusion_error"])
    assert error < 0.03 * expected
    assert abs(float(ds["diffusion"]) - expected) < 4 * error
    theoretical = theory.enskog_mean_squared_displacement(ds["time"].values, 0.02, 3)
    assert ds["msd"].values[1:] == pytest.approx(theoretical[1:], rel=0.06)
    assert ds["running"].values[-1] == pytest.approx(expected, rel=0.08)
    assert bool(ds["largest"]) and not bool(ds["in_series"])


def test_the_slope_against_the_logarithm_is_found(monkeypatch):
    """D(t) = a + b ln t, less what zero total momentum takes away."""
    one = point(dimension=2, count=4096, packing_fraction=0.3)
    time = np.linspace(0.0, 60.0, 200)
    ramps = np.array([0.055, 0.06, 0.065])

    def ramp(*_):
        logarithm = np.log(np.maximum(time, 0.1))
        return [Curves(time, time, time, 0.4 + b * logarithm - time / 4096) for b in ramps]

    monkeypatch.setattr(_displacement, "replicas", ramp)
    ds = msd_discs.measure([one], {}).isel(point=0)
    assert float(ds["logarithmic_slope"]) == pytest.approx(0.06, rel=1e-9)
    assert float(ds["logarithmic_slope_error"]) == pytest.approx(0.005 / np.sqrt(3))
    assert "diffusion" not in ds
    assert float(ds["fit_from"] * ds["collision_rate"]) == pytest.approx(30.0)
    assert float(ds["slope_expected"]) == pytest.approx(float(theory.logarithmic_slope(0.3)), rel=0.4)
    assert float(ds["fit_to"]) == pytest.approx(float(ds["sound_time"]))


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
    stored(one, seed=6)
    with pytest.raises(SceneError, match=key):
        msd_spheres.measure([one], {})


def test_the_initial_rate_and_the_tail_are_fitted():
    s = np.linspace(0.05, 0.3, 6)
    found = velocity_autocorrelation.initial_rate(s, np.exp(-0.7 * s + 0.1 * s**2))
    assert found == pytest.approx(0.7, rel=1e-10)
    s = np.linspace(16.0, 60.0, 45)
    modes = s**-1.5
    fitted = velocity_autocorrelation.fit_tail(s, modes * (1.1 + 5.0 / s), modes)
    np.testing.assert_allclose(fitted, [1.1, 5.0], rtol=1e-9)
