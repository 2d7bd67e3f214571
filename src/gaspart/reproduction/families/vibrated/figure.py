"""Figures about vibrated granular beds."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.shared.rows import estimates
from gaspart.reproduction.families.vibrated.claims import (
    WAVEFORMS,
    expected_temperature,
    extrapolation,
    small_parameter,
)


def vibrated_bed(ds: xr.Dataset) -> Figure:
    """Two panels: temperature over theory's, with fits, and density profiles of the most elastic beds."""
    figure, (upper, lower) = style.new((2.4,), (2.4,))
    style.level(upper, 1.0)
    heights = np.linspace(0.0, float(ds["place"].max()), 100)
    lower.plot(heights, np.exp(-heights), color=style.REFERENCE, label=r"$e^{-gz/T}$")
    for kind, name in WAVEFORMS.items():
        beds = ds.isel(bed=(ds["sine"] == kind).values)
        if not beds.sizes["bed"]:
            continue
        x, unit = small_parameter(beds), expected_temperature(beds)
        style.measured(upper, x, estimates(beds, "temperature") / unit, kind, label=name)
        if x.size > 2:
            fine = np.linspace(0.0, x.max(), 100)
            curve = np.polynomial.polynomial.polyval(fine, extrapolation(beds).values)
            upper.plot(fine, curve, color=style.COLOURS[kind], zorder=1)
        bed = beds.isel(bed=int(np.argmin(x)))
        e = float(bed["restitution"])
        label = rf"{name}, $\epsilon={e:g}$"
        style.measured(lower, bed["place"], estimates(bed, "density"), kind, label=label)
    upper.set_xlim(0.0, 1.08 * small_parameter(ds).max())
    upper.set_xlabel(r"$(1-\epsilon^2)(\sqrt{\pi}\,(N-1)d/2W+1/\sqrt{2\pi})$")
    upper.set_ylabel(r"$T$ / energy balance")
    upper.legend()
    lower.set_yscale("log")
    lower.set_xlabel(r"height $gz/T$")
    lower.set_ylabel(r"density / $(Ng/WT)$")
    lower.legend()
    style.letters(upper, lower)
    return figure
