"""Figures of piles at rest, discharge and vibrated beds."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.beds.claims import (
    WAVEFORMS,
    expected_temperature,
    extrapolation,
    small_parameter,
)
from gaspart.reproduction.table import Table
from gaspart.theory.granular import DISCHARGE_EXPONENT

TIME = r"time $t\,\sqrt{g/d}$"


def settling(dataset: xr.Dataset) -> Figure:
    """Draw energy and contacts of piles, discs that remain in the hopper, and flow rates."""
    figure, axes = style.new((2.4,), (2.4,), (2.4,), (2.4,))
    piles, flows = Table(dataset, "pile"), Table(dataset, "orifice")
    _piles(axes[0], axes[1], piles)
    _discs_left(axes[2], flows)
    _rates(axes[3], flows)
    style.letters(*axes)
    return figure


def _piles(energies: Axes, contacts: Axes, piles: Table) -> None:
    """Draw the first pile of each contact duration; a cross marks the time of rest."""
    style.level(contacts, 2.0)
    for kind, (duration, alike) in enumerate(piles.by("duration")):
        pile, colour = alike[0], style.COLOURS[kind]
        moving = pile.kinetic > 0.0
        time, kinetic = pile.time[moving], pile.kinetic[moving]
        energies.plot(time, kinetic, color=colour, label=rf"$t_c={duration:g}$")
        if np.isfinite(pile.rest):
            energies.plot(time[-1:], kinetic[-1:], color=colour, marker="x")
        contacts.plot(pile.time, pile.contacts, color=colour)
    energies.set_yscale("log")
    limits = 0.0, np.nanmax(piles.time)
    style.label_axes(energies, TIME, "kinetic energy per disc ($mgd$)", "upper right", xlim=limits)
    style.label_axes(contacts, TIME, "contacts per disc", xlim=limits, ylim=(0.0, 2.4))


def _discs_left(axis: Axes, flows: Table) -> None:
    for kind, flow in enumerate(flows):
        label = rf"$D={flow.width:.3g}\,d$"
        axis.plot(flow.flow_time, flow.left, color=style.COLOURS[kind], label=label)
    style.label_axes(
        axis, TIME, "discs left in the hopper", "upper right",
        xlim=(0.0, np.nanmax(flows.flow_time)), ylim=(0.0, 1.15 * np.nanmax(flows.left)),
    )  # fmt: skip


def _rates(axis: Axes, flows: Table) -> None:
    """Draw the flow rate against the width of the orifice minus the fitted offset.

    Beverloo's law is a straight line.
    """
    offset = flows.beverloo_offset
    apart = flows.width - offset
    line = np.array([0.85 * apart.min(), 1.15 * apart.max()])
    law = flows.beverloo_amplitude * line**DISCHARGE_EXPONENT
    axis.plot(line, law, color=style.REFERENCE, zorder=1, label="slope 3/2 (Beverloo)")
    style.points(axis, apart, flows.rate, color=style.DATA, label="measured")
    axis.set(xscale="log", yscale="log")
    style.label_axes(axis, rf"$D/d-k$, $k={offset:.2f}$", r"rate of flow / $\sqrt{g/d}$", "upper left")


def vibrated_bed(dataset: xr.Dataset) -> Figure:
    """Draw temperature divided by theory, with fits, and density of the most elastic beds."""
    figure, (upper, lower) = style.new((2.4,), (2.4,))
    table = Table(dataset, "bed")
    style.level(upper, 1.0)
    heights = np.linspace(0.0, table.place.max(), 100)
    lower.plot(heights, np.exp(-heights), color=style.REFERENCE, label=r"$e^{-gz/T}$")
    for kind, name in WAVEFORMS.items():
        beds = table[table.sine == kind]
        if not beds:
            continue
        x = small_parameter(beds)
        style.points(upper, x, beds.temperature / expected_temperature(beds), kind=kind, label=name)
        if x.size > 2:
            fine = np.linspace(0.0, x.max(), 100)
            curve = np.polynomial.polynomial.polyval(fine, extrapolation(beds).values)
            upper.plot(fine, curve, color=style.COLOURS[kind], zorder=1)
        bed = beds[np.argmin(x)]
        label = rf"{name}, $\epsilon={bed.restitution:g}$"
        style.points(lower, bed.place, bed.density, kind=kind, label=label)
    upper.set_xlim(0.0, 1.08 * small_parameter(table).max())
    small = r"$(1-\epsilon^2)(\sqrt{\pi}\,(N-1)d/2W+1/\sqrt{2\pi})$"
    style.label_axes(upper, small, r"$T$ / $T$ of energy balance", "best")
    lower.set_yscale("log")
    style.label_axes(lower, r"height $gz/T$", r"density / $(Ng/WT)$", "best")
    style.letters(upper, lower)
    return figure
