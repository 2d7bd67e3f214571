"""The one style sheet: legible in a journal's column, in colours that the colour-blind can tell apart."""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path

COLUMN = 3.4
"""Width of one column of a journal, in inches."""

# Okabe and Ito, "Color universal design" (2008), in an order whose neighbours differ in lightness too.
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X"]

RULES = {
    "figure.figsize": (COLUMN, 2.6),
    "figure.dpi": 100,
    "figure.constrained_layout.use": True,
    "savefig.dpi": 300,
    "font.size": 8,
    "axes.labelsize": 8,
    "axes.titlesize": 8,
    "legend.fontsize": 7,
    "legend.frameon": False,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "axes.linewidth": 0.6,
    "lines.linewidth": 1.0,
    "lines.markersize": 3.5,
    "errorbar.capsize": 2,
    "svg.fonttype": "path",
    "svg.hashsalt": "gaspart",
}


@contextmanager
def applied():
    """Draw in this style, without a display, inside the ``with`` block."""
    import matplotlib

    matplotlib.use("Agg")
    from cycler import cycler

    with matplotlib.rc_context({**RULES, "axes.prop_cycle": cycler(color=COLOURS)}):
        yield


def save(figure, path: str | Path) -> None:
    """Write a figure, whole or not at all, as the path's suffix says; the same figure gives the same bytes."""
    from gaspart.files import whole_file

    kind = Path(path).suffix.lstrip(".")
    metadata = {"Date": None} if kind == "svg" else {"Software": None}
    with whole_file(path) as partial:
        figure.savefig(partial, format=kind, metadata=metadata)
