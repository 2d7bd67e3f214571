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
        figure.legend(handles, texts, ncols=2, loc="outside upper center")
        legend.remove()
    figure.set_layout_engine("constrained")
    legibility.place_legends(figure)
