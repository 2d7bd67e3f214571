"""Viscosity and thermal conductivity from equilibrium, by Green and Kubo and by Helfand.

A point is a gas whose runs have correlated the stress tensor and the heat flux. Its coefficients are divided
by Enskog's; times are in collisions of a particle.
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
"""Quantity that follows from the correlation of each flux."""
ENSKOG = {"viscosity": theory.enskog_viscosity, "conductivity": theory.enskog_conductivity}
LONGER = 2.0
"""Mean free paths: if only longer waves count, the modes' growth differs by the theory's uncertainty."""
LATE = 0.5
"""Part of the longest lag from which on the squared change of Helfand's sum is taken to grow evenly."""


UNITS = {"time": "collisions per particle"}


def viscosity(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the shear viscosity, see `coefficient`, and `bulk`, the bulk viscosity.

    The latter is over Enskog's, by Green and Kubo.
    """
    return table("point", points, _viscosities, inner=("lag",), units=UNITS)


def conductivity(points: list[Point], settings: dict) -> xr.Dataset:
    """Return the thermal conductivity; see `coefficient`."""
    of = "heat", theory.enskog_conductivity
    return table("point", points, coefficient, *of, inner=("lag",), units=UNITS)


def _viscosities(point: Point) -> dict[str, Any]:
    return coefficient(point, "shear", theory.enskog_viscosity) | {"bulk": _bulk(point)}


def _bulk(point: Point) -> Estimate:
    """Measure the bulk viscosity over Enskog's, until a part `LATE` of the longest lag.

    The mean of the pressure is taken in each run, of duration T, which takes off 2 lag / T of the value.
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
    """Measure a coefficient of a point over Enskog's, by the flux of this name.

    The flux is in `trajectory.correlator.STRESS`.

    `value`, the integral of the correlation until the longest lag, and `growth`, half of the slope of
    Helfand's squared change between lags `LATE` and 1 of the longest; `difference`, growth over the mean of
    the integral between these lags, minus 1, from the same runs; running (lag,), the integral until each lag;
    all estimates. `time`, `end` of the integral. dimension, packing_fraction, count; `finite`, the ratio of a
    dilute gas of `count` particles to an infinite one.
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
    meanwhile = samples[:, _half(lags) : -1].mean(axis=1)  # exactly the growth, but for pairs at the ends
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
    """Compute the time until which the integral with each lag extends.

    It is half an interval later, the mean until the next lag, since fluxes are means over intervals.
    """
    return lags + 0.5 * (lags[1] - lags[0])


def _half(lags: np.ndarray) -> int:
    """Return the lag from which on the growth counts."""
    return round(LATE * (len(lags) - 1))


def _growth(lags: np.ndarray, slopes: np.ndarray) -> float:
    """Compute half of the slope of the squared change between two lags.

    `slopes` are half of it over each lag.
    """
    first = _half(lags)
    change = slopes * lags
    return float((change[-1] - change[first]) / (lags[-1] - lags[first]))


def logarithmic_growth(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the growth of the integrals of discs with time, and of hydrodynamic modes.

    The settings are `viscosity_from` and `conductivity_from`, collisions of a particle from which on they are
    compared. Over `point`: count, packing_fraction, sound (collisions until sound has crossed the container);
    over `lag` too: time, in collisions. Of each quantity, "viscosity" and "conductivity", over Enskog's: its
    integral until each time (lag,) and `_error`; _modes (lag,), the modes of the container, with the height
    of the integrals from then on (NaN before); _growth, how much the integral grows until the last time over
    how much its modes do, with `_error` and `_freedom`; _short_waves, the part of that which waves of one to
    two mean free paths make. Raises SceneError for spheres, and for discs whose diameter or temperature is
    not 1.
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
    """Return the lags (lags,), and Green and Kubo's integrals of a flux (B, lags).

    The blocks are of all runs.
    """
    blocks = []
    for path in point.replica_paths:
        with open_trajectory(path) as trajectory:
            run = Run(point.scene, trajectory["time"].values, trajectory)
            lags = trajectory["lag"].values
            blocks += list(green_kubo(run, flux))
    return lags, np.array(blocks)
