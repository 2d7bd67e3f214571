"""Z and its cost at several radii: for one packing fraction, and for one number of particles."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.families.shared.rows import estimates

SERIES = ("packing fraction", "count")


def radius_grid(dataset: xr.Dataset) -> Figure:
    """Z, its residuals, and the counted work, against the radius."""
    figure, (upper, middle, lower) = style.new((2.2, 1.2), (2.8,))
    event = dataset.isel(point=dataset["engine"].values == "event")
    step = dataset.isel(point=dataset["engine"].values == "step")
    style.band(middle, -3.0, 3.0)
    style.level(middle, 0.0)
    widest = 0.0
    for kind, name in enumerate(SERIES):
        one = event.isel(point=event["series"].values == name).sortby("radius")
        _state(upper, one, kind, name)
        sigmas = ((one["Z"] - one["reference"]) / np.hypot(one["Z_error"], one["reference_error"])).values
        widest = max(widest, *np.abs(sigmas))
        style.points(middle, one["radius"], sigmas, np.ones(sigmas.size), kind=kind)
        _event_costs(lower, one, kind)
        _step_costs(lower, step.isel(point=step["series"].values == name).sortby("radius"), kind)
    middle.set_ylim(-max(4.0, widest + 1.5), max(4.0, widest + 1.5))
    upper.set_ylabel("compressibility factor $Z$")
    upper.legend(loc="upper left")
    middle.set_ylabel("$(Z-Z_\\mathrm{ref})/\\sigma$")
    lower.set_yscale("log")
    lower.set_ylim(0.2, 6e2)
    lower.set_ylabel("counted work")
    for axis in (middle, lower):
        axis.set_xlabel("radius (container: side 16)")
    _labels(lower, event, step)
    style.letters(upper, middle, lower)
    return figure


def _state(axis: Axes, one: xr.Dataset, kind: int, name: str) -> None:
    if name == "count":
        label = f"$N={int(one['count'][0])}$, $\\eta$ = {_range(one['packing_fraction'], '{:.2g}')}"
    else:
        label = f"$\\eta={float(one['packing_fraction'][0]):g}$, $N$ = {_range(one['count'], '{:.0f}')}"
    style.measured(axis, one["radius"], estimates(one, "Z"), kind=kind, label=label)
    radius, eta = one["radius"].values, one["packing_fraction"].values
    fine = np.linspace(radius[0], radius[-1], 200)
    # In one container the packing fraction of a given number of particles grows as the radius cubed.
    between = eta[0] * (fine / radius[0]) ** 3 if name == "count" else np.full(fine.size, eta[0])
    axis.plot(fine, theory.compressibility_factor(between, 3), color=style.COLOURS[kind])


def _range(values: xr.DataArray, form: str) -> str:
    return f"{form.format(float(values.min()))} – {form.format(float(values.max()))}"


def _event_costs(axis: Axes, one: xr.Dataset, kind: int) -> None:
    """Circles or squares; crossings hollow, with the line of kinetic theory."""
    look: dict[str, Any] = {"kind": kind, "linestyle": "none"}
    style.points(axis, one["radius"], one["pair_tests"], **look)
    style.points(axis, one["radius"], one["crossings_counted"], hollow=True, **look)
    axis.plot(one["radius"], one["crossings_expected"], color=style.COLOURS[kind])


def _step_costs(axis: Axes, one: xr.Dataset, kind: int) -> None:
    style.points(axis, one["radius"], one["pair_tests"], kind=kind, marker="x")
    axis.plot(one["radius"], one["pair_tests_expected"], color=style.COLOURS[kind], linestyle="--")


def _labels(axis: Axes, event: xr.Dataset, step: xr.Dataset) -> None:
    """The counted quantity, above each group of points."""
    highest = 1.2 * float(event["pair_tests"].max())
    texts = (
        (highest, "event-driven: pair tests per collision"),
        (
            min(1.25 * float(step["pair_tests"].max()), 0.4 * highest),
            "time-stepped: pair tests per particle and step",
        ),
        (0.23, "event-driven: boundaries crossed per collision"),
    )
    for height, text in texts:
        axis.text(0.97, height, text, transform=axis.get_yaxis_transform(), ha="right", va="bottom")
