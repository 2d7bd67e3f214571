"""Figures of random insertion and dense packings."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style
from gaspart.rendering.particles import DrawnParticles, colours_of
from gaspart.rendering.pictures import picture
from gaspart.reproduction.claims.table import concise
from gaspart.reproduction.table import Row, Table

SERIES = {
    (3, "centres_to_walls"): "spheres, centres up to walls",
    (3, "periodic"): "spheres, periodic",
    (3, "wall"): "spheres completely inside",
    (2, "periodic"): "discs, periodic",
}
"""Labels of the series, by dimension and rule, in the order of the legend."""
SOURCE = 0.52
"""Packing fraction that source A's program reached."""


def fill_failures(dataset: xr.Dataset) -> Figure:
    """Draw failures per particle, and packing fraction against attempts^(-1/d).

    Failures are drawn up to saturation, and at low density.
    """
    figure, (upper, middle, lower) = style.new((3.4,), (1.6,), (2.2,))
    containers = Table(dataset, "container")
    for kind, ((dimension, rule), label) in enumerate(SERIES.items()):
        for fill in containers[(containers.dimension == dimension) & (containers.rule == rule)]:
            if np.isfinite(fill.saturation.value[0]):
                _failures(upper, fill, kind, label)
                _saturation(lower, fill, kind)
            else:
                _failures(middle, fill, kind, label)
    _limits(upper)
    _low_density(middle)
    columns = 2 if style.width() > style.COLUMN else 1
    figure.legend(
        *upper.get_legend_handles_labels(), loc="outside upper center", ncols=columns, columnspacing=1.0
    )
    axes = "(attempts $\\times\\ v/V)^{-1/d}$", "packing fraction $\\eta$"
    style.label_axes(lower, *axes, xlim=(-0.008, 0.47), ylim=(0.2, 0.58))
    style.letters(upper, middle, lower)
    return figure


def _failures(axis: Axes, fill: Row, kind: int, label: str) -> None:
    failures = fill.failures_per_particle
    some = np.where(failures.value > 0.0, failures.value, np.nan)  # the scale is logarithmic
    style.points(axis, fill.packing_fraction, some, failures.error, kind, markersize=2.5, label=label)


def _limits(axis: Axes) -> None:
    """Draw saturation in an infinite container, and source A's packing fraction."""
    marks = [
        (theory.RSA_SATURATION[3], "3D: 0.384", style.COLOURS[1], -0.006, "right"),
        (SOURCE, "source A: 52 %", style.COLOURS[0], -0.006, "right"),
        (theory.RSA_SATURATION[2], "2D: 0.547", style.COLOURS[3], 0.006, "left"),
    ]
    for fraction, text, colour, shift, side in marks:
        axis.axvline(fraction, color=colour, linestyle="--", linewidth=0.8, zorder=1)
        axis.text(fraction + shift, 0.013, text, color=colour, rotation=90, ha=side, va="bottom")
    axis.set_yscale("log")
    labels = "packing fraction $\\eta$", "failed attempts per particle"
    style.label_axes(axis, *labels, xlim=(0.0, 0.59), ylim=(0.01, 6e6))


def _low_density(axis: Axes) -> None:
    """Draw the first particles of a large container, with the exact low-density expansion."""
    eta = np.linspace(0.0, 0.06, 60)
    for dimension in (2, 3):
        axis.plot(eta, theory.failures_per_particle(eta, dimension), color="black", linewidth=0.8, zorder=4)
    axis.text(0.036, 0.48, "$2^3\\eta+\\ldots$", ha="right")
    axis.text(0.058, 0.03, "$2^2\\eta+\\ldots$", ha="right")
    labels = "packing fraction $\\eta$", "failures per particle"
    style.label_axes(axis, *labels, xlim=(0.0, 0.06), ylim=(0.0, 0.85))


def _saturation(axis: Axes, fill: Row, kind: int) -> None:
    """Draw the growing packing fraction, its fitted line, and the predicted saturation."""
    colour, marker = style.COLOURS[kind], style.MARKERS[kind]
    x = fill.time ** (-1.0 / fill.dimension)
    axis.plot(x, fill.filled, color=colour, linestyle="none", marker=marker, markersize=2.5, zorder=3)
    x = np.linspace(0.0, 0.45, 2)
    line = fill.saturation.value[0] + fill.saturation_slope[0] * x
    axis.plot(x, line, color=colour, linewidth=0.8)
    expected = theory.insertion_saturation(fill.dimension, fill.side_over_diameter, fill.rule)
    axis.plot([0.0], [expected], marker="_", markersize=12, color="black", clip_on=False, zorder=5)


DOTS = 300
"""Resolution of the pictures in pixels per inch, the same as in a saved figure."""
NAMES = {
    "centres_to_walls": "inserted,\ncentres up to the walls",
    "wall": "inserted,\ncompletely inside",
    "periodic": "inserted,\nperiodic",
    "compressed": "grown until jammed,\nperiodic",
}


def densest_fill(ds: xr.Dataset) -> Figure:
    """Draw the source's fill (first packing) and the compressed packing (last), with densities."""
    figure, axes = style.new((3.4,), (3.4,))
    packings = Table(ds, "packing")
    for letter, axis, packing in zip("ab", axes, (packings[0], packings[-1]), strict=True):
        positions = packing.position[np.isfinite(packing.position).all(axis=1)]
        count = len(positions)
        particles = DrawnParticles(
            positions=positions,
            radii=np.full(count, packing.radius),
            species=np.zeros(count, dtype=int),
            speeds=np.zeros(count),
            lengths=packing.length,
            walls=np.zeros((0, 2, 2)),
        )
        side = round(DOTS * style.PAGE / 3)
        axis.imshow(picture(particles, (side, side), colours_of(particles, "species")))
        axis.set_axis_off()
        style.letter(axis, f"({letter})")
        axis.set_title(f"{NAMES[packing.rule]}\nη = {concise(packing.packing_fraction, packing.error)}")
    return figure
