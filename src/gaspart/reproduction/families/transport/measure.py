"""Viscosity and thermal conductivity from equilibrium, by Green and Kubo and by Helfand.

A point is a gas whose runs accumulated correlations of the stress tensor and the heat flux. Coefficients are
divided by Enskog's values. Times are in collisions of a particle.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import mean_of, means_of
from gaspart.analysis.transport import green_kubo, helfand
from gaspart.errors import SceneError
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table
from gaspart.scene.gas import plain_gas
from gaspart.trajectory.reading import open_trajectory

QUANTITIES = {"shear": "viscosity", "heat": "conductivity"}
"""Transport coefficient that follows from the correlation of each flux."""
ENSKOG = {"viscosity": theory.enskog_viscosity, "conductivity": theory.enskog_conductivity}
LONGER = 2.0
"""Minimum wavelength in mean free paths. If only longer waves count, the growth of the modes changes by the
uncertainty of theory."""
LATE = 0.5
"""Fraction of the longest lag after which the squared change of Helfand's sum is assumed to grow linearly."""


UNITS = {"time": "collisions per particle"}


def viscosity(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the shear viscosity, see `coefficient`, and `bulk`, the bulk viscosity.

    The bulk viscosity is divided by Enskog's, and computed by Green and Kubo.
    """
    return table("point", points, _viscosities, inner=("lag",), units=UNITS)


def conductivity(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the thermal conductivity; see `coefficient`."""
    of = "heat", theory.enskog_conductivity
    return table("point", points, coefficient, *of, inner=("lag",), units=UNITS)


def _viscosities(point: Point) -> dict[str, Any]:
    return coefficient(point, "shear", theory.enskog_viscosity) | {"bulk": _bulk(point)}


def _bulk(point: Point) -> Estimate:
    """Measure the bulk viscosity over Enskog's, up to the fraction `LATE` of the longest lag.

    The mean pressure is computed for each run, of duration T. This reduces the value by the fraction 2 lag /
    T.
    """
    gas, samples = plain_gas(point.scene), []
    for path in point.replica_paths:
        with open_trajectory(path) as trajectory:
            run = Run(point.scene, trajectory["time"].values, trajectory)
            lags = trajectory["lag"].values
            last = _half(lags)
            short = 2.0 * lags[last] / (run.time[-1] - run.time[0])
            samples += list(green_kubo(run, "bulk")[:, last] / (1.0 - short))
    return mean_of(samples) / float(theory.enskog_bulk_viscosity(**gas.parameters))


def coefficient(point: Point, flux: str, enskog: Callable[..., Any]) -> dict[str, Any]:
    """Measure a transport coefficient of a point, divided by Enskog's, from a flux.

    The fluxes are named in `trajectory.correlator.STRESS`. All numbers are estimates.

    value : integral of the correlation up to the longest lag
    growth : half of the slope of Helfand's squared change, between lags `LATE` and 1 of the longest
    difference : growth divided by the mean of the integral between these lags, minus 1, from the same runs
    running : integral up to each lag, (lag,)
    time, end : time of each lag, and end of the integral
    dimension, packing_fraction, count : properties of the gas
    finite : coefficient of a dilute gas of `count` particles, divided by the coefficient of an infinite gas
    """
    gas = plain_gas(point.scene)
    exact, rate = float(enskog(**gas.parameters)), float(theory.collision_rate(**gas.parameters))
    curves, growths = [], []
    for path in point.replica_paths:
        with open_trajectory(path) as trajectory:
            run = Run(point.scene, trajectory["time"].values, trajectory)
            lags = trajectory["lag"].values
            curves += list(green_kubo(run, flux) / exact)
            growths += [_growth(lags, curve) for curve in helfand(run, flux) / exact]
    samples, freedom = np.array(curves), len(curves) - 1
    value, growth = samples[:, -1], np.array(growths)
    # equals the growth exactly, except for pairs at the ends
    meanwhile = samples[:, _half(lags) : -1].mean(axis=1)
    return {
        "dimension": gas.dimension,
        "packing_fraction": gas.packing_fraction,
        "count": gas.count,
        "finite": theory.transport_finite_size_factor(gas.count, gas.dimension, QUANTITIES[flux]),
        "value": Estimate(*means_of(value), freedom),
        "growth": Estimate(*means_of(growth), freedom),
        "difference": Estimate(*means_of((growth - meanwhile) / meanwhile.mean()), freedom),
        "time": rate * end(lags),
        "running": means_of(samples),
    }


def end(lags: np.ndarray) -> np.ndarray:
    """Compute the time up to which the integral at each lag extends.

    This time is half an interval after the lag, because fluxes are averages over intervals. The time is
    computed as the mean of the lag and the next lag.
    """
    return lags + 0.5 * (lags[1] - lags[0])


def _half(lags: np.ndarray) -> int:
    """Return the lag from which on the growth is measured."""
    return round(LATE * (len(lags) - 1))


def _growth(lags: np.ndarray, slopes: np.ndarray) -> float:
    """Compute half of the slope of the squared change between two lags.

    `slopes` are half of the squared change divided by each lag.
    """
    first = _half(lags)
    change = slopes * lags
    return float((change[-1] - change[first]) / (lags[-1] - lags[first]))


def logarithmic_growth(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the growth of the integrals of discs with time, and of hydrodynamic modes.

    The settings `viscosity_from` and `conductivity_from` are numbers of collisions of a particle after which
    both are compared. Over `point`: count, packing_fraction, and sound, the number of collisions until sound
    has crossed the container. With the further dimension `lag`: time, in collisions.

    The following variables begin with "viscosity" or "conductivity", and are divided by Enskog's values. The
    variable without a suffix is the integral up to each time, (lag,), with `_error`. `_modes`: the modes of
    the container, (lag,), shifted to the height of the integral at the start of the comparison; NaN before.
    `_growth`: the growth of the integral up to the last time, divided by the growth of the modes, with
    `_error` and `_freedom`. `_short_waves`: the fraction of this growth due to waves of one to two mean free
    paths.

    Raises SceneError for spheres, and for discs whose diameter or temperature is not 1.
    """
    starts = {"viscosity": settings["viscosity_from"], "conductivity": settings["conductivity_from"]}
    return table("point", points, _growing, starts, inner=("lag",), units=UNITS)


def _growing(point: Point, starts: dict[str, float]) -> dict[str, Any]:
    """Measure one point of `logarithmic_growth`."""
    gas, lengths = plain_gas(point.scene), point.scene.container.lengths
    if gas.dimension != 2 or gas.diameter != 1.0 or gas.temperature != 1.0:
        raise SceneError(f"experiments.{point.experiment}", "gas", "must be discs of diameter and k_B T 1")
    eta, count = gas.packing_fraction, gas.count
    row: dict[str, Any] = {}
    rate = float(theory.collision_rate(eta, 2))
    for flux, name in QUANTITIES.items():
        enskog = float(ENSKOG[name](**gas.parameters))
        lags, samples = _integrals(point, flux)
        samples /= enskog
        time = end(lags)
        late = rate * time >= starts[name]
        modes, longer = (
            theory.transport_modes(time, eta, count, name, shortest)[late] / enskog
            for shortest in (1.0, LONGER)
        )
        grown = samples[:, late]
        values, errors = means_of(samples)
        drawn = np.full(len(time), np.nan)
        drawn[late] = modes + np.mean(values[late] - modes)
        row |= {
            f"{name}_growth": mean_of((grown[:, -1] - grown[:, 0]) / (modes[-1] - modes[0])),
            name: (values, errors),
            f"{name}_modes": drawn,
            f"{name}_short_waves": 1.0 - (longer[-1] - longer[0]) / (modes[-1] - modes[0]),
        }
    sound = rate * lengths[0] / float(theory.speed_of_sound(eta, 2))
    return {"count": count, "packing_fraction": eta, "sound": sound, "time": rate * time, **row}


def _integrals(point: Point, flux: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the lags (lags,), and the Green-Kubo integrals of a flux (B, lags).

    The B blocks are from all runs.
    """
    blocks = []
    for path in point.replica_paths:
        with open_trajectory(path) as trajectory:
            run = Run(point.scene, trajectory["time"].values, trajectory)
            lags = trajectory["lag"].values
            blocks += list(green_kubo(run, flux))
    return lags, np.array(blocks)
