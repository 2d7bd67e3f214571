"""Figures of displacement and velocity autocorrelation."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.rendering import style
from gaspart.reproduction.families.motion.claims import infinite
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.table import Row, Table


def msd_spheres(ds: xr.Dataset) -> Figure:
    """Draw the msd, D(t) from displacements and velocities, and D against density and 1/L."""
    figure, axes = style.new((2.4,), (2.4,), (2.3,), (2.3,))
    points = Table(ds, "point")
    _displacement(axes[0], points)
    fine = np.isfinite(points.integral_difference.value)
    mask = np.isin(points.packing_fraction.round(6), _fractions(points)) & (points.largest | fine)
    _running(axes[1], points[mask])
    _density(axes[2], points[points.largest].sorted_by("packing_fraction"))
    _size(axes[3], points[points.in_series])
    style.letters(*axes)
    return figure


def msd_discs(ds: xr.Dataset) -> Figure:
    """Draw the msd of discs, D(t), which does not converge, and its slope against ln t."""
    figure, axes = style.new((2.6,), (2.2,), (2.2,))
    points = Table(ds, "point")
    _displacement(axes[0], points)
    _running(axes[1], points)
    long = points[np.isfinite(points.logarithmic_slope.value)]
    _slopes(axes[2], long.sorted_by("packing_fraction"))
    style.letters(*axes)
    return figure


def _fractions(points: Table) -> np.ndarray:
    """Return the packing fractions with finely sampled runs; their curves start at short times."""
    fine = points[np.isfinite(points.integral_difference.value)]
    return np.unique(fine.packing_fraction.round(6))


def _spread(first: int, last: int) -> np.ndarray:
    """Compute indices from `first` to `last` - 1, about eight per decade."""
    number = int(np.ceil(8.0 * np.log10(last / first))) + 1
    return np.unique(np.geomspace(first, max(last - 1, first), number).round().astype(int))


def _pieces(points: Table, eta: float) -> Iterator[tuple[Row, np.ndarray]]:
    """Yield (run, lags) of a packing fraction: first the finely sampled run, then the long runs."""
    runs = list(points[np.isclose(points.packing_fraction, eta, atol=1e-5)].sorted_by("interval"))
    ends, begin = [run.time[1] for run in runs[1:]] + [np.inf], 0.0
    for run, end in zip(runs, ends, strict=True):
        lags = np.flatnonzero((run.time > begin) & (run.time < end))
        if lags.size:
            begin = run.time[lags[-1]]
            yield run, _spread(lags[0], lags[-1] + 1)


def _displacement(axis: Axes, points: Table) -> None:
    """Draw the msd against time in reduced units, with Enskog theory and the ballistic limit."""
    longest, dimension = 0.0, points.dimension
    for kind, eta in enumerate(_fractions(points)):
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


def _running(axis: Axes, points: Table) -> None:
    """Draw D(t) divided by Enskog's D, where D(t) is the slope of the msd over 2d.

    Points are from displacements, lines from velocities.
    """
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
                _draw_prediction(axis, run, eta, kind)
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


def _draw_prediction(axis: Axes, run: Row, eta: float, kind: int) -> None:
    """Draw a line with the predicted slope through the middle of D(t) in the fitted interval.

    The slope is predicted for logarithmic growth.
    """
    enskog, rate = _enskog(eta, 2)
    ends, finite = np.array([run.fit_from, run.fit_to]), np.isfinite(run.time)
    middle = np.sqrt(ends.prod())
    height = np.interp(middle, run.time[finite], run.running.value[finite])
    values = height + float(theory.logarithmic_slope(eta)) * np.log(ends / middle)
    axis.plot(rate * ends, values / enskog, color=style.COLOURS[kind], lw=1.6, alpha=0.5, zorder=2)


def _density(axis: Axes, largest: Table) -> None:
    """Draw D divided by Enskog's D against packing fraction, measured and for infinite size."""
    eta = largest.packing_fraction
    enskog = theory.enskog_diffusion(eta, 3)
    curve = np.linspace(0.0, 1.08 * eta.max(), 200)
    ratio, band = theory.erpenbeck_wood_ratio(curve), theory.ERPENBECK_WOOD_UNCERTAINTY
    axis.fill_between(curve, ratio * (1 - band), ratio * (1 + band), color=style.REFERENCE, alpha=0.2, lw=0)
    axis.plot(curve, ratio, color=style.REFERENCE, label=rf"Erpenbeck & Wood, $\pm{100.0 * band:g}\,\%$")
    axis.axhline(1.0, color=style.DATA, lw=0.8, label="Enskog")
    style.points(axis, eta, largest.diffusion / enskog, kind=1, hollow=True, label="finite container")
    style.points(axis, eta, infinite(largest) / enskog, color=style.DATA, label="infinite container")
    axis.set(xlim=(0.0, curve[-1]), ylim=(0.93, 1.72))
    style.label_axes(axis, r"packing fraction $\eta$", r"$D/D_\mathrm{Enskog}$", "upper right")


def _size(axis: Axes, sizes: Table) -> None:
    """Draw D_L against 1/L at one packing fraction, with fitted line and predicted slope.

    The prediction is by hydrodynamics.
    """
    if not sizes:
        axis.set_axis_off()
        return
    first, inverse = sizes[0], 1.0 / sizes.side
    x, eta = np.linspace(0.0, 1.15 * inverse.max(), 2), first.packing_fraction
    fit = sizes.size_intercept.value + sizes.size_slope.value * x
    axis.plot(x, fit, color=style.DATA, lw=0.8, label="fit")
    hydrodynamic = sizes.size_limit - first.correction * first.side * x
    axis.plot(x, hydrodynamic, color=style.REFERENCE, ls="--", label="Yeh & Hummer's slope")
    literature = float(theory.erpenbeck_wood_diffusion(eta)) * Estimate(
        [1.0], theory.ERPENBECK_WOOD_UNCERTAINTY
    )
    look: dict[str, Any] = {
        "color": style.REFERENCE,
        "marker": "s",
        "clip_on": False,
        "label": "Erpenbeck & Wood",
    }
    style.points(axis, [0.0], literature, **look)
    style.points(axis, inverse, sizes.diffusion, color=style.DATA, label=rf"$\eta={eta:g}$")
    for abscissa, size in zip(inverse, sizes, strict=True):
        at = (abscissa, size.diffusion.value)
        axis.annotate(f"{size.count:.0f}", at, (3, 5), textcoords="offset points")
    axis.set_xlim(0.0, x[-1])
    style.label_axes(axis, r"$\sigma/L$", r"$D_L\ (\sigma\sqrt{k_\mathrm{B}T/m})$", "upper right")


def _slopes(axis: Axes, long: Table) -> None:
    """Draw the slope of D(t) against ln t, by packing fraction, with mode-coupling theory.

    There are predictions for an infinite system, and for the modes that fit into the container.
    """
    eta = long.packing_fraction
    curve = np.linspace(0.5 * eta.min(), 1.1 * eta.max(), 100)
    axis.plot(curve, theory.logarithmic_slope(curve), color=style.REFERENCE, label="infinite system")
    predicted = long[np.isfinite(long.slope_expected)]
    look: dict[str, Any] = {"color": style.REFERENCE, "label": "modes of the container", "zorder": 4}
    axis.plot(predicted.packing_fraction, predicted.slope_expected, "x", **look)
    style.points(axis, eta, long.logarithmic_slope, color=style.DATA, label="measured")
    axis.set_ylim(0.0)
    slope = r"$\mathrm{d}D/\mathrm{d}\ln t\ (\sigma\sqrt{k_\mathrm{B}T/m})$"
    style.label_axes(axis, r"packing fraction $\eta$", slope, "lower left")


S = r"collisions per particle $s=\nu t$"


def velocity_autocorrelation(ds: xr.Dataset) -> Figure:
    """Draw C against collisions per particle, its start, and C - 1/N divided by the modes.

    The first panel has logarithmic axes.
    """
    figure, (upper, middle, lower) = style.new((2.6,), (2.0,), (2.2,))
    gases = Table(ds, "point")
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
        tail = theory.velocity_autocorrelation_tail(late.time, gas.packing_fraction, gas.dimension)
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
    """Draw C - 1/N divided by the sum of the container's modes, with its fit.

    A mark shows the time when sound has crossed the container.
    """
    style.level(axis, 1.0)
    for kind, gas in enumerate(gases):
        lags, share = _lags(gas), 1.0 / gas.count
        late = lags[lags.collisions > 5.0]
        state = gas.packing_fraction, gas.dimension, gas.count
        modes = theory.velocity_autocorrelation_modes(late.time, *state) - share
        axis.axvline(gas.sound, color=style.COLOURS[kind], linestyle=":", linewidth=0.8)
        ratio = (late.correlation - share) / modes
        style.points(axis, late.collisions, ratio, kind=kind, markersize=2.5)
        fitted = np.linspace(gas.tail_from, gas.tail_to, 50)
        curve = gas.tail_ratio.value + gas.tail_correction / fitted
        axis.plot(fitted, curve, color=style.COLOURS[kind])
    if gases:
        window = gases.tail_from.min(), gases.tail_to.max()
        axis.axvspan(*window, color=style.GREY, alpha=0.18, lw=0)
    axis.set(xscale="log", xlim=(5.0, 65.0), ylim=(0.4, 1.8))
    _integer_ticks(axis)
    style.label_axes(axis, S, "$(C-1/N)$ / modes")


def _integer_ticks(axis: Axes) -> None:
    low, high = axis.get_xlim()
    ticks = [tick for tick in (1, 2, 5, 10, 20, 40) if low <= tick <= high]
    axis.set_xticks(ticks, [str(tick) for tick in ticks])
    axis.minorticks_off()
