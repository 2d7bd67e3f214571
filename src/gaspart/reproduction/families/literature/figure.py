"""Figure of our values divided by values of others."""

from __future__ import annotations

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.literature.claims import EQUILIBRIUM
from gaspart.reproduction.table import Table

LABELS = {
    "Z": "$Z$, fluid of spheres",
    "Z_crystal": "$Z$, crystal of spheres",
    "pressure": "$P$, 870 discs",
    "diffusion": "$D$ of spheres",
    "viscosity": "viscosity of spheres",
    "conductivity": "heat conductivity of spheres",
}


def literature(dataset: xr.Dataset) -> Figure:
    """Draw ratios to the values of others, less 1: pressures, and transport coefficients."""
    figure, (static, transport) = style.new((2.4,), (2.4,))
    values = Table(dataset, "value")
    for axis, is_static in ((static, True), (transport, False)):
        _ratios(axis, values[[(quantity in EQUILIBRIUM) == is_static for quantity in values.quantity]])
    style.letters(static, transport)
    return figure


def _ratios(axis: Axes, values: Table) -> None:
    """Draw our values as points with their errors, others' as wide pale bars about 0."""
    style.level(axis, 0.0)
    for kind, (name, label) in enumerate(LABELS.items()):
        part = values[values.quantity == name]
        if not part:
            continue
        eta, theirs = part.packing_fraction, part.theirs.value
        error = 100.0 * part.theirs.error / theirs
        axis.errorbar(
            eta,
            0.0 * eta,
            error,
            linestyle="none",
            color=style.COLOURS[kind],
            elinewidth=4.0,
            capsize=0.0,
            alpha=0.35,
        )
        style.points(axis, eta, 100.0 * (part.ours / theirs - 1.0), kind=kind, label=label)
    style.label_axes(axis, r"packing fraction $\eta$", "ours / published $-1$  (%)", legend="best")
