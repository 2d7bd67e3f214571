"""Velocity autocorrelation: its exponential start, and its long-time tail, a power of time.

Units are reduced (see `_displacement`); s is the number of collisions of a particle by Enskog theory. If the
momentum is free, the constant velocity of the centre of mass adds to that of velocities u relative to it:

    C(t) = 1/N + <u(0).u(t)> / (d k_B T),    k_B T = m <u^2> / d * N / (N-1) .

C of an infinite fluid differs after momentum has crossed the periodic container, and sound before. Therefore
the tail is compared with the modes of the container, which decay with the transport coefficients of long
waves. At time t, waves of length sqrt((D + nu) t) dominate; the next terms of their decay rates, of order
k^4, are smaller by a factor of order 1/t. The ratio to the modes is fitted by A + B/s, and A compared with 1.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.motion import mask_between
from gaspart.analysis.statistics import fit_linear, fit_polynomial, mean_of, means_of
from gaspart.keys import POSITIVE, list_of, positive
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.figure import PARTICLES, Parts
from gaspart.reproduction.figures._displacement import MODE_COUPLING, reduced_curves
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, table
from gaspart.theory.diffusion import velocity_autocorrelation_tail
from gaspart.theory.modes import velocity_autocorrelation_modes

TITLE, CHAPTER = "Displacement and velocity autocorrelation", "Motion and its memory"
SETTINGS = {
    "start_to": positive("collisions of a particle up to which the initial decay is fitted"),
    "tail": list_of(POSITIVE, "collisions of a particle from and to which the tail is fitted", 2, 2),
}


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure C of every point, and its initial decay rate if it is finely sampled, else its tail."""
    return table("point", points, _row, settings, inner=("lag",), units={"time": "sigma sqrt(m / k_B T)"})


def _row(point: Point, settings: dict) -> dict[str, Any]:
    scene = point.scene
    dimension, count, eta = scene.dimension, scene.count, scene.packing_fraction
    rate = float(theory.collision_rate(eta, dimension))
    rate *= float(theory.collision_rate_finite_size_factor(eta, dimension, count))
    side = min(scene.container.lengths) / (2.0 * scene.largest_radius)
    start, stop = settings["tail"]
    runs = [reduced_curves(point, path, stop / rate) for path in point.replica_paths]
    shortest, share = min(len(run.time) for run in runs), 1.0 / count
    time = np.mean([run.time[:shortest] for run in runs], axis=0)
    samples = np.stack([run.correlation[:shortest] for run in runs]) + share
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
    early = mask_between(collisions, collisions[1], settings["start_to"])
    late = mask_between(collisions, start, stop)
    if early.sum() >= 4:
        row["start_rate"] = mean_of([initial_rate(collisions[early], values[early]) for values in samples])
    elif late.sum() >= 4:  # finely sampled runs are too short for the tail
        # 1/N is exactly known, and not part of the tail
        modes = velocity_autocorrelation_modes(time[late], eta, dimension, count) - share
        fits = np.array([fit_tail(collisions[late], values[late] - share, modes) for values in samples])
        row |= {"tail_from": start, "tail_to": stop, "tail_ratio": mean_of(fits[:, 0])}
        row["tail_correction"] = fits[:, 1].mean()
    return row


def fit_tail(collisions: np.ndarray, values: np.ndarray, modes: np.ndarray) -> np.ndarray:
    """Fit A and B of values = modes (A + B / s); the noise of C is the same at all lags."""
    return fit_linear(np.stack([modes, modes / collisions], axis=1), values).values


def initial_rate(collisions: np.ndarray, values: np.ndarray) -> float:
    """Compute -d ln C / ds at s = 0, from a parabola through the origin."""
    return float(fit_polynomial(collisions, -np.log(values), powers=(1, 2)).values[0])


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims on the exact initial decay, and on the amplitude of the long-time tail."""
    for gas in Table(dataset, "point"):
        which = f"{PARTICLES[gas.dimension]}, packing fraction {gas.packing_fraction:.2g}"
        if np.isfinite(gas.start_rate.value):
            yield Claim(
                f"initial decay of C(t) over 2 nu / d, {which}",
                gas.start_rate / (2.0 / gas.dimension), 1.0, 0.005,
                "Enskog, exact at the start: contacts of equilibrium, velocities not yet correlated",
                "a wrong collision rate or impulse",
            )  # fmt: skip
        if np.isfinite(gas.tail_ratio.value):
            window = f"collisions {gas.tail_from:.3g} to {gas.tail_to:.3g}, {which}"
            yield Claim(
                f"long-time tail over the sum of the container's modes, extrapolated from {window}",
                gas.tail_ratio, 1.0, 0.1, MODE_COUPLING,
                "no vortex forms about a moving particle, or the wrong viscosity spreads it",
                alternative=0.0,
            )  # fmt: skip


S = r"collisions per particle $s=\nu t$"


def draw(dataset: xr.Dataset) -> Figure:
    """Draw C against collisions per particle, its start, and C - 1/N over the container's modes."""
    figure, (upper, middle, lower) = style.new((2.6,), (2.0,), (2.2,))
    gases = Table(dataset, "point")
    long = gases[np.isfinite(gases.tail_ratio.value)].sorted_by("dimension", "packing_fraction")
    _tails(upper, long)
    _starts(middle, gases[np.isfinite(gases.start_rate.value)])
    _ratios(lower, long)
    style.letters(upper, middle, lower)
    return figure


def _name(gas: Row) -> str:
    return rf"{PARTICLES[gas.dimension]}, $\eta={gas.packing_fraction:.2g}$"


def _lags(gas: Row) -> Table:
    """Return the lags of a gas, without lag 0."""
    lags = Table(gas.dataset, "lag")
    return lags[np.isfinite(lags.correlation.value)][1:]


def _tails(axis: Axes, gases: Table) -> None:
    """Draw measured C, initial exponentials exp(-2 s / d), and mode-coupling tails."""
    s = np.linspace(0.5, 9.0, 100)
    for dimension, line in ((2, "--"), (3, ":")):
        label = rf"$\mathrm{{e}}^{{-2s/{dimension}}}$"
        axis.plot(s, np.exp(-2.0 / dimension * s), color=style.GREY, linestyle=line, label=label)
    for kind, gas in enumerate(gases):
        lags = _lags(gas)
        late = lags[lags.collisions > 3.0]
        tail = velocity_autocorrelation_tail(late.time, gas.packing_fraction, gas.dimension)
        axis.plot(late.collisions, tail, color=style.COLOURS[kind], zorder=1)
        seen = lags[lags.correlation.value > 0.0]
        style.points(axis, seen.collisions, seen.correlation, kind=kind, markersize=2.5, label=_name(gas))
    axis.plot([], [], color=style.DATA, label="mode coupling")
    axis.set(xscale="log", yscale="log", xlim=(0.8, 65.0), ylim=(1e-3, 1.0))
    _integer_ticks(axis)
    style.label_axes(axis, S, r"$C=\langle v(0)v(t)\rangle/\langle v^2\rangle$", "lower left")


def _starts(axis: Axes, gases: Table) -> None:
    """Draw ln C against collisions, and the exact initial slopes."""
    s = np.linspace(0.0, 2.0, 50)
    for kind, gas in enumerate(gases):
        axis.plot(s, np.exp(-2.0 / gas.dimension * s), color=style.COLOURS[kind], zorder=1)
        lags = _lags(gas)
        early = lags[lags.collisions <= 2.0]
        style.points(axis, early.collisions, early.correlation, kind=kind, label=_name(gas))
    axis.set_yscale("log")
    axis.set_yticks((0.2, 0.5, 1.0), ("0.2", "0.5", "1"))
    axis.minorticks_off()
    style.label_axes(axis, S, "$C$", "upper right" if gases else "", xlim=(0.0, 2.0))


def _ratios(axis: Axes, gases: Table) -> None:
    """Draw C - 1/N over the modes, with its fit; a line where sound has crossed the container."""
    style.level(axis, 1.0)
    for kind, gas in enumerate(gases):
        lags, share = _lags(gas), 1.0 / gas.count
        late = lags[lags.collisions > 5.0]
        state = gas.packing_fraction, gas.dimension, gas.count
        modes = velocity_autocorrelation_modes(late.time, *state) - share
        axis.axvline(gas.sound, color=style.COLOURS[kind], linestyle=":", linewidth=0.8)
        ratio = (late.correlation - share) / modes
        style.points(axis, late.collisions, ratio, kind=kind, markersize=2.5)
        fitted = np.linspace(gas.tail_from, gas.tail_to, 50)
        curve = gas.tail_ratio.value + gas.tail_correction / fitted
        axis.plot(fitted, curve, color=style.COLOURS[kind])
    if gases:
        axis.axvspan(gases.tail_from.min(), gases.tail_to.max(), color=style.GREY, alpha=0.18, lw=0)
    axis.set(xscale="log", xlim=(5.0, 65.0), ylim=(0.4, 1.8))
    _integer_ticks(axis)
    style.label_axes(axis, S, "$(C-1/N)$ / modes")


def _integer_ticks(axis: Axes) -> None:
    low, high = axis.get_xlim()
    ticks = [tick for tick in (1, 2, 5, 10, 20, 40) if low <= tick <= high]
    axis.set_xticks(ticks, [str(tick) for tick in ticks])
    axis.minorticks_off()


FIGURES = {"velocity_autocorrelation": Parts(SETTINGS, measure, claims, draw)}
