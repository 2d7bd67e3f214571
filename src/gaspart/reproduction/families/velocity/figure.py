"""The velocity autocorrelation: its tail, its start, and the ratio to the modes of the container."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.families.shared.claims import PARTICLES
from gaspart.reproduction.families.shared.rows import estimates


def velocity_autocorrelation(ds: xr.Dataset) -> Figure:
    """Three panels: C against collisions per particle, log-log; its start; C - 1/N over the modes."""
    figure, (upper, middle, lower) = style.new((2.6,), (2.0,), (2.2,))
    long = ds.isel(point=np.isfinite(ds["tail_ratio"].values)).sortby(["dimension", "packing_fraction"])
    _tails(upper, long)
    _starts(middle, ds.isel(point=np.isfinite(ds["start_rate"].values)))
    _ratios(lower, long)
    style.letters(upper, middle, lower)
    return figure


def _of(row: xr.Dataset) -> tuple[int, float, np.ndarray]:
    """Dimension, packing fraction, and the lags after 0 that the point has."""
    lags = np.flatnonzero(np.isfinite(row["correlation"].values))[1:]
    return int(row["dimension"]), float(row["packing_fraction"]), lags


def _tails(axis: Axes, ds: xr.Dataset) -> None:
    """Measured C, the initial exponentials exp(-2 s / d), and mode coupling's tails."""
    s = np.linspace(0.5, 9.0, 100)
    for dimension, line in ((2, "--"), (3, ":")):
        label = rf"$\mathrm{{e}}^{{-2s/{dimension}}}$"
        axis.plot(s, np.exp(-2.0 / dimension * s), color=style.GREY, linestyle=line, label=label)
    for kind in range(ds.sizes["point"]):
        row = ds.isel(point=kind)
        dimension, eta, lags = _of(row)
        at = row.isel(lag=lags)
        tail = theory.velocity_autocorrelation_tail(at["time"].values, eta, dimension)
        late = at["collisions"].values > 3.0
        axis.plot(at["collisions"].values[late], tail[late], color=style.COLOURS[kind], zorder=1)
        seen = at["correlation"].values > 0.0
        style.measured(
            axis,
            at["collisions"].values[seen],
            estimates(at, "correlation")[:, seen],
            kind,
            markersize=2.5,
            label=rf"{PARTICLES[dimension]}, $\eta={eta:.2g}$",
        )
    axis.plot([], [], color=style.DATA, label="mode coupling")
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlim(0.8, 65.0)
    axis.set_ylim(1e-3, 1.0)
    _integer_ticks(axis)
    axis.set_xlabel(r"collisions per particle $s=\nu t$")
    axis.set_ylabel(r"$C=\langle v(0)v(t)\rangle/\langle v^2\rangle$")
    axis.legend(loc="lower left")


def _starts(axis: Axes, ds: xr.Dataset) -> None:
    """ln C against collisions, and the exact initial slopes."""
    for kind in range(ds.sizes["point"]):
        row = ds.isel(point=kind)
        dimension, eta, lags = _of(row)
        at = row.isel(lag=lags[row["collisions"].values[lags] <= 2.0])
        s = np.linspace(0.0, 2.0, 50)
        axis.plot(s, np.exp(-2.0 / dimension * s), color=style.COLOURS[kind], zorder=1)
        label = rf"{PARTICLES[dimension]}, $\eta={eta:.2g}$"
        style.measured(axis, at["collisions"], estimates(at, "correlation"), kind, label=label)
    axis.set_yscale("log")
    axis.set_yticks((0.2, 0.5, 1.0), ("0.2", "0.5", "1"))
    axis.minorticks_off()
    axis.set_xlim(0.0, 2.0)
    axis.set_ylabel("$C$")
    axis.set_xlabel(r"collisions per particle $s=\nu t$")
    if ds.sizes["point"]:
        axis.legend(loc="upper right")


def _ratios(axis: Axes, ds: xr.Dataset) -> None:
    """C - 1/N over the sum of the container's modes with its fit; marked, when sound has crossed it."""
    style.level(axis, 1.0)
    for kind in range(ds.sizes["point"]):
        row = ds.isel(point=kind)
        dimension, eta, lags = _of(row)
        at = row.isel(lag=lags)
        s = at["collisions"].values
        shown, share = s > 5.0, 1.0 / float(row["count"])
        time = at["time"].values[shown]
        modes = theory.velocity_autocorrelation_modes(time, eta, dimension, int(row["count"])) - share
        axis.axvline(float(row["sound"]), color=style.COLOURS[kind], linestyle=":", linewidth=0.8)
        style.points(
            axis,
            s[shown],
            (at["correlation"].values[shown] - share) / modes,
            at["correlation_error"].values[shown] / modes,
            kind,
            markersize=2.5,
        )
        fitted = np.linspace(float(row["tail_from"]), float(row["tail_to"]), 50)
        curve = float(row["tail_ratio"]) + float(row["tail_correction"]) / fitted
        axis.plot(fitted, curve, color=style.COLOURS[kind])
    if ds.sizes["point"]:
        axis.axvspan(
            float(ds["tail_from"].min()), float(ds["tail_to"].max()), color=style.GREY, alpha=0.18, lw=0
        )
    axis.set_xscale("log")
    axis.set_xlim(5.0, 65.0)
    axis.set_ylim(0.4, 1.8)
    _integer_ticks(axis)
    axis.set_xlabel(r"collisions per particle $s=\nu t$")
    axis.set_ylabel("$C-1/N$ over modes")


def _integer_ticks(axis: Axes) -> None:
    low, high = axis.get_xlim()
    ticks = [tick for tick in (1, 2, 5, 10, 20, 40) if low <= tick <= high]
    axis.set_xticks(ticks, [str(tick) for tick in ticks])
    axis.minorticks_off()
