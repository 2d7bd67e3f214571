"""The velocity autocorrelation: its start, exponential, and its long-time tail, a power of time.

Everything is in reduced units: the particles' diameter, mass and temperature are 1; s is time in Enskog's
collisions of a particle. The runs' total momentum is subtracted, leaving velocities u relative to the centre
of mass; where momentum is free (canonical) one has the centre's own beside, which does not decay:

    C(t) = 1/N + <u(0).u(t)> / (d k_B T),    k_B T = m <u^2> / d * N / (N-1) .

That is exact. C(t) of an infinite fluid differs from it once momentum has come round the container, sound
first, so that the tail is compared with the modes of the container (`theory.velocity_autocorrelation_modes`).
These decay with the transport coefficients of long waves; at a time t the waves that matter are some
sqrt((D + nu) t) long, and the next terms of their decay rates, of order k^4, are of the order of 1/t of the
first. So the ratio to the modes is fitted by A + B/s, and A compared with 1.
"""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.correlations import between
from gaspart.analysis.statistics import fit_linear, fit_polynomial, mean_of, means_of
from gaspart.reproduction.families.shared.curves import reduced_curves
from gaspart.reproduction.families.shared.rows import from_rows
from gaspart.reproduction.points.point import Point


def velocity_autocorrelation(points: list[Point], settings: dict) -> xr.Dataset:
    """C(t) of every point, the rate of its start and the amplitude of its tail.

    settings: `start_to`, collisions of a particle up to which -ln C is fitted by a line and a parabola, where
    it is sampled that often; `tail`, from and to which the tail is fitted of all other points.

    Returns over `point` and `lag` (NaN beyond a point's own): collisions s, time, correlation and its error;
    over `point`: dimension, packing_fraction, count, sound (s at which it has crossed the container),
    start_rate and its error (over the collision rate), tail_from, tail_to, tail_ratio and tail_correction, A
    and B of C - 1/N over the sum of the container's modes, and A's error; NaN where a point has none.
    """
    rows = [_row(point, settings) for point in points]
    return from_rows("point", rows, ("lag",), units={"time": "sigma sqrt(m / k_B T)"})


def _row(point: Point, settings: dict) -> dict:
    scene = point.scene
    dimension, count, eta = scene.dimension, scene.count, scene.packing_fraction
    rate = float(theory.collision_rate(eta, dimension))
    rate *= float(theory.collision_rate_finite_size_factor(eta, dimension, count))
    side = min(scene.container.lengths) / (2.0 * scene.largest_radius)
    sound = side / float(theory.speed_of_sound(eta, dimension)) * rate
    longest = settings["tail"][1] / rate
    runs = [reduced_curves(point, path, longest) for path in point.replica_paths]
    shortest = min(len(one.time) for one in runs)
    time = np.mean([one.time[:shortest] for one in runs], axis=0)
    samples = np.stack([one.correlation[:shortest] for one in runs]) + 1.0 / count
    correlation, error = means_of(samples)
    row = {
        "dimension": dimension,
        "packing_fraction": eta,
        "count": count,
        "sound": sound,
        "collisions": time * rate,
        "time": time,
        "correlation": correlation,
        "correlation_error": error,
        **dict.fromkeys(("start_rate_freedom", "tail_ratio_freedom"), len(samples) - 1),
        **dict.fromkeys(("start_rate", "start_rate_error", "tail_from", "tail_to"), math.nan),
        **dict.fromkeys(("tail_ratio", "tail_ratio_error", "tail_correction"), math.nan),
    }
    early = between(row["collisions"], row["collisions"][1], settings["start_to"])
    if early.sum() >= 4:
        slope = mean_of([_initial_rate(row["collisions"][early], values[early]) for values in samples])
        row |= {"start_rate": slope.value, "start_rate_error": slope.error}
    start, stop = settings["tail"]
    late = between(row["collisions"], start, stop)
    if late.sum() >= 4 and early.sum() < 4:  # what is sampled finely is too short for the tail
        share = 1.0 / count  # known exactly, and not part of the tail
        modes = theory.velocity_autocorrelation_modes(time[late], eta, dimension, count) - share
        fits = np.array([_tail(row["collisions"][late], one[late] - share, modes) for one in samples])
        ratio = mean_of(fits[:, 0].tolist())
        row |= {"tail_from": start, "tail_to": stop, "tail_ratio": ratio.value}
        row |= {"tail_ratio_error": ratio.error, "tail_correction": float(fits[:, 1].mean())}
    return row


def _tail(collisions: np.ndarray, values: np.ndarray, modes: np.ndarray) -> np.ndarray:
    """A and B of values = modes (A + B / s); the noise of C is the same at all lags."""
    return fit_linear(np.stack([modes, modes / collisions], axis=1), values).values


def _initial_rate(collisions: np.ndarray, values: np.ndarray) -> float:
    """-d ln C / ds at s = 0, of a parabola through 0."""
    return float(fit_polynomial(collisions, -np.log(values), powers=(1, 2)).values[0])
