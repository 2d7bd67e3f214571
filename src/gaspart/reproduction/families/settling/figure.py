"""Figures about piles and flow through an orifice."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.shared.rows import estimates
from gaspart.theory.granular import DISCHARGE_EXPONENT


def settling(ds: xr.Dataset) -> Figure:
    """Four panels: energy and contacts of piles against time, the discs left in the hopper, the rate of
    flow."""
    figure, axes = style.new((2.4,), (2.4,), (2.4,), (2.4,))
    _piles(axes[0], axes[1], ds)
    _discs_left(axes[2], ds)
    _rates(axes[3], ds)
    style.letters(*axes)
    return figure


def _piles(energies: Axes, contacts: Axes, ds: xr.Dataset) -> None:
    """The first pile of each duration of contacts; a cross where all comes to rest."""
    style.level(contacts, 2.0)
    durations = ds["duration"].values
    for kind, duration in enumerate(np.unique(durations)):
        row = ds.isel(pile=int(np.flatnonzero(durations == duration)[0]))
        time, colour = row["time"].values, style.COLOURS[kind]
        moving = row["kinetic"].values > 0.0
        energies.plot(time[moving], row["kinetic"][moving], color=colour, label=rf"$t_c={duration:g}$")
        if np.isfinite(row["rest"]):
            energies.plot(time[moving][-1:], row["kinetic"][moving][-1:], color=colour, marker="x")
        contacts.plot(time, row["contacts"], color=colour)
    energies.set_yscale("log")
    energies.set_ylabel("kinetic energy of a disc")
    energies.legend(loc="upper right")
    contacts.set_ylabel("contacts per disc")
    contacts.set_ylim(0.0, 2.4)
    for axis in (energies, contacts):
        axis.set_xlim(0.0, float(ds["time"].max()))
        axis.set_xlabel(r"$t\,\sqrt{g/d}$")


def _discs_left(axis: Axes, ds: xr.Dataset) -> None:
    for kind in range(ds.sizes["orifice"]):
        row = ds.isel(orifice=kind)
        axis.plot(
            row["flow_time"],
            row["left"],
            color=style.COLOURS[kind],
            label=rf"$D={float(row['width']):.3g}\,d$",
        )
    axis.set_xlim(0.0, float(ds["flow_time"].max()))
    axis.set_ylim(0.0, 1.15 * float(ds["left"].max()))
    axis.set_xlabel(r"$t\,\sqrt{g/d}$")
    axis.set_ylabel("discs left in the hopper")
    axis.legend(loc="upper right")


def _rates(axis: Axes, ds: xr.Dataset) -> None:
    """The rate against the width less the fitted offset; Beverloo's law is a straight line."""
    offset, amplitude = float(ds["beverloo_offset"]), float(ds["beverloo_amplitude"])
    apart = ds["width"] - offset
    line = np.array([0.85 * float(apart.min()), 1.15 * float(apart.max())])
    axis.plot(
        line,
        amplitude * line**DISCHARGE_EXPONENT,
        color=style.REFERENCE,
        zorder=1,
        label="slope 3/2 (Beverloo)",
    )
    style.measured(axis, apart, estimates(ds, "rate"), color=style.DATA, label="measured")
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel(rf"$D/d-k$, $k={offset:.2f}$")
    axis.set_ylabel(r"rate of flow / $\sqrt{g/d}$")
    axis.legend(loc="upper left")
