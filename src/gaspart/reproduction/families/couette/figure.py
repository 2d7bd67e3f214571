"""Figure of Couette flow between sliding walls."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.families.couette.claims import DILUTE_SLIP, FAST, FREE, SLIP_FLOW
from gaspart.reproduction.table import Table
from gaspart.theory.shear import ELEMENTARY_SLIP, NORMAL_STRESSES, VELOCITY_SLIP

DSMC, EVENT = "DSMC", "event-driven"


def couette(ds: xr.Dataset) -> Figure:
    """Draw profiles of velocity and temperature, stress, viscosity, slip and normal stresses.

    The stress is drawn against the Knudsen number.
    """
    figure, axes = style.new(*[(2.4,)] * 6)
    gases = Table(ds, "point")
    flows = gases[gases.part == "flows"]
    dilute, slow = flows[flows.packing_fraction < DILUTE_SLIP], flows[flows.speed < FAST]
    wide = flows[flows.knudsen < SLIP_FLOW]
    _velocity(axes[0], slow)
    _temperature(axes[1], wide[wide.engine == DSMC])
    _stress(axes[2], dilute[dilute.speed < FAST])
    _viscosity(axes[3], wide[wide.speed < FAST], gases)
    _slip(axes[4], wide[wide.speed < FAST])
    _normal(axes[5], flows[(flows.knudsen < FREE) & (flows.engine == DSMC)])
    style.letters(*axes)
    return figure


def _velocity(axis: Axes, slow: Table) -> None:
    """Draw the velocity across the gap for free flight, a dilute gas and a dense gas."""
    kinds = {
        "free flight": slow[slow.knudsen > FREE],
        "dilute": slow[(slow.knudsen < SLIP_FLOW) & (slow.packing_fraction < DILUTE_SLIP)],
        "dense": slow[slow.packing_fraction > DILUTE_SLIP],
    }
    line = np.array([-0.5, 0.5])
    axis.plot(line, line, color=style.GREY, lw=0.8, label="no slip")
    for kind, (name, flows) in enumerate(kinds.items()):
        if flows:
            last = flows[-1]
            style.points(axis, last.place, last.flow, kind=kind, label=name)
            if name == "dilute":
                slope = 1.0 / (1.0 + 2.0 * VELOCITY_SLIP * last.knudsen)
                axis.plot(line, slope * line, color=style.COLOURS[kind], lw=0.8)
    style.label_axes(axis, "position in the gap $x/L$", "velocity of the gas $u/U$", "upper left")


def _temperature(axis: Axes, wide: Table) -> None:
    """Draw the temperature against the square of the velocity, with the slope of viscous heating."""
    kinds = {"fast walls": wide[wide.speed > FAST], "slow walls": wide[wide.speed < FAST]}
    for kind, (name, flows) in enumerate(kinds.items()):
        if flows:
            first = flows[0]
            square = (first.speed * first.flow.value) ** 2
            style.points(axis, square, first.temperature, kind=kind, label=name)
            slope, reach = float(theory.viscous_heating(0.0, 3)), np.array([0.0, square.max()])
            top = first.temperature.value[square.argmin()]
            axis.plot(reach, top - slope * reach, color=style.COLOURS[kind], lw=0.8)
    labels = r"squared velocity of the gas $u^2$", "temperature / wall temperature"
    style.label_axes(axis, *labels, legend="upper right")


def _stress(axis: Axes, dilute: Table) -> None:
    """Draw the shear stress, relative to free flight, against the Knudsen number."""
    for kind, engine in enumerate((DSMC, EVENT)):
        own = dilute[dilute.engine == engine]
        style.points(axis, own.knudsen, own.stress, kind=kind, hollow=kind == 1, label=engine)
    knudsen = np.geomspace(0.02, 0.5, 50)
    density = 1.0 / (np.sqrt(2.0) * np.pi)  # number density of spheres of diameter 1 with mean free path 1
    slip = theory.slip_flow_stress(1.0 / knudsen, density, 1.0) / theory.free_molecular_stress(density, 1.0)
    axis.plot(knudsen, slip, color=style.GREY, lw=0.8, label="viscous, with slip")
    axis.axhline(1.0, color=style.GREY, lw=0.8, ls=":", label="free flight")
    axis.set(xscale="log", yscale="log")
    style.label_axes(axis, r"Knudsen number $\lambda/L$", "stress / free-flight stress", "lower right")


def _viscosity(axis: Axes, slow: Table, gases: Table) -> None:
    """Draw viscosity divided by Enskog theory against density, from response and from equilibrium."""
    for kind, engine in enumerate((DSMC, EVENT)):
        own = slow[slow.engine == engine]
        style.points(axis, own.packing_fraction, own.viscosity, kind=kind, label=f"response, {engine}")
    sheared, still = gases[gases.part == "sheared"], gases[gases.part == "equilibrium"]
    apart = 0.005  # so that points do not cover each other
    eta = sheared.packing_fraction - apart
    style.points(axis, eta, sheared.viscosity, kind=3, label="response, without walls")
    eta = still.packing_fraction + apart
    style.points(axis, eta, still.viscosity, kind=2, hollow=True, label="Green-Kubo")
    axis.axhline(1.0, color=style.GREY, lw=0.8, label="Enskog")
    style.label_axes(axis, r"packing fraction $\phi$", r"$\eta/\eta_\mathrm{Enskog}$", "upper left")


def _slip(axis: Axes, slow: Table) -> None:
    """Draw the slip length in mean free paths against density."""
    for kind, engine in enumerate((DSMC, EVENT)):
        own = slow[slow.engine == engine]
        style.points(axis, own.packing_fraction, own.slip, kind=kind, label=engine)
    axis.axhline(VELOCITY_SLIP, color=style.GREY, lw=0.8, label="Boltzmann equation")
    axis.axhline(ELEMENTARY_SLIP, color=style.GREY, lw=0.8, ls=":", label="Maxwell's estimate")
    labels = r"packing fraction $\phi$", r"slip / $(\lambda\,\mathrm{d}u/\mathrm{d}x)$"
    style.label_axes(axis, *labels, legend="upper left")


def _normal(axis: Axes, dilute: Table) -> None:
    """Draw the normal stresses of dilute gases, relative to their mean, against squared reduced rate."""
    square = dilute.reduced_rate.value**2
    fine = np.linspace(0.0, 1.1 * square[dilute.knudsen < SLIP_FLOW].max(), 2)
    names = {
        "along the gradient": dilute.normal_x,
        "along the flow": dilute.normal_y,
        "along the vorticity": dilute.normal_z,
    }
    for kind, ((name, stress), slope) in enumerate(zip(names.items(), NORMAL_STRESSES, strict=True)):
        style.points(axis, square, stress, kind=kind, label=name)
        axis.plot(fine, slope * fine, color=style.COLOURS[kind], lw=0.8)
    axis.set(xlim=(0.0, fine[-1]), ylim=[1.6 * fine[-1] * slope for slope in (-1.2, 2.0)])
    axis.locator_params(axis="x", nbins=5)
    style.label_axes(axis, "(stress / pressure)$^2$, $a^2$", "normal stress / mean $-$ 1", "upper left")
