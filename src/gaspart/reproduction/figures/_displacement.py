"""What figures of the mean-squared displacement (msd) share: curves, short runs, panels.

Units are reduced: diameter, mass and temperature 2 E' / (d (N - 1)) of each replica are 1, where E' is the
energy in the frame of the centre of mass, whose drift is removed. Errors are those of means over replicas.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from gaspart import theory
from gaspart.analysis.motion import Curves, average_correlations, line, mask_between
from gaspart.analysis.statistics import means_of
from gaspart.errors import SceneError
from gaspart.rendering import style
from gaspart.rendering.style import Axes
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table
from gaspart.scene.facts import plain_gas
from gaspart.theory.diffusion import viscosity_ratio
from gaspart.trajectory.reading import open_trajectory

# Largest sampling interval, in collisions per particle, of a run for short times, without D: Simpson's rule
# integrates its velocity autocorrelation C to 1e-4.
SHORT_INTERVAL = 0.5
# Collisions per particle between which the integral of C is compared with the msd's slope.
GREEN_KUBO_FROM, GREEN_KUBO_TO = 8.0, 16.0
REDUCED_TIME = "diameter sqrt(mass / temperature)"
MODE_COUPLING = "hydrodynamic modes of the container, transport coefficients Enskog's (gaspart.theory.modes)"
ABSENT = Estimate(math.nan, math.nan, math.nan)
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


class State:
    """Predictions for a point's gas."""

    def __init__(self, point: Point) -> None:
        gas = plain_gas(point.scene)
        eta, dimension = gas.packing_fraction, gas.dimension
        self.count, self.packing_fraction = gas.count, eta
        self.side = point.scene.container.lengths[0] / gas.diameter
        self.collision_rate = float(theory.collision_rate(eta, dimension))
        self.mean_free_path = float(theory.mean_free_path(eta, dimension))
        self.viscosity = float(theory.enskog_viscosity(eta, dimension))
        if dimension == 3:
            self.viscosity *= float(viscosity_ratio(eta))
        density, diffusion = theory.number_density(eta, dimension), theory.enskog_diffusion(eta, dimension)
        spreading = float(diffusion) + self.viscosity / density
        self.shear_time = (self.side / (2.0 * math.pi)) ** 2 / spreading
        self.sound_time = self.side / float(theory.speed_of_sound(eta, dimension))


def reduced_curves(point: Point, path: str, longest: float) -> Curves:
    """Return the curves of one replica in reduced units, up to the lag `longest`, or to its last lag."""
    if "lags" not in point.settings:
        raise SceneError(f"experiments.{point.experiment}.lags", None, "is required")
    gas = plain_gas(point.scene)
    with open_trajectory(path) as trajectory:
        curves = average_correlations(trajectory)
    thermal_speed = math.sqrt(curves.correlation[0] * gas.count / (gas.count - 1))
    interval = curves.time[1] * thermal_speed / gas.diameter
    lags = min(len(curves.time), math.ceil(longest / interval) + 1)
    return Curves(
        interval * np.arange(lags),
        curves.msd[:lags] / gas.diameter**2,
        curves.correlation[:lags] / thermal_speed**2,
        curves.running[:lags] / (gas.diameter * thermal_speed),
    )


def replicas(point: Point, longest: float) -> list[Curves]:
    """Return the curves of all replicas, up to the lag `longest`, or to the last lag of all."""
    where = f"experiments.{point.experiment}"
    if not point.settings.get("displacements", False):
        raise SceneError(f"{where}.displacements", False, "must be true")
    if point.replicas < 2:
        raise SceneError(f"{where}.replicas", point.replicas, "must be at least 2")
    curves = [reduced_curves(point, path, longest) for path in point.replica_paths]
    # Temperatures of replicas differ slightly; so may the last lag.
    shortest = min(len(curve.time) for curve in curves)
    return [Curves(*(array[:shortest] for array in vars(curve).values())) for curve in curves]


def mean(samples: Sequence[Any]) -> Estimate:
    return Estimate(*means_of(samples), len(samples) - 1)


def columns(point: Point, state: State, curves: list[Curves]) -> dict[str, Any]:
    """Return the columns of every point. In short runs `integral_difference` is the slope of the twice
    integrated C over that of the msd / 2d, less 1: the first uses only velocities, the second only
    displacements.
    """
    time = np.mean([curve.time for curve in curves], axis=0)
    rate, dimension = state.collision_rate, point.settings["dimension"]
    no_curve = Estimate(np.full(time.size, math.nan), math.nan, math.nan)
    row = vars(state) | {
        "experiment": point.experiment,
        "replicas": len(curves),
        "interval": time[1] * rate,
        "time": time,
        "msd": mean([curve.msd for curve in curves]),
        "running": mean([curve.running for curve in curves]),
        "integral_difference": ABSENT,
        "correlation": no_curve,
        "integral": no_curve,
    }
    if not is_short(row):
        return row
    from scipy.integrate import cumulative_simpson

    integrals = [cumulative_simpson(curve.correlation, x=curve.time, initial=0.0) for curve in curves]
    differences = []
    for curve, integral in zip(curves, integrals, strict=True):
        inside = mask_between(curve.time * rate, GREEN_KUBO_FROM, GREEN_KUBO_TO)
        twice = cumulative_simpson(integral, x=curve.time, initial=0.0)
        einstein = line(curve.time[inside], curve.msd[inside]) / (2.0 * dimension)
        differences.append(line(curve.time[inside], twice[inside]) / einstein - 1.0)
    return row | {
        "correlation": mean([curve.correlation for curve in curves]),
        "integral": mean(integrals),
        "integral_difference": mean(differences),
    }


def is_short(row: dict[str, Any]) -> bool:
    """Return True for a finely sampled run, which is too short for D."""
    return bool(row["interval"] <= SHORT_INTERVAL)


def fine(points: Table) -> Table:
    return points[np.isfinite(points.integral_difference.value)]


def claim_short_times(points: Table) -> Iterator[Claim]:
    """Yield the claims on the ballistic start, and on D(t) by Green and Kubo compared with Einstein's."""
    for run in fine(points):
        eta = run.packing_fraction
        enskog = theory.enskog_mean_squared_displacement(run.time[1], eta, run.dimension)
        yield Claim.within(
            f"Green-Kubo integral over Einstein slope at packing fraction {eta:g}",
            run.integral_difference + 1.0, 1.0, 0.01, "stationarity (exact)",
            "displacements that are not the integral of the velocities, or sampling too coarse",
            kind="identity",
        )  # fmt: skip
        yield Claim(
            # An exponential with the rate of Enskog's D would deviate by 0.001 to 0.002.
            f"msd over Enskog's after {run.interval:.2g} collisions, packing fraction {eta:g}",
            run.msd[1] / enskog, 1.0, 0.001,
            "the linear Boltzmann equation at Enskog's collision rate, exact before correlated collisions",
            "a wrong temperature, time or initial decay of the velocity",
        )  # fmt: skip


def fractions(points: Table) -> np.ndarray:
    """Return the packing fractions with finely sampled runs; their curves start at short times."""
    return np.unique(fine(points).packing_fraction.round(6))


def _pieces(points: Table, eta: float) -> Iterator[tuple[Row, np.ndarray]]:
    """Yield (run, lags) of a packing fraction, first the finely sampled run; about eight lags per decade."""
    runs = list(points[np.isclose(points.packing_fraction, eta, atol=1e-5)].sorted_by("interval"))
    ends, begin = [run.time[1] for run in runs[1:]] + [np.inf], 0.0
    for run, end in zip(runs, ends, strict=True):
        lags = np.flatnonzero((run.time > begin) & (run.time < end))
        if lags.size:
            begin, number = run.time[lags[-1]], int(np.ceil(8.0 * np.log10((lags[-1] + 1) / lags[0]))) + 1
            yield run, np.unique(np.geomspace(lags[0], lags[-1], number).round().astype(int))


def draw_displacement(axis: Axes, points: Table) -> None:
    """Draw the msd against time, with Enskog theory and the ballistic limit."""
    longest, dimension = 0.0, points.dimension
    for kind, eta in enumerate(fractions(points)):
        for number, (run, lags) in enumerate(_pieces(points, eta)):
            label = None if number else rf"$\eta={eta:g}$"
            style.points(axis, run.time[lags], run.msd[lags], kind=kind, hollow=True, label=label)
            longest = max(longest, run.time[lags].max())
        time = np.geomspace(points.time[:, 1].min(), longest, 200)
        curve = theory.enskog_mean_squared_displacement(time, eta, dimension)
        axis.loglog(time, curve, color=style.COLOURS[kind], lw=0.8)
    top = axis.get_ylim()[1]
    label = rf"ballistic ${dimension}t^2$"
    axis.plot(time, dimension * time**2, color=style.DATA, ls="--", lw=0.8, label=label)
    axis.plot([], [], color=style.GREY, lw=0.8, label="Enskog")
    axis.set_ylim(top=top)
    square = r"$\langle|\Delta\mathbf{r}|^2\rangle\ (\sigma^2)$"
    style.label_axes(axis, r"time $t\ (\sigma\sqrt{m/k_\mathrm{B}T})$", square, "lower right")


def draw_running(axis: Axes, points: Table) -> None:
    """Draw D(t) over Enskog's D: points from displacements, lines from velocities."""
    fractions, dimension = np.unique(points.packing_fraction.round(6)), points.dimension
    axis.set_xscale("log")
    for kind, eta in enumerate(fractions):
        enskog, rate = _enskog(eta, dimension)
        for number, (run, lags) in enumerate(_pieces(points, eta)):
            label = None if number else rf"$\eta={eta:g}$"
            running = run.running[lags] / enskog
            style.points(axis, rate * run.time[lags], running, kind=kind, hollow=True, label=label)
            integral = run.integral.value[np.isfinite(run.integral.value)]
            if integral.size:
                until = run.time[1 : integral.size]
                axis.plot(rate * until, integral[1:] / enskog, color=style.COLOURS[kind], lw=0.8)
            elif dimension == 2:
                _logarithm(axis, run, eta, kind)
    x = np.geomspace(*axis.get_xlim(), 200)
    enskog, rate = _enskog(fractions[0], dimension)
    decay = 1.0 / (enskog * rate)  # per collision, it is the same at every packing fraction
    axis.plot(x, -np.expm1(-decay * x), color=style.DATA, lw=0.8, label="Enskog", zorder=1)
    axis.plot([], [], color=style.GREY, lw=0.8, label="Green-Kubo")
    if dimension == 2:
        axis.plot([], [], color=style.GREY, lw=1.6, alpha=0.5, label="mode coupling")
    labels = r"collisions per particle $\nu t$", r"$D(t)/D_\mathrm{Enskog}$"
    style.label_axes(axis, *labels, legend="lower right", columns=1 + (len(fractions) > 3))
    axis.set_ylim(0.0)


def _enskog(eta: float, dimension: int) -> tuple[float, float]:
    """Compute D and the collision rate by Enskog theory."""
    return float(theory.enskog_diffusion(eta, dimension)), float(theory.collision_rate(eta, dimension))


def _logarithm(axis: Axes, run: Row, eta: float, kind: int) -> None:
    """Draw a line with the predicted slope through the middle of D(t) in the fitted interval."""
    enskog, rate = _enskog(eta, 2)
    ends, finite = np.array([run.fit_from, run.fit_to]), np.isfinite(run.time)
    middle = np.sqrt(ends.prod())
    height = np.interp(middle, run.time[finite], run.running.value[finite])
    values = height + float(theory.logarithmic_slope(eta)) * np.log(ends / middle)
    axis.plot(rate * ends, values / enskog, color=style.COLOURS[kind], lw=1.6, alpha=0.5, zorder=2)
