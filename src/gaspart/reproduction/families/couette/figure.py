"""Figure of gases between sliding walls."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.families.couette.claims import DILUTE_SLIP, FAST, FREE, SLIP_FLOW
from gaspart.reproduction.families.shared.rows import estimates
from gaspart.theory.shear import ELEMENTARY_SLIP, NORMAL_STRESSES, VELOCITY_SLIP

DSMC, EVENT = "DSMC", "event-driven"


def couette(ds: xr.Dataset) -> Figure:
    """Profiles of velocity and temperature; the stress by the Knudsen number; viscosity, slip and normal
    stresses."""
    figure, axes = style.new(*[(2.4,)] * 6)
    flows = ds.isel(point=np.flatnonzero(ds["part"].values == "flows"))
    _velocity(axes[0], flows)
    _temperature(axes[1], flows)
    _stress(axes[2], flows)
    _viscosity(axes[3], ds)
    _slip(axes[4], flows)
    _normal(axes[5], flows)
    style.letters(*axes)
    return figure


def _some(flows: xr.Dataset, chosen: np.ndarray) -> xr.Dataset:
    return flows.isel(point=np.flatnonzero(chosen))


def _velocity(axis: Axes, flows: xr.Dataset) -> None:
    """The velocity across the gap: free flight, a dilute and a dense gas."""
    slow = flows["speed"].values < FAST
    kinds = {
        "free flight": slow & (flows["knudsen"].values > FREE),
        "dilute": slow
        & (flows["knudsen"].values < SLIP_FLOW)
        & (flows["packing_fraction"].values < DILUTE_SLIP),
        "dense": slow & (flows["packing_fraction"].values > DILUTE_SLIP),
    }
    line = np.array([-0.5, 0.5])
    axis.plot(line, line, color=style.GREY, lw=0.8, label="no slip")
    for kind, (name, chosen) in enumerate(kinds.items()):
        if chosen.any():
            one = flows.isel(point=np.flatnonzero(chosen)[-1])
            value, error = estimates(one, "flow")
            style.points(axis, one["place"], value, error, kind=kind, label=name)
            if name == "dilute":
                slope = 1.0 / (1.0 + 2.0 * VELOCITY_SLIP * float(one["knudsen"]))
                axis.plot(line, slope * line, color=style.COLOURS[kind], lw=0.8)
    axis.set_xlabel("place in the gap $x/L$")
    axis.set_ylabel("velocity of the gas $u/U$")
    axis.legend(loc="upper left")


def _temperature(axis: Axes, flows: xr.Dataset) -> None:
    """The temperature against the square of the velocity, with the slope of viscous heating."""
    wide = flows["knudsen"].values < SLIP_FLOW
    for kind, (name, chosen) in enumerate(
        {"fast walls": flows["speed"].values > FAST, "slow walls": flows["speed"].values < FAST}.items()
    ):
        row = _some(flows, wide & chosen & (flows["engine"].values == DSMC))
        if row.sizes["point"]:
            one = row.isel(point=0)
            square = (float(one["speed"]) * one["flow"].values) ** 2
            value, error = estimates(one, "temperature")
            style.points(axis, square, value, error, kind=kind, label=name)
            slope, reach = float(theory.viscous_heating(0.0, 3)), np.array([0.0, square.max()])
            top = value[np.argmin(square)]
            axis.plot(reach, top - slope * reach, color=style.COLOURS[kind], lw=0.8)
    axis.set_xlabel(r"squared velocity of the gas $u^2$")
    axis.set_ylabel("temperature over the walls'")
    axis.legend(loc="upper right")


def _stress(axis: Axes, flows: xr.Dataset) -> None:
    """The shear stress over that of free flight by the Knudsen number."""
    for kind, engine in enumerate((DSMC, EVENT)):
        dilute = (flows["engine"].values == engine) & (flows["packing_fraction"].values < DILUTE_SLIP)
        row = _some(flows, dilute & (flows["speed"].values < FAST))
        style.measured(axis, row["knudsen"], estimates(row, "stress"), kind, hollow=kind == 1, label=engine)
    knudsen = np.geomspace(0.02, 0.5, 50)
    density = 1.0 / (np.sqrt(2.0) * np.pi)  # of spheres of diameter 1 whose mean free path is 1
    slip = theory.slip_flow_stress(1.0 / knudsen, density, 1.0) / theory.free_molecular_stress(density, 1.0)
    axis.plot(knudsen, slip, color=style.GREY, lw=0.8, label="viscous, with slip")
    axis.axhline(1.0, color=style.GREY, lw=0.8, ls=":", label="free flight")
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel(r"Knudsen number $\lambda/L$")
    axis.set_ylabel("stress over free flight's")
    axis.legend(loc="lower right")


def _viscosity(axis: Axes, ds: xr.Dataset) -> None:
    """The viscosity over Enskog's by density, from the response and from equilibrium."""
    wide = (ds["knudsen"].values < SLIP_FLOW) & (ds["speed"].values < FAST)
    for kind, engine in enumerate((DSMC, EVENT)):
        row = _some(ds, wide & (ds["engine"].values == engine) & (ds["part"].values == "flows"))
        label = f"response, {engine}"
        style.measured(axis, row["packing_fraction"], estimates(row, "viscosity"), kind, label=label)
    uniform = _some(ds, ds["part"].values == "sheared")
    values = estimates(uniform, "viscosity")
    style.measured(axis, uniform["packing_fraction"] - 0.005, values, 3, label="response, without walls")
    still = _some(ds, ds["part"].values == "equilibrium")
    values = estimates(still, "viscosity")
    style.measured(axis, still["packing_fraction"] + 0.005, values, 2, hollow=True, label="Green-Kubo")
    axis.axhline(1.0, color=style.GREY, lw=0.8, label="Enskog")
    axis.set_xlabel(r"packing fraction $\phi$")
    axis.set_ylabel(r"$\eta/\eta_\mathrm{Enskog}$")
    axis.legend(loc="upper left")


def _slip(axis: Axes, flows: xr.Dataset) -> None:
    """The slip in mean free paths by density."""
    wide = (flows["knudsen"].values < SLIP_FLOW) & (flows["speed"].values < FAST)
    for kind, engine in enumerate((DSMC, EVENT)):
        row = _some(flows, wide & (flows["engine"].values == engine))
        style.measured(axis, row["packing_fraction"], estimates(row, "slip"), kind, label=engine)
    axis.axhline(VELOCITY_SLIP, color=style.GREY, lw=0.8, label="Boltzmann equation")
    axis.axhline(ELEMENTARY_SLIP, color=style.GREY, lw=0.8, ls=":", label="Maxwell's estimate")
    axis.set_xlabel(r"packing fraction $\phi$")
    axis.set_ylabel(r"slip over $\lambda\,\mathrm{d}u/\mathrm{d}x$")
    axis.legend(loc="upper left")


def _normal(axis: Axes, flows: xr.Dataset) -> None:
    """The normal stresses of dilute gases over their mean, by the square of the reduced rate."""
    row = _some(flows, (flows["knudsen"].values < FREE) & (flows["engine"].values == DSMC))
    square = row["reduced_rate"].values ** 2
    fine = np.linspace(0.0, 1.1 * float(square[row["knudsen"].values < SLIP_FLOW].max()), 2)
    names = {"x": "along the gradient", "y": "along the flow", "z": "along the vorticity"}
    for kind, ((key, name), slope) in enumerate(zip(names.items(), NORMAL_STRESSES, strict=True)):
        style.measured(axis, square, estimates(row, f"normal_{key}"), kind, label=name)
        axis.plot(fine, slope * fine, color=style.COLOURS[kind], lw=0.8)
    axis.set_xlim(0.0, fine[-1])
    axis.set_ylim(*(1.6 * fine[-1] * slope for slope in (-1.2, 2.0)))
    axis.locator_params(axis="x", nbins=5)
    axis.set_xlabel("squared stress over pressure $a^2$")
    axis.set_ylabel("normal stress / mean $-$ 1")
    axis.legend(loc="upper left")
