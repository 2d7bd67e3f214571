"""The style sheet of all figures: sizes of a journal's column, colours that the colour-blind distinguish."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

if TYPE_CHECKING:  # the colours are used without matplotlib
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.container import ErrorbarContainer
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Rectangle
    from matplotlib.text import Text

COLUMN = 3.4
"""Width of one column of a journal, in inches."""
PAGE = 7.0
"""Width of two columns."""

# Okabe and Ito, "Color universal design" (2008), in an order whose neighbours differ in lightness too.
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X"]
DATA = "#000000"
"""Colour of measured points, where a panel has one series."""
REFERENCE = "#0072b2"
"""Colour of the curve that the measurement is compared with."""
GREY = "#8c8c8c"
"""For guides: zero lines, bands, limits."""
_SHORTEST, _SHORT = 0.5, 2.2
"""Decades of a logarithmic axis: below the first it has ticks like a linear one, up to the second also at
twice and five times a power of ten."""

RULES: dict[Any, Any] = {
    "figure.figsize": (COLUMN, 2.6),
    "figure.dpi": 100,
    "figure.constrained_layout.use": True,
    "savefig.dpi": 300,
    "font.size": 8,
    "axes.labelsize": 9,
    "axes.titlesize": 8,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "legend.handlelength": 1.6,
    "legend.labelspacing": 0.25,
    "legend.borderpad": 0.2,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "axes.linewidth": 0.6,
    "lines.linewidth": 1.0,
    "lines.markersize": 3.5,
    "errorbar.capsize": 1.5,
    "svg.fonttype": "path",
    "svg.hashsalt": "gaspart",
}


@contextmanager
def applied() -> Iterator[None]:
    """Draw in this style, without a display, inside the ``with`` block."""
    import matplotlib
    from cycler import cycler

    matplotlib.use("Agg")
    with matplotlib.rc_context({**RULES, "axes.prop_cycle": cycler(color=COLOURS)}):
        yield


def new(
    rows: int = 1,
    columns: int = 1,
    height: float | None = None,
    height_ratios: Sequence[float] | None = None,
    share_x: bool = True,
) -> tuple[Figure, Any]:
    """A figure one column wide (two, if it has several columns of panels), and its axes.

    height: in inches. height_ratios: (rows,). share_x: panels above each other have one x axis.
    Returns (figure, axes): one Axes if there is one panel, else an array of shape (rows,), (columns,) or
    (rows, columns).
    """
    from matplotlib.figure import Figure

    width = COLUMN if columns == 1 else PAGE
    figure = Figure(figsize=(width, 0.4 + 2.2 * rows if height is None else height), layout="constrained")
    axes = figure.subplots(
        rows,
        columns,
        sharex="col" if share_x and rows > 1 else False,
        gridspec_kw={} if height_ratios is None else {"height_ratios": height_ratios},
    )
    return figure, axes


def points(
    axis: Axes,
    x: ArrayLike,
    y: ArrayLike,
    error: ArrayLike | None = None,
    kind: int = 0,
    hollow: bool = False,
    **options: Any,
) -> ErrorbarContainer:
    """Measured points with error bars: colour and marker number `kind`, or `color` and `marker`."""
    colour = options.pop("color", COLOURS[kind % len(COLOURS)])
    options.setdefault("marker", MARKERS[kind % len(MARKERS)])
    options.setdefault("linestyle", "none")
    options.setdefault("elinewidth", 0.8)
    options.setdefault("zorder", 3)
    face = "white" if hollow else colour
    return axis.errorbar(x, y, yerr=error, color=colour, markerfacecolor=face, markeredgewidth=0.8, **options)


def residuals(
    axis: Axes, x: ArrayLike, sigmas: ArrayLike, kind: int = 0, gate: float = 3.0, **options: Any
) -> None:
    """A panel of deviations in standard deviations: one series, the zero line and the band of ± `gate`.

    The scale is at least ±1.3 gate, so that an innocent panel looks innocent.
    """
    band(axis, -gate, gate)
    level(axis, 0.0)
    points(axis, x, sigmas, np.ones(np.shape(sigmas)), kind=kind, **options)
    widest = max(1.3 * gate, *(1.0 + 1.1 * np.abs(np.atleast_1d(sigmas))))
    axis.set_ylim(-widest, widest)


def band(axis: Axes, low: float, high: float, **options: Any) -> Rectangle:
    """A horizontal grey band, behind everything."""
    return axis.axhspan(low, high, color=GREY, alpha=0.18, linewidth=0, zorder=0, **options)


def level(axis: Axes, value: float, **options: Any) -> Line2D:
    """A horizontal grey line, behind the points."""
    return axis.axhline(value, color=GREY, linewidth=0.6, zorder=1, **options)


def letter(axis: Axes, text: str, x: float = 0.02, y: float = 0.97) -> Text:
    """(a), (b) ... or a short title in a panel's upper left corner; x, y: in parts of the panel."""
    from matplotlib.patheffects import withStroke

    halo = [withStroke(linewidth=2.0, foreground="white")]  # legible over points too
    where: dict[str, Any] = {"transform": axis.transAxes, "ha": "left", "va": "top", "zorder": 10}
    return axis.text(x, y, text, fontweight="bold", path_effects=halo, **where)


def letters(*axes: Axes) -> None:
    """(a), (b) ... in the upper left corners of these panels."""
    for axis, text in zip(axes, "abcdefgh", strict=False):
        letter(axis, text)


def share_x(*panels: Axes) -> None:
    """One x axis for panels above each other, labelled below the last."""
    for panel in panels[:-1]:
        panel.sharex(panels[-1])
        panel.tick_params(labelbottom=False)


def save(figure: Figure, path: str | Path) -> None:
    """Write a figure atomically, in the format of its suffix; the same figure gives the same bytes."""
    from gaspart.files import whole_file

    kind = Path(path).suffix.lstrip(".")
    metadata = {"Date": None} if kind == "svg" else {"Software": None}
    for panel in figure.axes:
        for axis in (panel.xaxis, panel.yaxis):
            _number_ticks(axis)
    with whole_file(path) as partial:
        figure.savefig(partial, format=kind, metadata=metadata)


def _number_ticks(axis: Axis) -> None:
    """Ticks of a logarithmic axis whose numbers do not run into each other: 1, 2, 5, 10 on a short one,
    powers of ten alone on a long one; those that a figure has chosen remain."""
    from matplotlib.ticker import AutoLocator, FixedLocator, FuncFormatter, LogLocator, NullFormatter

    if axis.get_scale() != "log" or isinstance(axis.get_major_locator(), FixedLocator):
        return
    axis.set_minor_formatter(NullFormatter())
    low, high = sorted(map(float, axis.get_view_interval()))
    decades = math.log10(high / low)
    if decades > _SHORT or low < 1e-4 or high > 1e5:
        return
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)) if decades > _SHORTEST else AutoLocator())
    axis.set_major_formatter(FuncFormatter("{:g}".format))
