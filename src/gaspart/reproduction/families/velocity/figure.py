"""The velocity autocorrelation: its tail, its start, and the ratio to the modes of the container."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.table import Row, Table

S = r"collisions per particle $s=\nu t$"


def velocity_autocorrelation(ds: xr.Dataset) -> Figure:
    """Draw C against collisions per particle, its start, and C - 1/N over the modes.

    The first panel is log-log.
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
    """Return the lags after 0 that a gas has."""
    lags = Table(gas.dataset, "lag")
    return lags[np.isfinite(lags.correlation.value)][1:]


def _tails(axis: Axes, gases: Table) -> None:
    """Draw measured C, the initial exponentials exp(-2 s / d), and mode coupling's tails."""
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
    """Draw C - 1/N over the sum of the container's modes, with its fit.

    The time when sound has crossed it is marked.
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
