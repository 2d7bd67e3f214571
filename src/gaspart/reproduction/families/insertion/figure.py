"""Random insertion: failed attempts per particle, and saturation."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style

SERIES = {
    (3, "centres_to_walls"): "spheres, centres up to walls",
    (3, "periodic"): "spheres, periodic",
    (3, "wall"): "spheres completely inside",
    (2, "periodic"): "discs, periodic",
}
"""Labels of the series by dimension and rule, in the order of the legend."""
SOURCE = 0.52
"""The packing fraction that source A's program reached."""


def fill_failures(dataset: xr.Dataset) -> Figure:
    """Failures per particle, to saturation and at low density; packing fraction against attempts^(-1/d)."""
    figure, (upper, middle, lower) = style.new((3.4,), (1.6,), (2.2,))
    for kind, (key, label) in enumerate(SERIES.items()):
        for k in range(dataset.sizes["container"]):
            one = dataset.isel(container=k)
            if (int(one["dimension"]), str(one["rule"].values)) != key:
                continue
            if np.isfinite(one["saturation"][0]):
                _failures(upper, one, kind, label)
                _saturation(lower, one, kind)
            else:
                _failures(middle, one, kind, label)
    _limits(upper)
    _low_density(middle)
    columns = 2 if style.width() > style.COLUMN else 1
    figure.legend(
        *upper.get_legend_handles_labels(), loc="outside upper center", ncols=columns, columnspacing=1.0
    )
    lower.set_xlim(-0.008, 0.47)
    lower.set_ylim(0.2, 0.58)
    lower.set_xlabel("(attempts $\\times\\ v/V)^{-1/d}$")
    lower.set_ylabel("packing fraction $\\eta$")
    style.letters(upper, middle, lower)
    return figure


def _failures(axis: Axes, one: xr.Dataset, kind: int, label: str) -> None:
    style.points(
        axis, one["packing_fraction"], one["failures_per_particle"].where(one["failures_per_particle"] > 0),
        one["failures_per_particle_error"], kind=kind, markersize=2.5,
        label=label,
    )  # fmt: skip


def _limits(axis: Axes) -> None:
    """Saturation in an infinite container, and source A's packing fraction."""
    marks = [
        (theory.RSA_SATURATION[3], "3D: 0.384", style.COLOURS[1], -0.006, "right"),
        (SOURCE, "source A: 52 %", style.COLOURS[0], -0.006, "right"),
        (theory.RSA_SATURATION[2], "2D: 0.547", style.COLOURS[3], 0.006, "left"),
    ]
    for place, text, colour, shift, side in marks:
        axis.axvline(place, color=colour, linestyle="--", linewidth=0.8, zorder=1)
        axis.text(place + shift, 0.013, text, color=colour, rotation=90, ha=side, va="bottom")
    axis.set_yscale("log")
    axis.set_xlim(0.0, 0.59)
    axis.set_ylim(0.01, 6e6)
    axis.set_xlabel("packing fraction $\\eta$")
    axis.set_ylabel("failed attempts per particle")


def _low_density(axis: Axes) -> None:
    """The first particles of a large container, and the expansion that is exact there."""
    eta = np.linspace(0.0, 0.06, 60)
    for dimension in (2, 3):
        axis.plot(eta, theory.failures_per_particle(eta, dimension), color="black", linewidth=0.8, zorder=4)
    axis.text(0.036, 0.48, "$2^3\\eta+\\ldots$", ha="right")
    axis.text(0.058, 0.03, "$2^2\\eta+\\ldots$", ha="right")
    axis.set_xlim(0.0, 0.06)
    axis.set_ylim(0.0, 0.85)
    axis.set_xlabel("packing fraction $\\eta$")
    axis.set_ylabel("failures per particle")


def _saturation(axis: Axes, one: xr.Dataset, kind: int) -> None:
    """The growing packing fraction, its fitted line, and the predicted saturation."""
    dimension = int(one["dimension"])
    colour = style.COLOURS[kind]
    axis.plot(
        one["time"] ** (-1.0 / dimension), one["filled"], linestyle="none", marker=style.MARKERS[kind],
        markersize=2.5, color=colour, zorder=3,
    )  # fmt: skip
    x = np.linspace(0.0, 0.45, 2)
    axis.plot(
        x, one["saturation"].values[0] + one["saturation_slope"].values[0] * x, color=colour, linewidth=0.8
    )
    expected = theory.insertion_saturation(
        dimension, float(one["side_over_diameter"]), str(one["rule"].values)
    )
    axis.plot([0.0], [expected], marker="_", markersize=12, color="black", clip_on=False, zorder=5)
