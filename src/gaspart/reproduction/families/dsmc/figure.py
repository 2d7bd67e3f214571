"""Figure of the discretisation errors of the DSMC engine."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.table import Table
from gaspart.theory.discretisation import cell_factor, step_factor

QUANTITIES = {"viscosity": "viscosity", "conductivity": "heat conductivity", "diffusion": "self-diffusion"}
FINE = {"width": 0.3, "step": 0.3}
"""Width of cells and length of steps below which one effect is too small to hide the other."""


def dsmc_convergence(dataset: xr.Dataset) -> Figure:
    """Draw transport coefficients against cells and steps, flux between plates, and dense gas."""
    figure, axes = style.new((2.4,), (2.4,), (2.4,), (2.4,))
    cells, steps, plates, dense = axes
    gases = Table(dataset, "point")
    _coarse(cells, gases, "width", "step")
    style.label_axes(cells, r"width of a cell $w/\lambda$")
    _coarse(steps, gases, "step", "width")
    style.label_axes(steps, r"time step $\sqrt{2k_\mathrm{B}T/m}\,\Delta t/\lambda$")
    _plates(plates, gases)
    _dense(dense, gases[gases.part == "dense"], gases[gases.part == "event_paths"])
    style.letters(*axes)
    return figure


def _coarse(axis: Axes, gases: Table, along: str, other: str) -> None:
    """Draw transport coefficients over exact values, against cell width or time step.

    Points are drawn only if their `other` discretisation is fine. The effect of the `other` discretisation is
    removed. The curve is theory.
    """
    factors = {"width": cell_factor, "step": step_factor}
    fine = gases[getattr(gases, other) < FINE[other]]
    curve = np.linspace(0.0, 1.08 * np.nanmax(getattr(gases, along)), 200)
    for kind, (quantity, title) in enumerate(QUANTITIES.items()):
        own = fine[np.isfinite(getattr(fine, quantity).value)]
        ratio = getattr(own, quantity) / factors[other](quantity, getattr(own, other))
        style.points(axis, getattr(own, along), ratio, kind=kind, label=title)
        axis.plot(curve, factors[along](quantity, curve), color=style.COLOURS[kind], lw=0.8)
    if along == "width":
        own = fine[np.isfinite(fine.transfer.value)]
        style.points(axis, own.width, 1.0 + own.transfer, hollow=True, label="1 + transfer")
    predicted = "predicted, first order" if along == "width" else "predicted"
    axis.plot([], [], color=style.GREY, lw=0.8, label=predicted)
    style.label_axes(axis, y="ratio to the exact value", legend="upper left", xlim=(0.0, None))


def _plates(axis: Axes, gases: Table) -> None:
    """Draw the flux divided by the flux of free flight, against the Knudsen number."""
    for kind, (part, title) in enumerate({"event_plates": "event-driven", "plates": "DSMC"}.items()):
        own = gases[gases.part == part]
        style.points(axis, own.knudsen, own.flux, kind=kind, hollow=kind == 1, label=title)
    axis.axhline(1.0, color=style.GREY, lw=0.8, label="free flight")
    axis.set(xscale="log", yscale="log")
    style.label_axes(
        axis, r"Knudsen number $\lambda/L$", "heat flux / free-flight flux", legend="lower right"
    )


def _dense(axis: Axes, model: Table, spheres: Table) -> None:
    """Draw the dense-gas model and hard spheres, divided by Enskog theory."""
    eta = model.packing_fraction
    style.points(axis, eta - 0.004, model.excess, kind=0, label="$Z-1$, DSMC")
    style.points(axis, eta, model.rate, kind=1, label="collision rate, DSMC")
    style.points(axis, eta + 0.004, model.diffusion, kind=2, label="self-diffusion, DSMC")
    label = "self-diffusion, event-driven"
    style.points(axis, spheres.packing_fraction, spheres.diffusion, kind=2, hollow=True, label=label)
    curve = np.linspace(0.0, 0.42, 100)
    ratio = theory.erpenbeck_wood_ratio(curve)
    axis.plot(curve, ratio, color=style.GREY, lw=0.8, label="Erpenbeck & Wood")
    axis.axhline(1.0, color=style.GREY, lw=0.8, ls=":")
    room = (0.95, 1.7)  # an empty curve for the legend
    style.label_axes(
        axis, r"packing fraction $\eta$", "ratio to Enskog's theory", legend="upper left", ylim=room
    )
