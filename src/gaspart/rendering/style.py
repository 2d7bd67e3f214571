"""Style of all figures: layouts, font sizes, colours suitable for colour-blind readers."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from gaspart.analysis.estimate import Estimate

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Axes
    from matplotlib.axis import Axis
    from matplotlib.container import ErrorbarContainer
    from matplotlib.figure import Figure as Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Rectangle
    from matplotlib.text import Text
else:  # colours, and annotations of the figures' modules, do not need matplotlib
    Axes = Figure = Any

COLUMN = 3.4
"""Width of one column of a journal, in inches."""
PAGE = 7.0
"""Width of two columns, in inches."""
LAYOUTS = {"page": PAGE, "journal": COLUMN}
"""Width of a figure by layout: two columns of panels for a page, one column for a journal."""

# Okabe and Ito, "Color universal design" (2008), in an order in which neighbours also differ in lightness.
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X"]
DATA = "#000000"
"""Colour of measured points, if a panel has one series."""
REFERENCE = "#0072b2"
"""Colour of the curve with which the measurement is compared."""
GREY = "#8c8c8c"
"""Colour of guides: zero lines, bands, limits."""
_DATED = {"svg": "Date", "pdf": "CreationDate", "png": "Software"}
"""Metadata key with the date or program, by file format; it is removed from files."""
_SHORTEST, _SHORT = 0.5, 2.2
"""Lengths of logarithmic axes in decades. Axes below the first length have linear ticks. Axes up to the
second length also have ticks at two and five times powers of ten."""

RULES: dict[Any, Any] = {
    "figure.dpi": 100,
    # only `new` computes the layout; afterwards the panels keep their positions
    "figure.constrained_layout.use": False,
    "figure.constrained_layout.w_pad": 0.08,
    "savefig.dpi": 300,
    "font.family": "DejaVu Sans",  # matplotlib's own font: no list of other fonts is searched for every text
    "font.size": 8,
    "axes.labelsize": 9,
    "axes.titlesize": 8,
    "legend.fontsize": 8,
    "legend.facecolor": "white",
    "legend.edgecolor": "none",
    "legend.framealpha": 0.8,
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
    "pdf.fonttype": 42,
    "svg.hashsalt": "gaspart",
}


@contextmanager
def use_style(layout: str = "page") -> Iterator[None]:
    """Use this style and one of LAYOUTS, without a display, in a ``with`` block."""
    import matplotlib
    from cycler import cycler

    matplotlib.use("Agg")
    size: dict[Any, Any] = {"figure.figsize": (LAYOUTS[layout], COLUMN)}
    with matplotlib.rc_context({**RULES, **size, "axes.prop_cycle": cycler(color=COLOURS)}):
        yield


def width() -> float:
    """Return the width of a figure in the present layout, in inches."""
    import matplotlib

    return float(matplotlib.rcParams["figure.figsize"][0])


def new(*groups: Sequence[float]) -> tuple[Figure, list[Axes]]:
    """Create a figure of groups of panels, in the present layout. Each of `groups` has the heights in inches
    of its panels, which lie above each other and share their x axis. On a page the first groups fill the left
    column, and the others the right column; both columns have about the same height. In a journal all groups
    are in one column. Returns (figure, panels in the order of `groups`).
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    columns = _columns(groups) if width() > COLUMN else [groups]
    height = max(sum(map(sum, column)) for column in columns)
    figure = Figure(figsize=(width(), height), layout="constrained")
    FigureCanvasAgg(figure)  # keeps the sizes of texts between the passes of the layout
    outer = figure.add_gridspec(1, len(columns))
    axes: list[Axes] = []
    for n, column in enumerate(columns):
        heights = [high for group in column for high in group]
        grid = outer[n].subgridspec(len(heights), 1, height_ratios=heights)
        panels = [figure.add_subplot(grid[row]) for row in range(len(heights))]
        axes += panels
        for group in column:
            *above, last = panels[: len(group)]
            for panel in above:  # the x axis is labelled below the last panel only
                panel.sharex(last)
                panel.tick_params(labelbottom=False)
            panels = panels[len(group) :]
    return figure, axes


def _columns(groups: Sequence[Sequence[float]]) -> list[Sequence[Sequence[float]]]:
    """Split the groups into two columns; the higher column is as low as possible. The groups keep their
    order.
    """
    if len(groups) == 1:
        return [groups]
    cuts = [(groups[:n], groups[n:]) for n in range(1, len(groups))]
    return list(min(cuts, key=lambda cut: max(sum(map(sum, column)) for column in cut)))


def split(axis: Axes, rows: int, columns: int) -> np.ndarray:
    """Replace a panel by a grid of panels (rows, columns)."""
    figure, position = axis.get_figure(), axis.get_subplotspec()
    axis.remove()
    assert figure and position
    parts = position.subgridspec(rows, columns)
    return np.array([[figure.add_subplot(parts[n, k]) for k in range(columns)] for n in range(rows)])


def points(
    axis: Axes,
    x: ArrayLike | Estimate,
    y: ArrayLike | Estimate,
    error: ArrayLike | None = None,
    kind: int = 0,
    hollow: bool = False,
    **options: Any,
) -> ErrorbarContainer:
    """Draw measured points, with the colour and marker of index `kind`, or with `options`. `x` and `y` have
    the shape (n,); estimates have error bars. `options` are options of `Axes.errorbar`, such as `color` and
    `marker`.
    """
    if isinstance(y, Estimate):
        y, error = y.value, y.error
    if isinstance(x, Estimate):
        x, options["xerr"] = x.value, x.error
    colour = options.pop("color", COLOURS[kind % len(COLOURS)])
    options.setdefault("marker", MARKERS[kind % len(MARKERS)])
    options.setdefault("linestyle", "none")
    options.setdefault("elinewidth", 0.8)
    options.setdefault("zorder", 3)
    face = "white" if hollow else colour
    return axis.errorbar(x, y, yerr=error, color=colour, markerfacecolor=face, markeredgewidth=0.8, **options)


def label_axes(
    axis: Axes, x: str = "", y: str = "", legend: str = "", columns: int = 1, **limits: Any
) -> None:
    """Label the axes of a panel; add a legend if its position is given. `limits` are arguments of
    `Axes.set`.
    """
    labels = {"xlabel": x, "ylabel": y}
    axis.set(**{key: text for key, text in labels.items() if text}, **limits)
    if legend:
        position: dict[str, Any] = {"loc": legend, "ncols": columns}
        axis.legend(**position)


def band(axis: Axes, low: float, high: float, **options: Any) -> Rectangle:
    """Draw a horizontal grey band behind all data."""
    return axis.axhspan(low, high, color=GREY, alpha=0.18, linewidth=0, zorder=0, **options)


def level(axis: Axes, value: float, **options: Any) -> Line2D:
    """Draw a horizontal grey line, behind the points."""
    return axis.axhline(value, color=GREY, linewidth=0.6, zorder=1, **options)


def letter(axis: Axes, text: str) -> Text:
    """Write (a), (b) ... and an optional short title above the left corner of a panel. This position has no
    data.
    """
    return axis.set_title(text, loc="left", fontweight="bold", pad=3.0)


def letters(*axes: Axes) -> None:
    """Write (a), (b) ... above these panels."""
    for axis, text in zip(axes, "abcdefgh", strict=False):
        letter(axis, f"({text})")


def save(figure: Figure, path: str | Path) -> None:
    """Write a figure atomically, in the format of its suffix. Equal figures have equal bytes."""
    from gaspart.files import whole_file

    finish(figure)
    kind = Path(path).suffix.lstrip(".")
    with whole_file(path) as partial:
        figure.savefig(partial, format=kind, metadata={_DATED[kind]: None})


_DEEPEST = 0.01
"""Lower ends of errors are shown on a logarithmic axis down to this fraction of the smallest value."""


def finish(figure: Figure) -> None:
    """Choose the ticks of logarithmic axes, and place the legends."""
    from gaspart.rendering.legibility import place_legends

    if not figure.get_constrained_layout():
        return  # already done
    for panel in figure.axes:
        for number, axis in enumerate((panel.xaxis, panel.yaxis)):
            _show_positive_ends(panel, axis, number)
            _number_ticks(axis)
    place_legends(figure)


def _show_positive_ends(panel: Axes, axis: Axis, number: int) -> None:
    """Extend an automatic logarithmic axis to the lower ends of error bars. If one of several bars extends
    below 0, matplotlib 3.11 chooses the limit by the values alone, and truncates the lower ends of all other
    bars too. `number` is 0 for x, 1 for y.
    """
    from matplotlib.container import ErrorbarContainer

    automatic = panel.get_autoscaley_on() if number else panel.get_autoscalex_on()
    if axis.get_scale() != "log" or not automatic:
        return
    bars = [
        container
        for container in panel.containers
        if isinstance(container, ErrorbarContainer) and container.lines[0]
    ]
    ends = [
        np.asarray(path.vertices)[:, number]
        for container in bars
        for part in container.lines[2]
        for path in part.get_paths()
    ]
    values = [np.asarray(container.lines[0].get_data()[number], dtype=float) for container in bars]
    end, value = (
        float(np.min(part, where=part > 0.0, initial=np.inf))
        for part in (np.concatenate([[np.inf], *parts]) for parts in (ends, values))
    )
    low, high = sorted(map(float, axis.get_view_interval()))
    end = max(end, _DEEPEST * value)
    if end < low:
        (panel.set_ylim if number else panel.set_xlim)(end / 1.2, high)


def _number_ticks(axis: Axis) -> None:
    """Choose ticks of a logarithmic axis whose numbers do not overlap. Ticks are at 1, 2, 5, 10 on a short
    axis, and at powers of ten on a long axis. Ticks that a figure has chosen are kept.
    """
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
