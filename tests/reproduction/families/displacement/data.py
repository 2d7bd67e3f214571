"""Made-up trajectories and measurements of displacements, with known answers."""

import math

import numpy as np
import xarray as xr
from scenes import centred

from gaspart import theory
from gaspart.analysis.correlations import correlate
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import from_rows
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
