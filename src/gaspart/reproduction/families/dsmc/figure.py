"""Figure of the errors of the DSMC engine."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.families.shared.rows import estimates
from gaspart.theory.dsmc import cell_factor, step_factor

QUANTITIES = {"viscosity": "viscosity", "conductivity": "heat conductivity", "diffusion": "self-diffusion"}
FINE = {"width": 0.3, "step": 0.3}
"""Of cells and steps, whose effect is so small that the other one is seen."""


def dsmc_convergence(ds: xr.Dataset) -> Figure:
    """Transport coefficients against the width of cells and the length of steps; the flux between plates; the
    dense gas."""
    figure, axes = style.new((2.4,), (2.4,), (2.4,), (2.4,))
    cells, steps, plates, dense = axes
    _coarse(cells, ds, "width", "step")
    cells.set_xlabel(r"width of a cell $w/\lambda$")
    _coarse(steps, ds, "step", "width")
    steps.set_xlabel(r"time step $\sqrt{2k_\mathrm{B}T/m}\,\Delta t/\lambda$")
    _plates(plates, ds)
    _dense(dense, ds)
    style.letters(*axes)
    return figure


def _coarse(axis: Axes, ds: xr.Dataset, along: str, other: str) -> None:
    """Each coefficient over its exact value, where the `other` coarseness is fine, without its effect, and
    theory's curve."""
    factors = {"width": cell_factor, "step": step_factor}
    fine = ds[other].values < FINE[other]
    for kind, (quantity, title) in enumerate(QUANTITIES.items()):
        chosen = ds.isel(point=np.flatnonzero(np.isfinite(ds[quantity].values) & fine))
        rest = factors[other](quantity, chosen[other].values)
        style.measured(axis, chosen[along], estimates(chosen, quantity) / rest, kind, label=title)
        x = np.linspace(0.0, 1.08 * float(ds[along].max()), 200)
        axis.plot(x, factors[along](quantity, x), color=style.COLOURS[kind], lw=0.8)
    if along == "width":
        chosen = ds.isel(point=np.flatnonzero(np.isfinite(ds["transfer"].values) & fine))
        value, error = estimates(chosen, "transfer")
        style.points(axis, chosen[along], 1.0 + value, error, kind=0, hollow=True, label="1 + transfer")
    predicted = "predicted, first order" if along == "width" else "predicted"
    axis.plot([], [], color=style.GREY, lw=0.8, label=predicted)
    axis.set_xlim(0.0)
    axis.set_ylabel("over the exact value")
    axis.legend(loc="upper left")


def _plates(axis: Axes, ds: xr.Dataset) -> None:
    """The flux over that of free flight, against the Knudsen number."""
    for kind, (part, title) in enumerate({"event_plates": "event-driven", "plates": "DSMC"}.items()):
        chosen = ds.isel(point=np.flatnonzero(ds["part"].values == part))
        flux = estimates(chosen, "flux")
        style.measured(axis, chosen["knudsen"], flux, kind, hollow=kind == 1, label=title)
    axis.axhline(1.0, color=style.GREY, lw=0.8, label="free flight")
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel(r"Knudsen number $\lambda/L$")
    axis.set_ylabel("heat flux over free flight's")
    axis.legend(loc="lower right")


def _dense(axis: Axes, ds: xr.Dataset) -> None:
    """The Enskog model over Enskog's theory, and what spheres do."""
    model = ds.isel(point=np.flatnonzero(ds["part"].values == "dense"))
    eta = model["packing_fraction"].values
    names = {"excess": "$Z-1$", "rate": "collision rate", "diffusion": "diffusion"}
    for kind, (name, title) in enumerate(names.items()):
        at = eta + 0.004 * (kind - 1)
        style.measured(axis, at, estimates(model, name), kind, label=f"{title}, DSMC")
    spheres = ds.isel(point=np.flatnonzero(ds["part"].values == "event_paths"))
    values = estimates(spheres, "diffusion")
    style.measured(axis, spheres["packing_fraction"], values, 2, hollow=True, label="diffusion, event-driven")
    curve = np.linspace(0.0, 0.42, 100)
    ratio = theory.erpenbeck_wood_ratio(curve)
    axis.plot(curve, ratio, color=style.GREY, lw=0.8, label="Erpenbeck & Wood")
    axis.axhline(1.0, color=style.GREY, lw=0.8, ls=":")
    axis.set_xlabel(r"packing fraction $\eta$")
    axis.set_ylim(0.95, 1.7)  # with room for the legend
    axis.set_ylabel("over Enskog's")
    axis.legend(loc="upper left")
