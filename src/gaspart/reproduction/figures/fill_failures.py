r"""Random sequential insertion: failed attempts per particle, and saturation.

With k particles in the container, an attempt succeeds with a probability called the available fraction: that
of a random point to be free. The number of failures before the next success has a geometric distribution.
Time is the number of attempts T, as :math:`t = T v / V` with the volume v of a particle and V of the
container. Late particles fill single small holes, whose sizes are uniformly distributed down to zero, so
:math:`\eta_s - \eta(t) \propto t^{-1/d}` (Feder 1980, Swendsen 1981). A straight line in :math:`t^{-1/d}` is
therefore extrapolated to the saturation :math:`\eta_s`, although no run ever reaches it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import fit_polynomial, jackknife, mean_of
from gaspart.keys import count, list_of, names, positive
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import PARTICLES, Parts
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, table
from gaspart.theory.packing import insertion_saturation_uncertainty

TITLE, CHAPTER = "Random insertion", "Equation of state and structure"
SETTINGS = {
    "saturated": names("the experiments that are filled until nothing more fits"),
    "bins": count("bins of the packing fraction up to the densest fill"),
    "windows": list_of(
        {"type": "number", "exclusiveMinimum": 1},
        "ratios of the last time to the first one of the fitted window; the first is the one claimed",
    ),
    "dilute": positive(
        "packing fraction up to which failures are compared with the low-density expansion", maximum=0.1
    ),
}
SAMPLES, TIMES = 24, 60  # times, equally spaced in ln t, at which lines are fitted; that are stored


@dataclass(frozen=True)
class Fill:
    """All replicas of one container.

    failures : (replica, particle), failures before each particle; -1 for one that was never placed.
    attempts : (replica,), total number of attempts.
    particle : packing fraction of a single particle.
    """

    failures: np.ndarray
    attempts: np.ndarray
    particle: float
    dimension: int

    @property
    def placed(self) -> np.ndarray:
        """Number of placed particles, (replica,)."""
        return (self.failures >= 0).sum(axis=1)

    @property
    def last_time(self) -> float:
        """Last time t that every replica reached."""
        return float(self.attempts.min()) * self.particle

    def window(self, ratio: float) -> np.ndarray:
        """Return the times t, up to the last, at which lines are fitted."""
        return np.geomspace(self.last_time / ratio, self.last_time, SAMPLES)

    def packing_fraction(self, times: np.ndarray) -> np.ndarray:
        """Compute the packing fraction (replica, times) at given times t."""
        attempts = times / self.particle
        placed_at = [np.cumsum(series[series >= 0] + 1) for series in self.failures]
        placed = [np.searchsorted(series, attempts, side="right") for series in placed_at]
        return self.particle * np.array(placed)

    def trials(self) -> tuple[np.ndarray, np.ndarray]:
        """Return failures and successes (replica, particle) at each particle number; 0 beyond the last."""
        successes = (self.failures >= 0).astype(int)
        failures = np.where(self.failures >= 0, self.failures, 0)
        for k, placed in enumerate(self.placed):
            # attempts after the last success belong to the state after this success
            if placed < failures.shape[1]:
                failures[k, placed] = self.attempts[k] - failures[k].sum() - placed
        return failures, successes


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure failures per particle against packing fraction, and saturation, of each container.
    `final_spread` is the standard deviation of a single fill, `filled` the mean packing fraction at `time`.
    Saturation is that of `saturated` containers, the approach to it of periodic ones.
    """
    inner = {
        **dict.fromkeys(("packing_fraction", "failures_per_particle"), ("bin",)),
        **dict.fromkeys(("time", "filled"), ("sample",)),
        **dict.fromkeys(("saturation", "saturation_slope"), ("window",)),
    }
    units = dict.fromkeys(("time", "last_time"), "attempts v / V")
    dataset = table("container", points, _container, settings, inner=inner, units=units)
    windows = np.array(settings["windows"], dtype=float)
    return dataset.assign_coords(window=windows).assign_attrs(dilute_up_to=settings["dilute"])


def _container(point: Point, settings: dict) -> dict[str, Any]:
    fill, windows, absent = _read(point), settings["windows"], (np.nan, np.nan)
    saturates, periodic = point.experiment in settings["saturated"], point.scene.container.periodic[0]
    by_centres = "centres_to_walls" if point.settings.get("centres_to_walls", False) else "wall"
    eta, failures, error = failures_by_density(fill, settings["bins"])
    ends = [saturation(fill, window) if saturates else (*absent, np.nan) for window in windows]
    end, end_error, slope = np.transpose(ends)
    times = np.geomspace(1.0, max(fill.last_time, 1.0), TIMES)
    final = fill.placed * fill.particle
    return {
        "container": point.experiment if point.name == "single" else f"{point.experiment}/{point.name}",
        "dimension": fill.dimension,
        "side_over_diameter": min(point.extents[2]) / (2.0 * point.extents[1]),
        "rule": "periodic" if periodic else by_centres,
        "replicas": len(fill.attempts),
        "placed": fill.placed.mean(),
        "final": final.mean(),
        "final_spread": final.std(ddof=1),
        "last_time": fill.last_time,
        "packing_fraction": eta,
        "failures_per_particle": (failures, error),
        "time": times,
        "filled": fill.packing_fraction(times).mean(axis=0),
        "saturation": (end, end_error),
        "saturation_freedom": len(fill.attempts) - 1,
        "saturation_slope": slope,
        "approach": approach_exponent(fill, windows[0]) if saturates and periodic else absent,
        "dilute_failures": dilute_failures(fill, settings["dilute"]) if periodic else absent,
    }


def _read(point: Point) -> Fill:
    with xr.open_dataset(point.path) as dataset:
        failures, attempts = (dataset[name].values.astype(np.int64) for name in ("failures", "attempts"))
        particle = float(dataset.attrs["packing_fraction_per_particle"])
    return Fill(failures, attempts, particle, point.settings["dimension"])


def failures_by_density(fill: Fill, bins: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Compute mean packing fraction, failures per placed particle, and their error, (bins,). The bins are of
    equal width, from 0 to the densest fill. Results are NaN if less than half of the replicas placed a
    particle in the bin, because the others are a biased sample. The error is a jackknife error over the
    replicas. It is at least the scatter of the geometric distribution.
    """
    failures, successes = fill.trials()
    states = np.arange(failures.shape[1])
    bin_of = np.minimum(states * bins // max(int(fill.placed.max()), 1), bins - 1)
    result = np.full((3, bins), np.nan)
    for k in range(bins):
        lost, won = failures[:, bin_of == k].sum(axis=1), successes[:, bin_of == k].sum(axis=1)
        if 2 * np.count_nonzero(won) < len(won) or not won.sum():
            continue
        ratio = lost.sum() / won.sum()
        tried = (failures + successes)[:, bin_of == k].sum(axis=0) > 0
        error = np.sqrt(ratio * (1.0 + ratio) / won.sum())
        if not np.any(won == won.sum()):  # else all successes are in one replica: it cannot be left out
            error = max(error, float(jackknife(lambda lost, won: lost / won, lost, won)[1]))
        result[:, k] = states[bin_of == k][tried].mean() * fill.particle, ratio, error
    return result[0], result[1], result[2]


def saturation(fill: Fill, window: float) -> tuple[float, float, float]:
    """Fit the packing fraction at t = infinity, its error from at least two replicas, and the slope. For each
    replica, a straight line of eta against t^(-1/d) is fitted by least squares.
    """
    times = fill.window(window)
    x = times ** (-1.0 / fill.dimension)
    lines = np.array([fit_polynomial(x, eta).values for eta in fill.packing_fraction(times)])
    ends = mean_of(lines[:, 0])
    return ends.value, ends.error, float(lines[:, 1].mean())


def approach_exponent(fill: Fill, window: float) -> tuple[float, float]:
    """Fit p in eta_s - eta ~ t^-p with eta_s of the literature, and its jackknife error over replicas."""
    times = fill.window(window)
    gap = theory.RSA_SATURATION[fill.dimension] - fill.packing_fraction(times)

    def exponent(mean_gap: np.ndarray) -> float:
        if np.any(mean_gap <= 0.0):
            return np.nan
        return -fit_polynomial(np.log(times), np.log(mean_gap)).values[1]

    value, error = jackknife(exponent, gap)
    return float(value), float(error)


def dilute_failures(fill: Fill, up_to: float) -> tuple[float, float]:
    """Compute failures below the packing fraction `up_to`, divided by those expected for each particle. The
    error follows from the geometric distribution: sqrt(sum of f (1 + f)) divided by the sum of f.
    """
    failures, _ = fill.trials()
    states = np.arange(failures.shape[1])
    below = (states * fill.particle <= up_to) & (states < fill.placed.min())
    expected = theory.failures_per_particle(states[below] * fill.particle, fill.dimension)
    replicas = len(failures)
    total = replicas * expected.sum()
    if total == 0.0:
        return np.nan, np.nan
    scatter = np.sqrt(replicas * np.sum(expected * (1.0 + expected)))
    return float(failures[:, below].sum() / total), float(scatter / total)


# Packing fraction that source A's program reached (section 3.2), to per cent; 180 spheres have 0.5226.
SOURCE_FRACTION = 0.52
WHERE = {
    "periodic": "periodic",
    "wall": "entirely inside walls",
    "centres_to_walls": "with centres up to the walls",
}


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims on saturation, source A's 52 %, the approach to saturation, and failures when dilute."""
    for fill in Table(dataset, "container"):
        side = f"(L/σ = {fill.side_over_diameter:.3g})"
        particles = f"{PARTICLES[fill.dimension]} {WHERE[fill.rule]} {side}"
        saturates = np.isfinite(fill.saturation.value[0])
        if saturates:
            yield _saturation(fill, particles)
        if saturates and fill.rule == "centres_to_walls":
            # A sample of the distribution of our fills, if the single fill had enough attempts.
            rounding = Estimate(0.0, 0.01 / np.sqrt(12.0))
            yield Claim(
                f"packing fraction at which insertion ends, {particles}, whole spheres counted: "
                "source A's 52 %",
                fill.saturation[0], Estimate(SOURCE_FRACTION, fill.final_spread) + rounding, 4e-3,
                "[source A], section 3.2: a single fill",
                "source A counted or placed its spheres by another rule",
                kind="reproduction",
                allowance_source="the scatter of our fills, as that of its one fill, and its rounding to a "
                "percent",
                source_error="its centres go up to the walls, and its spheres are counted completely",
            )  # fmt: skip
        if np.isfinite(fill.approach.value):
            yield Claim.within(
                f"exponent p of (saturation - packing fraction) ~ attempts^-p, {particles}",
                fill.approach, 1.0 / fill.dimension, 0.15 / fill.dimension,
                "[Feder 1980], [Swendsen 1981]: 1/d, once only single holes remain",
                "the window is too early, or attempts are counted wrongly",
            )  # fmt: skip
        # In a fill that continues to saturation, the first few particles carry little information.
        if np.isfinite(fill.dilute_failures.value) and not saturates:
            yield Claim(
                f"failed attempts up to packing fraction {fill.dilute_up_to:g} over those expected, "
                f"{particles}",
                fill.dilute_failures, 1.0, 0.02, "available fraction 1 - 2^d η + c η^2, exact to that order",
                "failures are counted wrongly, or overlaps with near neighbours are missed or spurious",
            )  # fmt: skip


def _saturation(fill: Row, particles: str) -> Claim:
    container = fill.dimension, fill.side_over_diameter, fill.rule
    periodic = fill.rule == "periodic"
    wall = "" if periodic else ", times the wall excess (1 + 0.64 σ/L')^3 of saturated fills"
    no_program = "the wall excess was fitted to insertions by a program that is not in this repository"
    stated = theory.insertion_saturation(*container), insertion_saturation_uncertainty(*container)
    return Claim(
        f"saturation of random insertion, {particles}, extrapolated in attempts^(-1/{fill.dimension})",
        fill.saturation[0], Estimate(*stated), 1e-3 if periodic else 4e-3, f"[Zhang 2013]{wall}",
        "free places are missed, overlaps are accepted, or the late window is not asymptotic",
        allowance_source="its last digits" if periodic else "a fit to insertions, not in this repository",
        no_verdict="" if periodic else no_program,
    )  # fmt: skip


# Labels of the series, by dimension and rule, in the order of the legend.
LABELS = {
    (3, "centres_to_walls"): "spheres, centres up to walls",
    (3, "periodic"): "spheres, periodic",
    (3, "wall"): "spheres completely inside",
    (2, "periodic"): "discs, periodic",
}


def draw(dataset: xr.Dataset) -> Figure:
    """Draw failures per particle up to saturation and at low density, and the approach to saturation."""
    figure, (upper, middle, lower) = style.new((3.4,), (1.6,), (2.2,))
    containers = Table(dataset, "container")
    for kind, ((dimension, rule), label) in enumerate(LABELS.items()):
        for fill in containers[(containers.dimension == dimension) & (containers.rule == rule)]:
            if np.isfinite(fill.saturation.value[0]):
                _failures(upper, fill, kind, label)
                _draw_saturation(lower, fill, kind)
            else:
                _failures(middle, fill, kind, label)
    _limits(upper)
    _low_density(middle)
    columns = 2 if style.width() > style.COLUMN else 1
    legend = upper.get_legend_handles_labels()
    figure.legend(*legend, loc="outside upper center", ncols=columns, columnspacing=1.0)
    axes = "(attempts $\\times\\ v/V)^{-1/d}$", "packing fraction $\\eta$"
    style.label_axes(lower, *axes, xlim=(-0.008, 0.47), ylim=(0.2, 0.58))
    style.letters(upper, middle, lower)
    return figure


def _failures(axis: Axes, fill: Row, kind: int, label: str) -> None:
    failures = fill.failures_per_particle
    some = np.where(failures.value > 0.0, failures.value, np.nan)  # the scale is logarithmic
    style.points(axis, fill.packing_fraction, some, failures.error, kind, markersize=2.5, label=label)


def _limits(axis: Axes) -> None:
    """Draw saturation in an infinite container, and source A's packing fraction."""
    marks = [
        (theory.RSA_SATURATION[3], "3D: 0.384", style.COLOURS[1], -0.006, "right"),
        (SOURCE_FRACTION, "source A: 52 %", style.COLOURS[0], -0.006, "right"),
        (theory.RSA_SATURATION[2], "2D: 0.547", style.COLOURS[3], 0.006, "left"),
    ]
    for fraction, text, colour, shift, side in marks:
        axis.axvline(fraction, color=colour, linestyle="--", linewidth=0.8, zorder=1)
        axis.text(fraction + shift, 0.013, text, color=colour, rotation=90, ha=side, va="bottom")
    labels = "packing fraction $\\eta$", "failed attempts per particle"
    style.label_axes(axis, *labels, yscale="log", xlim=(0.0, 0.59), ylim=(0.01, 6e6))


def _low_density(axis: Axes) -> None:
    """Draw the exact low-density expansion."""
    eta = np.linspace(0.0, 0.06, 60)
    for dimension in (2, 3):
        axis.plot(eta, theory.failures_per_particle(eta, dimension), color="black", linewidth=0.8, zorder=4)
    axis.text(0.036, 0.48, "$2^3\\eta+\\ldots$", ha="right")
    axis.text(0.058, 0.03, "$2^2\\eta+\\ldots$", ha="right")
    labels = "packing fraction $\\eta$", "failures per particle"
    style.label_axes(axis, *labels, xlim=(0.0, 0.06), ylim=(0.0, 0.85))


def _draw_saturation(axis: Axes, fill: Row, kind: int) -> None:
    """Draw the growing packing fraction, its fitted line, and the predicted saturation."""
    colour, marker = style.COLOURS[kind], style.MARKERS[kind]
    x = fill.time ** (-1.0 / fill.dimension)
    axis.plot(x, fill.filled, color=colour, linestyle="none", marker=marker, markersize=2.5, zorder=3)
    x = np.linspace(0.0, 0.45, 2)
    line = fill.saturation.value[0] + fill.saturation_slope[0] * x
    axis.plot(x, line, color=colour, linewidth=0.8)
    expected = theory.insertion_saturation(fill.dimension, fill.side_over_diameter, fill.rule)
    axis.plot([0.0], [expected], marker="_", markersize=12, color="black", clip_on=False, zorder=5)


FIGURES = {"fill_failures": Parts(SETTINGS, measure, claims, draw)}
