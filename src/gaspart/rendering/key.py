"""The key picture of a figure: one panel, drawn for a small place such as a gallery."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from gaspart.files import whole_file
from gaspart.rendering import legibility

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SIZE, _DOTS = (3.2, 2.14), 150
"""Width and height in inches, and dots per inch: lettering of 8 points is 17 of the 321 pixels high."""
_LETTERS = 20
"""Mean number of letters of the entries of a legend up to which two fit beside each other."""
_LETTER = re.compile(r"^\([a-z]\)\s*")


def save_key_picture(figure: Figure, number: int | None, path: str | Path) -> None:
    """Reduce a finished figure to one of its panels, and write it. Renders stay whole, as does a figure
    without a number.
    """
    if number is not None and figure.axes[number].axison:
        _keep(figure, figure.axes[number])
    with whole_file(path) as partial:
        figure.savefig(partial, format="png", dpi=_DOTS, metadata={"Software": None})


def _keep(figure: Figure, panel: Axes) -> None:
    """Give a panel, with what lies on it, the size of a key picture."""
    for other in figure.axes:
        if other is not panel and panel.get_shared_x_axes().joined(panel, other) and not panel.get_xlabel():
            panel.set_xlabel(other.get_xlabel())
    for other in list(figure.axes):
        if other is not panel and other.get_subplotspec() != panel.get_subplotspec():
            other.remove()
    panel.tick_params(labelbottom=True)
    panel.set_title(_LETTER.sub("", panel.get_title(loc="left")), loc="left", pad=3.0)
    figure.set_size_inches(*_SIZE)
    whole = figure.add_gridspec(1, 1)[0]
    for kept in figure.axes:
        kept.set_subplotspec(whole)
    for legend in list(figure.legends):  # as wide as the whole figure was
        handles = [handle for handle in legend.legend_handles if handle is not None]
        texts = [text.get_text() for text in legend.get_texts()]
        legend.remove()
        narrow = sum(map(len, texts)) < _LETTERS * len(texts)
        figure.legend(handles, texts, ncols=2 if narrow else 1, loc="outside upper center")
    figure.set_layout_engine("constrained")
    legibility.place_legends(figure)
    canvas = figure.bbox.padded(1.0)
    for label in (panel.xaxis.label, panel.yaxis.label):
        box = label.get_window_extent()
        if not (canvas.contains(*box.min) and canvas.contains(*box.max)):
            label.set_text(_two_lines(label.get_text()))
            figure.set_layout_engine("constrained")
            legibility.place_legends(figure)


def _two_lines(text: str) -> str:
    """Return a text with a line break at the space nearest to its middle, outside of formulas."""
    spaces = [n for n, letter in enumerate(text) if letter == " " and text.count("$", 0, n) % 2 == 0]
    if not spaces:
        return text
    middle = min(spaces, key=lambda n: abs(2 * n - len(text)))
    return f"{text[:middle]}\n{text[middle + 1 :]}"
