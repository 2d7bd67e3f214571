"""Figures about vibrated granular beds."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.vibrated.claims import (
    WAVEFORMS,
    expected_temperature,
    extrapolation,
    small_parameter,
)
from gaspart.reproduction.table import Table


def vibrated_bed(dataset: xr.Dataset) -> Figure:
    """Draw temperature over theory's, with fits, and density of the most elastic beds."""
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
