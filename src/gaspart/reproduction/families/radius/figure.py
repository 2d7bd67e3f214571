"""Z and its cost at several radii, for one packing fraction and one number of particles."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.table import Table

SERIES = ("packing fraction", "count")
RADIUS = "radius (container: side 16)"


def radius_grid(dataset: xr.Dataset) -> Figure:
    """Draw Z, its residuals, and the counted work, against the radius."""
    figure, (upper, middle, lower) = style.new((2.2, 1.2), (2.8,))
    table = Table(dataset, "point").sorted_by("radius")
    event, step = (table[table.engine == name] for name in ("event", "step"))
    style.band(middle, -3.0, 3.0)
    style.level(middle, 0.0)
    widest = 0.0
    for kind, name in enumerate(SERIES):
        own = event[event.series == name]
        _state(upper, own, kind, name)
        deviation = own.Z - own.reference
        sigmas = deviation.value / deviation.error
        widest = max(widest, *np.abs(sigmas))
        style.points(middle, own.radius, sigmas, np.ones(sigmas.size), kind=kind)
        _event_costs(lower, own, kind)
        _step_costs(lower, step[step.series == name], kind)
    style.label_axes(upper, y="compressibility factor $Z$", legend="upper left")
    half = max(4.0, widest + 1.5)
    style.label_axes(middle, RADIUS, "$(Z-Z_\\mathrm{ref})/\\sigma$", ylim=(-half, half))
    style.label_axes(lower, RADIUS, "counted work", yscale="log", ylim=(0.2, 6e2))
    _labels(lower, event, step)
    style.letters(upper, middle, lower)
    return figure


def _state(axis: Axes, own: Table, kind: int, name: str) -> None:
    radius, eta = own.radius, own.packing_fraction
    if name == "count":
        label = f"$N={own.count[0]:.0f}$, $\\eta$ = {eta.min():.2g} – {eta.max():.2g}"
    else:
        label = f"$\\eta={eta[0]:g}$, $N$ = {own.count.min():.0f} – {own.count.max():.0f}"
    style.points(axis, radius, own.Z, kind=kind, label=label)
    fine = np.linspace(radius[0], radius[-1], 200)
    # In one container the packing fraction of a given number of particles grows as the radius cubed.
    between = eta[0] * (fine / radius[0]) ** 3 if name == "count" else np.full(fine.size, eta[0])
    axis.plot(fine, theory.compressibility_factor(between, 3), color=style.COLOURS[kind])


def _event_costs(axis: Axes, own: Table, kind: int) -> None:
    """Draw counts as circles or squares; crossings hollow, with the line of kinetic theory."""
    style.points(axis, own.radius, own.pair_tests, kind=kind)
    style.points(axis, own.radius, own.crossings_counted, kind=kind, hollow=True)
    axis.plot(own.radius, own.crossings_expected, color=style.COLOURS[kind])


def _step_costs(axis: Axes, own: Table, kind: int) -> None:
    style.points(axis, own.radius, own.pair_tests, kind=kind, marker="x")
    axis.plot(own.radius, own.pair_tests_expected, color=style.COLOURS[kind], linestyle="--")


def _labels(axis: Axes, event: Table, step: Table) -> None:
    """Write the counted quantity above each group of points."""
    highest = 1.2 * event.pair_tests.max()
    texts = {
        "event-driven: pair tests per collision": highest,
        "time-stepped: pair tests per particle and step": min(1.25 * step.pair_tests.max(), 0.4 * highest),
        "event-driven: boundaries crossed per collision": 0.23,
    }
    for text, height in texts.items():
        axis.text(0.97, height, text, transform=axis.get_yaxis_transform(), ha="right", va="bottom")
