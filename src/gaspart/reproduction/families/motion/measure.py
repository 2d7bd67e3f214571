"""Measurements of displacement and velocity autocorrelation.

The first part measures the mean-squared displacement (msd), from ballistic to diffusive motion, and the
diffusion coefficient where it exists.

Units are reduced: the particles' diameter, mass and temperature are 1. The temperature is 2 E' / (d (N - 1)),
computed for each replica. Here E' is the energy in the frame of the centre of mass. The drift of the centre
of mass is removed from displacements and velocities. There is one species. Errors are standard errors of the
mean over replicas.

The second part measures the velocity autocorrelation: its exponential start, and its long-time tail, a power
of time.

Units are reduced as above. The time s is the number of collisions of a particle by Enskog theory. The total
momentum is subtracted; u are velocities relative to the centre of mass. If the momentum is free (canonical
ensemble), the constant velocity of the centre of mass is added:

    C(t) = 1/N + <u(0).u(t)> / (d k_B T),    k_B T = m <u^2> / d * N / (N-1) .

This is exact. C(t) of an infinite fluid differs from it after momentum has crossed the periodic container;
sound crosses it first. Therefore the tail is compared with the modes of the container
(`theory.velocity_autocorrelation_modes`). These decay with the transport coefficients of long waves. At a
time t, waves of length sqrt((D + nu) t) dominate. The next terms of their decay rates, of order k^4, are
smaller by a factor of order 1/t. Therefore the ratio to the modes is fitted by A + B/s, and A is compared
with 1.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from scipy.integrate import cumulative_simpson

from gaspart import theory
from gaspart.analysis.diffusion import LINEAR_FROM
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.motion import Curves, line, mask_between
from gaspart.analysis.statistics import fit_linear, fit_polynomial, mean_of, means_of
from gaspart.errors import SceneError
from gaspart.reproduction.families.shared.runs import reduced_curves
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, entries, table
from gaspart.scene.gas import plain_gas

SETTLE_SHEAR_TIMES = 3.0
"""Number of decay times of the container's slowest shear mode. D is the slope of the msd from a time t to 2t.
The time t is `LINEAR_FROM` collisions per particle, or this number of decay times, whichever is later."""
SHORT_INTERVAL = 0.5
"""Largest sampling interval, in collisions per particle, of a run for short times. Its velocity
autocorrelation is integrated by Simpson's rule, which is accurate to 1e-4 at this interval. No D is computed
from such a run."""
GREEN_KUBO_FROM, GREEN_KUBO_TO = 8.0, 16.0
"""Collisions per particle between which the integral of C is compared with the slope of the msd."""
LOGARITHM_FROM = 30.0
"""Collisions per particle after which hydrodynamic modes describe the velocity autocorrelation of discs."""
ABSENT = Estimate(math.nan, math.nan, math.nan)
"""Value of a number that a point does not measure."""
ABOUT = {"reduced_time": "diameter sqrt(mass / temperature)"}
UNITS = {
    "side": "diameter",
    "mean_free_path": "diameter",
    "msd": "diameter^2",
    **dict.fromkeys(("time", "fit_from", "fit_to", "shear_time", "sound_time"), "reduced time"),
    **dict.fromkeys(
        ("running", "integral", "diffusion", "correction", "correction_uncertainty", "logarithmic_slope"),
        "diameter^2 / reduced time",
    ),
    "collision_rate": "1 / reduced time",
    "interval": "collisions per particle",
}


def replicas(point: Point, longest: float) -> list[Curves]:
    """Return the curves of each replica, up to the lag `longest`, or to their last lag.

    `longest` is in reduced time. Raises SceneError for a point without displacements or lags, or with a
    single replica.
    """
    where = f"experiments.{point.experiment}"
    if not point.settings.get("displacements", False):
        raise SceneError(f"{where}.displacements", False, "must be true")
    if point.replicas < 2:
        raise SceneError(f"{where}.replicas", point.replicas, "must be at least 2")
    curves = [reduced_curves(point, path, longest) for path in point.replica_paths]
    # Temperatures of replicas differ slightly; so may the last lag.
    shortest = min(len(curve.time) for curve in curves)
    return [Curves(*(array[:shortest] for array in vars(curve).values())) for curve in curves]


def msd_spheres(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure mean-squared displacement and diffusion of spheres.

    The numbers of a point are defined in `spheres`. The dimensions are point and lag, with NaN beyond the
    last lag of a point. `largest` marks the long run with the most particles at its packing fraction.
    `in_series` marks runs of three or more sizes at one packing fraction. A line size_intercept + size_slope
    / L is fitted through these. A second line has the slope by Yeh and Hummer, and starts at `size_limit`.
    Raises SceneError for a run too short for the linear part of the msd.
    """
    dataset = table("point", points, spheres, inner=("lag",), units=UNITS).assign_attrs(dimension=3, **ABOUT)
    runs = Table(dataset, "point")
    eta, long = runs.packing_fraction.round(6), np.isfinite(runs.diffusion.value)
    same = long & long[:, None] & (eta == eta[:, None])
    most = np.where(same, runs.count, 0).max(axis=1) == runs.count
    runs = runs.assign(largest=long & most, in_series=long & (same.sum(axis=1) >= 3))
    return size_series(runs.dataset)


def size_series(dataset: xr.Dataset) -> xr.Dataset:
    """Add lines of D against 1/L through the points `in_series`, if there are any.

    See `msd_spheres`.
    """
    runs = Table(dataset, "point")
    sizes = runs[runs.in_series]
    if not sizes:
        return dataset
    inverse, predicted = 1.0 / sizes.side, -sizes.correction[0] * sizes.side[0]
    fit = fit_polynomial(inverse, sizes.diffusion)
    limit = fit_polynomial(inverse, sizes.diffusion, powers=(0,), fixed={1: predicted}).values[0]
    coefficients = {"size_intercept": fit.estimate(0), "size_slope": fit.estimate(1)}
    return dataset.assign(entries(coefficients) | {"size_limit": float(limit)})


def msd_discs(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the displacement of discs, and the growth of its slope with ln t.

    See `_discs`.
    """
    return table("point", points, _discs, inner=("lag",), units=UNITS).assign_attrs(dimension=2, **ABOUT)


def _state(point: Point) -> dict[str, Any]:
    """Return predictions for a scene, such as collision rate and decay time of shear modes."""
    gas, lengths = plain_gas(point.scene), point.scene.container.lengths
    eta, dimension = gas.packing_fraction, gas.dimension
    density = theory.number_density(eta, dimension)
    viscosity = float(theory.enskog_viscosity(eta, dimension))
    if dimension == 3:
        viscosity *= float(theory.viscosity_ratio(eta))
    side = lengths[0] / gas.diameter
    spreading = float(theory.enskog_diffusion(eta, dimension)) + viscosity / density
    return {
        "count": gas.count,
        "packing_fraction": eta,
        "side": side,
        "collision_rate": float(theory.collision_rate(eta, dimension)),
        "mean_free_path": float(theory.mean_free_path(eta, dimension)),
        "viscosity": viscosity,
        "shear_time": (side / (2.0 * math.pi)) ** 2 / spreading,
        "sound_time": side / float(theory.speed_of_sound(eta, dimension)),
    }


def _common(point: Point, state: dict, curves: list[Curves]) -> dict[str, Any]:
    """Return the columns of every point: state, sampling in collisions per particle, curves."""
    time = np.mean([curve.time for curve in curves], axis=0)
    rate = state["collision_rate"]
    row = state | {
        "experiment": point.experiment,
        "replicas": len(curves),
        "interval": time[1] * rate,
        "time": time,
        "msd": _mean([curve.msd for curve in curves]),
        "running": _mean([curve.running for curve in curves]),
    }
    if row["interval"] <= SHORT_INTERVAL:
        return row | _green_kubo(curves, rate, point.settings["dimension"])
    no_curve = Estimate(np.full(time.size, math.nan), math.nan, math.nan)
    return row | {"integral_difference": ABSENT, "correlation": no_curve, "integral": no_curve}


def spheres(point: Point) -> dict[str, Any]:
    """Measure D, D of the infinite system, and the curves of spheres.

    If the total momentum of N particles is zero, D is smaller by the factor (N - 1) / N. This is exact for a
    dilute gas, in which each other particle carries -1 / (N - 1) of a particle's momentum. Therefore all
    curves are multiplied by N / (N - 1). The remaining effect of the finite size is hydrodynamic. It is
    corrected by Yeh and Hummer, with the measured viscosity (`theory.viscosity_ratio`) plus rho D. The term
    rho D is added because a particle also leaves a vortex by its own diffusion. Each mode decays with nu + D,
    as in the long-time tail (Ernst, Hauge and van Leeuwen 1970). In a dilute gas this halves the correction.
    The uncertainty of the correction has two parts: the uncertainty of the viscosity, and a relative part (2
    pi mean free path / side)^2, at most 1. The latter is the next order of hydrodynamics in the slowest mode.
    """
    state = _state(point)
    start = max(LINEAR_FROM / state["collision_rate"], SETTLE_SHEAR_TIMES * state["shear_time"])
    factor = state["count"] / (state["count"] - 1.0)
    curves = [
        Curves(curve.time, factor * curve.msd, factor * curve.correlation, factor * curve.running)
        for curve in replicas(point, 2.0 * start)
    ]
    row = _common(point, state, curves)
    if row["interval"] <= SHORT_INTERVAL:
        return row | {"diffusion": ABSENT}
    time = row["time"]
    if time[-1] + time[1] < 2.0 * start:
        where = f"experiments.{point.experiment}[{point.name}]: collisions per particle"
        collisions = math.ceil(4.0 * start * state["collision_rate"])
        rule = f"must be {collisions} or more, and `lags` reach half of it, for a straight stretch of the msd"
        raise SceneError(where, round(point.schedule.samples * row["interval"]), rule)
    slopes = []
    for curve in curves:
        inside = mask_between(curve.time, start, 2.0 * start)
        slopes.append(line(curve.time[inside], curve.msd[inside]) / 6.0)
    diffusion = _mean(slopes)
    carried = float(theory.number_density(state["packing_fraction"], 3)) * diffusion.value
    correction = float(theory.yeh_hummer(state["side"], state["viscosity"] + carried))
    rough = theory.VISCOSITY_RATIO_UNCERTAINTY
    next_order = (2.0 * math.pi * state["mean_free_path"] / state["side"]) ** 2
    return row | {
        "diffusion": diffusion,
        "correction": correction,
        "correction_uncertainty": correction * min(1.0, math.hypot(rough, next_order)),
        "fit_from": start,
        "fit_to": 2.0 * start,
    }


def _discs(point: Point) -> dict[str, Any]:
    """Measure D(t) of discs, its slope against ln t, and the curves.

    D(t) is the derivative of the msd divided by 2d. `slope_expected` is the slope for the hydrodynamic modes
    of the container, fitted in the same way.

    Until sound has crossed the container, a particle is not affected by the container's size. It is affected
    at once by the condition of zero total momentum: without this condition all particles would share a
    velocity of mean square d / N. Therefore 1 / N is added to the correlation, t / N to D(t), and d t^2 / N
    to the msd. This is exact until sound has crossed; the curves end there.
    """
    state = _state(point)
    start = LOGARITHM_FROM / state["collision_rate"]
    stop = max(state["sound_time"], 2.0 * start)
    share = 1.0 / state["count"]
    curves = [
        Curves(
            curve.time,
            curve.msd + 2.0 * share * curve.time**2,
            curve.correlation + share,
            curve.running + share * curve.time,
        )
        for curve in replicas(point, stop)
    ]
    row = _common(point, state, curves)
    if row["interval"] <= SHORT_INTERVAL:
        return row | {"logarithmic_slope": ABSENT, "slope_expected": math.nan}
    slopes = []
    for curve in curves:
        inside = mask_between(curve.time, start, stop)
        slopes.append(line(np.log(curve.time[inside]), curve.running[inside]))
    time = row["time"][mask_between(row["time"], start, stop)]
    running = theory.diffusion_modes(time, state["packing_fraction"], 2, state["count"])
    expected = line(np.log(time), running)
    fit = {"slope_expected": expected, "fit_from": start, "fit_to": stop}
    return row | {"logarithmic_slope": _mean(slopes)} | fit


def _green_kubo(curves: list[Curves], rate: float, dimension: int) -> dict[str, Estimate]:
    """Compare the integral of the velocity autocorrelation with the slope of the msd.

    `integral_difference` is (slope of the twice integrated correlation) / (slope of the msd over 2d) - 1.
    Both slopes are from linear fits between GREEN_KUBO_FROM and GREEN_KUBO_TO collisions per particle. The
    first uses only velocities, the second only displacements.
    """
    integrals = [cumulative_simpson(curve.correlation, x=curve.time, initial=0.0) for curve in curves]
    differences = []
    for curve, integral in zip(curves, integrals, strict=True):
        inside = mask_between(curve.time * rate, GREEN_KUBO_FROM, GREEN_KUBO_TO)
        twice = cumulative_simpson(integral, x=curve.time, initial=0.0)
        einstein = line(curve.time[inside], curve.msd[inside]) / (2.0 * dimension)
        differences.append(line(curve.time[inside], twice[inside]) / einstein - 1.0)
    return {
        "correlation": _mean([curve.correlation for curve in curves]),
        "integral": _mean(integrals),
        "integral_difference": _mean(differences),
    }


def _mean(samples: Sequence[Any]) -> Estimate:
    """Compute the mean over replicas."""
    return Estimate(*means_of(samples), len(samples) - 1)


def velocity_autocorrelation(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure C(t) of every point, its initial decay rate, and the amplitude of its tail.

    The setting `start_to` is a number of collisions of a particle. Up to it, -ln C is fitted by a line and a
    parabola, if the sampling is fine enough. The setting `tail` is the interval for fits of the tail, for all
    other points.

    collisions, time, correlation : s; time; C with its error (`point`, `lag`); NaN beyond the last lag
    dimension, packing_fraction, count : properties of the gas, over `point`
    sound : s at which sound has crossed the container
    start_rate : initial decay rate divided by the collision rate, with error
    tail_from, tail_to : interval of the fit of the tail
    tail_ratio, tail_correction : A and B of the fit, with the error of A

    The quantity that is fitted is C - 1/N, divided by the sum of the container's modes. Variables are NaN
    where a point does not have them.
    """
    return table("point", points, _row, settings, inner=("lag",), units={"time": "sigma sqrt(m / k_B T)"})


def _row(point: Point, settings: dict) -> dict:
    scene = point.scene
    dimension, count, eta = scene.dimension, scene.count, scene.packing_fraction
    rate = float(theory.collision_rate(eta, dimension))
    rate *= float(theory.collision_rate_finite_size_factor(eta, dimension, count))
    side = min(scene.container.lengths) / (2.0 * scene.largest_radius)
    start, stop = settings["tail"]
    runs = [reduced_curves(point, path, stop / rate) for path in point.replica_paths]
    shortest = min(len(run.time) for run in runs)
    time = np.mean([run.time[:shortest] for run in runs], axis=0)
    samples = np.stack([run.correlation[:shortest] for run in runs]) + 1.0 / count
    collisions = time * rate
    row = {
        "dimension": dimension,
        "packing_fraction": eta,
        "count": count,
        "sound": side / float(theory.speed_of_sound(eta, dimension)) * rate,
        "collisions": collisions,
        "time": time,
        "correlation": means_of(samples),
        **dict.fromkeys(("start_rate", "tail_ratio"), Estimate(math.nan, math.nan, len(samples) - 1)),
        **dict.fromkeys(("tail_from", "tail_to", "tail_correction"), math.nan),
    }
    early, late = (
        mask_between(collisions, collisions[1], settings["start_to"]),
        mask_between(collisions, start, stop),
    )
    if early.sum() >= 4:
        row["start_rate"] = mean_of([_initial_rate(collisions[early], values[early]) for values in samples])
    elif late.sum() >= 4:  # finely sampled runs are too short for the tail
        share = 1.0 / count  # exactly known, and not part of the tail
        modes = theory.velocity_autocorrelation_modes(time[late], eta, dimension, count) - share
        fits = np.array([_tail(collisions[late], values[late] - share, modes) for values in samples])
        row |= {"tail_from": start, "tail_to": stop, "tail_ratio": mean_of(fits[:, 0])}
        row["tail_correction"] = fits[:, 1].mean()
    return row


def _tail(collisions: np.ndarray, values: np.ndarray, modes: np.ndarray) -> np.ndarray:
    """Fit A and B of values = modes (A + B / s).

    The noise of C is the same at all lags.
    """
    return fit_linear(np.stack([modes, modes / collisions], axis=1), values).values


def _initial_rate(collisions: np.ndarray, values: np.ndarray) -> float:
    """Compute -d ln C / ds at s = 0, from a parabola through the origin."""
    return float(fit_polynomial(collisions, -np.log(values), powers=(1, 2)).values[0])
