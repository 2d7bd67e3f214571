"""The key picture of a figure: one panel, drawn for a small place such as a gallery."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from gaspart.rendering import legibility

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIZE = 3.2, 2.14
"""Width and height in inches. At a width of 480 pixels, lettering of 8 points is 17 pixels high."""
_LETTER = re.compile(r"^\([a-z]\)\s*")


def keep_panel(figure: Figure, number: int) -> None:
    """Reduce a finished figure to one of its panels, and what lies on it, in the size of a key picture.

    Pictures stay as they are: panels without axes belong together.
    """
    panel = figure.axes[number]
    if not panel.axison:
        return
    for other in figure.axes:
        if other is not panel and panel.get_shared_x_axes().joined(panel, other) and not panel.get_xlabel():
            panel.set_xlabel(other.get_xlabel())
    for other in list(figure.axes):
        if other is not panel and other.get_subplotspec() != panel.get_subplotspec():
            other.remove()
    panel.tick_params(labelbottom=True)
    panel.set_title(_LETTER.sub("", panel.get_title(loc="left")), loc="left", pad=3.0)
    figure.set_size_inches(*SIZE)
    whole = figure.add_gridspec(1, 1)[0]
    for kept in figure.axes:
        kept.set_subplotspec(whole)
    for legend in list(figure.legends):  # as wide as the whole figure was
        texts = [text.get_text() for text in legend.get_texts()]
        figure.legend(legend.legend_handles, texts, ncols=2, loc="outside upper center")
        legend.remove()
    figure.set_layout_engine("constrained")
    legibility.place_legends(figure)
