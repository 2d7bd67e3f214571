"""Figures of the mean-squared displacement and of diffusion."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.families.shared.rows import estimates


def msd_spheres(ds: xr.Dataset) -> Figure:
    """The msd; D(t) from displacements and from velocities; D against packing fraction; D against 1/L."""
    figure, axes = style.new((2.4,), (2.4,), (2.3,), (2.3,))
    _displacement(axes[0], ds, 3)
    _running(axes[1], ds.isel(point=_shown(ds, ds["largest"].values)), 3)
    _density(axes[2], ds)
    _size(axes[3], ds)
    style.letters(*axes)
    return figure


def msd_discs(ds: xr.Dataset) -> Figure:
    """The msd; D(t), which does not converge; its slope against ln t, by packing fraction."""
    figure, axes = style.new((2.6,), (2.2,), (2.2,))
    long = np.isfinite(ds["logarithmic_slope"].values)
    _displacement(axes[0], ds, 2)
    _running(axes[1], ds, 2)
    _slopes(axes[2], ds.isel(point=long))
    style.letters(*axes)
    return figure


def _fractions(ds: xr.Dataset) -> np.ndarray:
    """The packing fractions with finely sampled runs: those whose curves are drawn from the start."""
    return np.unique(ds["packing_fraction"].values[np.isfinite(ds["integral_difference"].values)].round(6))


def _shown(ds: xr.Dataset, long: np.ndarray) -> np.ndarray:
    """Points of those packing fractions: the finely sampled run, and the long one."""
    return np.isin(ds["packing_fraction"].values.round(6), _fractions(ds)) & (
        long | np.isfinite(ds["integral_difference"].values)
    )


def _spread(first: int, last: int) -> np.ndarray:
    """Indices from first to last - 1, about eight in each decade."""
    number = int(np.ceil(8.0 * np.log10(last / first))) + 1
    return np.unique(np.geomspace(first, max(last - 1, first), number).round().astype(int))


def _pieces(ds: xr.Dataset, eta: float) -> Iterator[tuple[xr.Dataset, np.ndarray]]:
    """(row, lags) of one packing fraction: the finely sampled run, then the long ones."""
    chosen = ds.isel(point=np.flatnonzero(np.isclose(ds["packing_fraction"], eta, atol=1e-5)))
    rows = [chosen.isel(point=point) for point in np.argsort(chosen["interval"].values, kind="stable")]
    ends = [float(row["time"][1]) for row in rows[1:]] + [np.inf]
    begin = 0.0
    for row, end in zip(rows, ends, strict=True):
        time = row["time"].values
        lags = np.flatnonzero((time > begin) & (time < end))
        if lags.size:
            begin = time[lags[-1]]
            yield row, _spread(lags[0], lags[-1] + 1)


def _displacement(axis: Axes, ds: xr.Dataset, dimension: int) -> None:
    """The msd against time, both in reduced units, with Enskog's curves and the ballistic limit."""
    longest = 0.0
    for kind, eta in enumerate(_fractions(ds)):
        for number, (row, lags) in enumerate(_pieces(ds, eta)):
            at = row.isel(lag=lags)
            label = rf"$\eta={eta:g}$" if number == 0 else None
            style.measured(axis, at["time"], estimates(at, "msd"), kind=kind, hollow=True, label=label)
            longest = max(longest, float(at["time"].max()))
        time = np.geomspace(float(ds["time"].isel(lag=1).min()), longest, 200)
        curve = theory.enskog_mean_squared_displacement(time, eta, dimension)
        axis.loglog(time, curve, color=style.COLOURS[kind], lw=0.8)
    top = axis.get_ylim()[1]
    axis.plot(
        time, dimension * time**2, color=style.DATA, ls="--", lw=0.8, label=rf"ballistic ${dimension}t^2$"
    )
    axis.plot([], [], color=style.GREY, lw=0.8, label="Enskog")
    axis.set_ylim(top=top)
    axis.set_xlabel(r"time $t\ (\sigma\sqrt{m/k_\mathrm{B}T})$")
    axis.set_ylabel(r"$\langle|\Delta\mathbf{r}|^2\rangle\ (\sigma^2)$")
    axis.legend(loc="lower right")


def _running(axis: Axes, ds: xr.Dataset, dimension: int) -> None:
    """D(t), half the msd's slope over d, over Enskog's D: displacements as points, velocities as lines."""
    fractions = np.unique(ds["packing_fraction"].values.round(6))
    axis.set_xscale("log")
    for kind, eta in enumerate(fractions):
        enskog = float(theory.enskog_diffusion(eta, dimension))
        rate = float(theory.collision_rate(eta, dimension))
        for number, (row, lags) in enumerate(_pieces(ds, eta)):
            at = row.isel(lag=lags)
            label = rf"$\eta={eta:g}$" if number == 0 else None
            running = estimates(at, "running") / enskog
            style.measured(axis, rate * at["time"], running, kind=kind, hollow=True, label=label)
            integral = row["integral"].dropna("lag")
            if integral.size:
                until = row["time"].values[1 : integral.size]
                axis.plot(rate * until, integral.values[1:] / enskog, color=style.COLOURS[kind], lw=0.8)
            elif dimension == 2:
                _predicted(axis, row, eta, rate, enskog, kind)
    x = np.geomspace(*axis.get_xlim(), 200)
    enskog, rate = (
        float(function(fractions[0], dimension))
        for function in (theory.enskog_diffusion, theory.collision_rate)
    )
    decay = 1.0 / (enskog * rate)  # per collision: the same at every packing fraction
    axis.plot(x, -np.expm1(-decay * x), color=style.DATA, lw=0.8, label="Enskog", zorder=1)
    axis.plot([], [], color=style.GREY, lw=0.8, label="Green-Kubo")
    if dimension == 2:
        axis.plot([], [], color=style.GREY, lw=1.6, alpha=0.5, label="mode coupling")
    axis.set_ylim(0.0)
    axis.set_xlabel(r"collisions per particle $\nu t$")
    axis.set_ylabel(r"$D(t)/D_\mathrm{Enskog}$")
    axis.legend(loc="lower right", ncols=1 + (len(fractions) > 3))


def _predicted(axis: Axes, row: xr.Dataset, eta: float, rate: float, enskog: float, kind: int) -> None:
    """The logarithm's predicted slope over the fitted interval, through D(t) in its middle."""
    ends = np.array([float(row["fit_from"]), float(row["fit_to"])])
    middle = np.sqrt(ends.prod())
    height = np.interp(middle, row["time"].dropna("lag"), row["running"].dropna("lag"))
    values = height + float(theory.logarithmic_slope(eta)) * np.log(ends / middle)
    axis.plot(rate * ends, values / enskog, color=style.COLOURS[kind], lw=1.6, alpha=0.5, zorder=2)


def _density(axis: Axes, ds: xr.Dataset) -> None:
    """D over Enskog's against packing fraction, as measured and corrected for the container's size."""
    row = ds.isel(point=ds["largest"].values).sortby("packing_fraction")
    eta = row["packing_fraction"].values
    enskog = theory.enskog_diffusion(eta, 3)
    curve = np.linspace(0.0, 1.08 * eta.max(), 200)
    ratio, band = theory.erpenbeck_wood_ratio(curve), theory.ERPENBECK_WOOD_UNCERTAINTY
    axis.fill_between(curve, ratio * (1 - band), ratio * (1 + band), color=style.REFERENCE, alpha=0.2, lw=0)
    axis.plot(curve, ratio, color=style.REFERENCE, label=rf"Erpenbeck & Wood, $\pm{100.0 * band:g}\,\%$")
    axis.axhline(1.0, color=style.DATA, lw=0.8, label="Enskog")
    raw, error = estimates(row, "diffusion") / enskog
    both = np.hypot(row["diffusion_error"], row["correction_uncertainty"]) / enskog
    style.points(axis, eta, raw, error, kind=1, hollow=True, label="as measured")
    style.points(
        axis, eta, raw + row["correction"] / enskog, both, color=style.DATA, label="infinite container"
    )
    axis.set_xlim(0.0, curve[-1])
    axis.set_xlabel(r"packing fraction $\eta$")
    axis.set_ylabel(r"$D/D_\mathrm{Enskog}$")
    axis.set_ylim(0.93, 1.72)
    axis.legend(loc="upper right")


def _size(axis: Axes, ds: xr.Dataset) -> None:
    """D_L against 1/L at one packing fraction: the fitted line, and the slope that hydrodynamics predicts."""
    row = ds.isel(point=ds["in_series"].values)
    if not row.sizes["point"]:
        axis.set_axis_off()
        return
    inverse = 1.0 / row["side"].values
    x = np.linspace(0.0, 1.15 * inverse.max(), 2)
    start = float(ds["size_intercept"])
    predicted = -float((row["correction"] * row["side"])[0])
    axis.plot(x, start + float(ds["size_slope"]) * x, color=style.DATA, lw=0.8, label="fit")
    axis.plot(
        x,
        float(ds["size_limit"]) + predicted * x,
        color=style.REFERENCE,
        ls="--",
        label="Yeh & Hummer's slope",
    )
    eta = float(row["packing_fraction"][0])
    known, band = float(theory.erpenbeck_wood_diffusion(eta)), theory.ERPENBECK_WOOD_UNCERTAINTY
    style.points(
        axis,
        [0.0],
        [known],
        [band * known],
        color=style.REFERENCE,
        marker="s",
        clip_on=False,
        label="Erpenbeck & Wood",
    )
    style.measured(axis, inverse, estimates(row, "diffusion"), color=style.DATA, label=rf"$\eta={eta:g}$")
    for one, count, value in zip(inverse, row["count"].values, row["diffusion"].values, strict=True):
        axis.annotate(f"{int(count)}", (one, value), (3, 5), textcoords="offset points")
    axis.set_xlim(0.0, x[-1])
    axis.set_xlabel(r"$\sigma/L$")
    axis.set_ylabel(r"$D_L\ (\sigma\sqrt{k_\mathrm{B}T/m})$")
    axis.legend(loc="upper right")


def _slopes(axis: Axes, ds: xr.Dataset) -> None:
    """Slope of D(t) against ln t over packing fraction, with mode coupling's: of an infinite system, and of
    the modes that fit into the container."""
    row = ds.sortby("packing_fraction")
    eta = row["packing_fraction"].values
    curve = np.linspace(0.5 * eta.min(), 1.1 * eta.max(), 100)
    axis.plot(curve, theory.logarithmic_slope(curve), color=style.REFERENCE, label="infinite system")
    known = row.isel(point=np.isfinite(row["slope_expected"].values))
    axis.plot(
        known["packing_fraction"],
        known["slope_expected"],
        "x",
        color=style.REFERENCE,
        label="this container",
        zorder=4,
    )
    style.measured(axis, eta, estimates(row, "logarithmic_slope"), color=style.DATA, label="measured")
    axis.set_ylim(0.0)
    axis.set_xlabel(r"packing fraction $\eta$")
    axis.set_ylabel(r"$\mathrm{d}D/\mathrm{d}\ln t\ (\sigma\sqrt{k_\mathrm{B}T/m})$")
    axis.legend(loc="lower left")
