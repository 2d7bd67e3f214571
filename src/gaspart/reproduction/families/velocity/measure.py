"""Velocity autocorrelation: its exponential start, and its long-time tail, a power of time.

Everything is in reduced units: the particles' diameter, mass and temperature are 1; s is time in Enskog's
collisions of a particle. The runs' total momentum is subtracted, leaving velocities u relative to the centre
of mass; where momentum is free (canonical) the centre's own velocity, which does not decay, is added:

    C(t) = 1/N + <u(0).u(t)> / (d k_B T),    k_B T = m <u^2> / d * N / (N-1) .

That is exact. C(t) of an infinite fluid differs from it once momentum has come round the container, sound
first, so that the tail is compared with the modes of the container (`theory.velocity_autocorrelation_modes`).
These decay with the transport coefficients of long waves; at a time t the waves that matter are some sqrt((D
+ nu) t) long, and the next terms of their decay rates, of order k^4, are of the order of 1/t of the first. So
the ratio to the modes is fitted by A + B/s, and A compared with 1.
"""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.motion import mask_between
from gaspart.analysis.statistics import fit_linear, fit_polynomial, mean_of, means_of
from gaspart.reproduction.families.shared.runs import reduced_curves
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table


def velocity_autocorrelation(points: list[Point], settings: dict) -> xr.Dataset:
    """Return C(t) of every point, the rate of its start and the amplitude of its tail.

    settings: `start_to`, collisions of a particle up to which -ln C is fitted by a line and a parabola, where
    it is sampled that often; `tail`, from and to which the tail is fitted of all other points.

    Returns over `point` and `lag` (NaN beyond a point's own): collisions s, time, correlation and its error;
    over `point`: dimension, packing_fraction, count, sound (s at which it has crossed the container),
    start_rate and its error (over the collision rate), tail_from, tail_to, tail_ratio and tail_correction, A
    and B of C - 1/N over the sum of the container's modes, and A's error; NaN where a point has none.
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
    elif late.sum() >= 4:  # what is sampled finely is too short for the tail
        share = 1.0 / count  # known exactly, and not part of the tail
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
    """Compute -d ln C / ds at s = 0, of a parabola through 0."""
    return float(fit_polynomial(collisions, -np.log(values), powers=(1, 2)).values[0])
