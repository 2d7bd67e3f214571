"""Figures about driven granular gases."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.families.shared.claims import PARTICLES
from gaspart.reproduction.families.shared.rows import estimates


def driven_gas(ds: xr.Dataset) -> Figure:
    """Two panels over the restitution: steady temperature over the energy balance's, and fourth cumulant."""
    figure, (upper, lower) = style.new((2.5,), (2.5,))
    curve = np.linspace(0.95 * float(ds["restitution"].min()), 1.0, 200)
    style.level(upper, 1.0)
    style.level(lower, 0.0)
    for kind, dimension in enumerate(sorted(set(ds["dimension"].values.tolist()))):
        gases, name = ds.isel(gas=(ds["dimension"] == dimension).values), PARTICLES[dimension]
        e, power, count = gases["restitution"], gases["power"], int(gases["count"][0])
        unit = theory.driven_temperature(e.values, dimension, power.values, gases["packing_fraction"].values)
        style.measured(upper, e, estimates(gases, "temperature") / unit, kind, label=name)
        style.measured(lower, e, estimates(gases, "cumulant"), kind, label=name)
        colour = style.COLOURS[kind]
        for of, line in ((theory.driven_cumulant, "-"), (theory.fourth_cumulant, ":")):
            own = theory.finite_size_cumulant(of(curve, dimension), count, dimension)
            lower.plot(curve, own, color=colour, linestyle=line, zorder=1)
    upper.set_ylabel(r"$T$ / energy balance")
    lower.set_ylabel(r"fourth cumulant $a_2$")
    for axis in (upper, lower):
        axis.set_xlabel(r"restitution $\epsilon$")
    lower.legend(loc="upper right")
    style.letters(upper, lower)
    return figure
