"""Figures about driven granular gases."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.table import Table


def driven_gas(ds: xr.Dataset) -> Figure:
    """Draw steady temperature over the energy balance's, and fourth cumulant, against restitution."""
    figure, (upper, lower) = style.new((2.5,), (2.5,))
    table = Table(ds, "gas")
    curve = np.linspace(0.95 * table.restitution.min(), 1.0, 200)
    style.level(upper, 1.0)
    style.level(lower, 0.0)
    for kind, (dimension, gases) in enumerate(table.by("dimension")):
        e, name = gases.restitution, PARTICLES[dimension]
        balance = theory.driven_temperature(e, dimension, gases.power, gases.packing_fraction)
        style.points(upper, e, gases.temperature / balance, kind=kind, label=name)
        style.points(lower, e, gases.cumulant, kind=kind, label=name)
        for of, line in ((theory.driven_cumulant, "-"), (theory.fourth_cumulant, ":")):
            own = theory.finite_size_cumulant(of(curve, dimension), gases.count[0], dimension)
            lower.plot(curve, own, color=style.COLOURS[kind], linestyle=line, zorder=1)
    style.label_axes(upper, r"restitution $\epsilon$", r"$T$ / $T$ of energy balance")
    style.label_axes(lower, r"restitution $\epsilon$", r"fourth cumulant $a_2$", "upper right")
    style.letters(upper, lower)
    return figure
