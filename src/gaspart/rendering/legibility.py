"""Legibility of a figure: positions of legends and texts.

Legends must not cover data. Texts must not overlap or leave the canvas.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gaspart.files import whole_file

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure
    from matplotlib.text import Text
    from matplotlib.transforms import Bbox

_STEP = 3.0
"""Distance in pixels between the tested points of a line."""
_GAP = 5.5
"""Pixels between a legend and the frame of its panel: matplotlib's default, half of the font size."""
_CLEAR = 2.0
"""Minimum number of pixels between data and a legend at its new position."""
_PLACES: dict[Any, tuple[float, float]] = {
    "upper right": (1.0, 1.0),
    "upper left": (0.0, 1.0),
    "lower right": (1.0, 0.0),
    "lower left": (0.0, 0.0),
    "center right": (1.0, 0.5),
    "center left": (0.0, 0.5),
    "upper center": (0.5, 1.0),
    "lower center": (0.5, 0.0),
}
"""Position of a legend in its panel, as fractions of the free width (left of it) and of the free height
(below it)."""
_NARROW, _LETTER = 0.8, 16.0
"""Maximum width of a legend that fits above a panel next to the panel's letter, as a fraction of the panel.

A wider legend is moved up by the second number, in pixels.
"""
_MOST_ROOM = 1.6
"""Maximum factor by which a vertical axis is extended to make space for a legend."""
_PASSES = 5


def place_legends(figure: Figure) -> None:
    """Move each legend that covers data to a free position. The position is in the panel if possible.
    Otherwise the vertical axis is extended, or the legend is placed above the panel. Afterwards the layout of
    the figure is fixed.
    """
    layout = figure.get_layout_engine()
    assert layout
    for _ in range(_PASSES):
        layout.execute(figure)
        moved = [_move_legend(axis) for axis in figure.axes if axis.get_legend()]
        if not any(moved):
            break
    layout.execute(figure)  # ticks depend on the size of a panel, and the layout depends on ticks
    figure.set_layout_engine(None)  # with "none", each file would be drawn twice, first for the layout


def _move_legend(axis: Axes) -> bool:
    """Return True if the legend of this panel covered data and was moved."""
    legend, frame = axis.get_legend(), axis.bbox
    assert legend
    box, everything = legend.get_window_extent(), _marks(axis, lines=True)
    data = np.concatenate([_inside_panel(axis, everything), *map(_text_points, axis.texts)])
    if not _inside(data, box.x0, box.y0, box.x1, box.y1).any():
        return False
    free = np.array([frame.width - box.width, frame.height - box.height]) - 2.0 * _GAP
    if (free > 0.0).all():
        for location, part in _PLACES.items():
            x, y = np.array(part) * free + (frame.x0 + _GAP, frame.y0 + _GAP)
            far = x + box.width + _CLEAR, y + box.height + _CLEAR
            if not _inside(data, x - _CLEAR, y - _CLEAR, *far).any():
                legend.set_bbox_to_anchor(None)
                legend.set_loc(location)
                return True
        if _extend_axis(axis, everything, box, free[0]):
            return True
    above = 1.0 if box.width < _NARROW * frame.width else 1.0 + _LETTER / frame.height
    legend.set_bbox_to_anchor((1.0, above), transform=axis.transAxes)
    legend.set_loc("lower right")
    return True


def _text_points(text: Text) -> np.ndarray:
    """Return points (n, 2) in pixels that cover a text."""
    box = text.get_window_extent()
    x, y = np.linspace(box.x0, box.x1, 9), np.linspace(box.y0, box.y1, 9)
    return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)


def _extend_axis(axis: Axes, data: np.ndarray, box: Bbox, free: float) -> bool:
    """Return True if the vertical axis was extended so that the legend fits at the top. `free` is the width
    in pixels of the panel that is not below the legend.
    """
    legend, frame = axis.get_legend(), axis.bbox
    assert legend
    starts = {
        location: frame.x0 + _GAP + _PLACES[location][0] * free for location in _PLACES if location[0] == "u"
    }
    tops = {
        location: data[_inside(data, x - _CLEAR, -np.inf, x + box.width + _CLEAR, np.inf), 1].max(
            initial=frame.y0
        )
        for location, x in starts.items()
    }
    location = min(tops, key=tops.__getitem__)
    factor = (tops[location] - frame.y0) / (frame.height - box.height - 3.0 * _GAP)
    if not 1.0 < factor <= _MOST_ROOM:
        return False
    top = axis.transData.inverted().transform((frame.x0, frame.y0 + factor * frame.height))[1]
    axis.set_ylim(top=top)
    legend.set_bbox_to_anchor(None)
    legend.set_loc(location)
    return True


def _inside(positions: np.ndarray, x_min: float, y_min: float, x_max: float, y_max: float) -> np.ndarray:
    """Return True for each of the positions (n, 2) inside a rectangle."""
    x, y = positions.T
    return (x > x_min) & (x < x_max) & (y > y_min) & (y < y_max)


def _inside_panel(axis: Axes, positions: np.ndarray) -> np.ndarray:
    """Return the positions (n, 2) that are inside a panel."""
    frame = axis.bbox
    return positions[_inside(positions, frame.x0 - 1.0, frame.y0 - 1.0, frame.x1 + 1.0, frame.y1 + 1.0)]


def _marks(axis: Axes, lines: bool) -> np.ndarray:
    """Return the positions (n, 2) in pixels of a panel's points and error bars. If `lines` is True, points
    along curves are included. Guide lines across the whole panel are not data.
    """
    from matplotlib.collections import LineCollection

    marks = [np.zeros((0, 2))]
    for line in axis.lines:
        if line.get_transform() is not axis.transData or not line.get_visible():
            continue
        positions = axis.transData.transform(np.asarray(line.get_xydata(), dtype=float))
        if line.get_marker() not in ("None", None, "", " "):
            marks.append(positions)
        if lines and line.get_linestyle() != "None":
            marks.append(_along(positions))
    for collection in axis.collections:
        if isinstance(collection, LineCollection) and collection.get_transform() is axis.transData:
            marks += [_along(axis.transData.transform(part)) for part in collection.get_segments()]
    for patch in axis.patches:
        if patch.get_data_transform() is axis.transData:
            outline = patch.get_transform().transform_path(patch.get_path()).vertices
            marks.append(_along(np.asarray(outline, dtype=float)))
    positions = np.concatenate(marks)
    return positions[np.isfinite(positions).all(axis=1)]


def _along(positions: np.ndarray) -> np.ndarray:
    """Return positions (m, 2), a few pixels apart, along a line through points (n, 2)."""
    positions = np.reshape(positions, (-1, 2))  # an error bar without a value has no points
    begin, way = positions[:-1], np.diff(positions, axis=0)
    finite = np.isfinite(way).all(axis=1)
    begin, way = begin[finite], way[finite]
    steps = 1 + np.minimum(np.hypot(*way.T) / _STEP, 1000.0).astype(int)
    part = (np.arange(steps.sum()) - np.repeat(np.cumsum(steps) - steps, steps)) / np.repeat(steps, steps)
    return np.repeat(begin, steps, axis=0) + part[:, None] * np.repeat(way, steps, axis=0)


def flaws(figure: Figure) -> list[str]:
    """Return the flaws of a saved figure, a sentence each. Flaws are: text that overlaps other text or leaves
    the canvas, a legend on data, and text in a panel on a point.
    """
    from matplotlib.text import Text

    figure.draw_without_rendering()  # labels have the positions of the last drawing, at another resolution
    texts = list(_texts(figure))
    sentences = [
        f"{first!r} overlaps {second!r}"
        for (first, box), (second, other) in combinations(texts, 2)
        if box.overlaps(other)
    ]
    width, height = figure.bbox.max
    sentences += [
        f"{text!r} leaves the canvas"
        for text, box in texts
        if box.x0 < -1.0 or box.y0 < -1.0 or box.x1 > width + 1.0 or box.y1 > height + 1.0
    ]
    for axis in figure.axes:
        legend, points = axis.get_legend(), _inside_panel(axis, _marks(axis, lines=False))
        # without the arrow of an annotation, which points at data
        covers = [(repr(text.get_text()), Text.get_window_extent(text), points) for text in axis.texts]
        if legend:
            covers.append(
                ("a legend", legend.get_window_extent(), _inside_panel(axis, _marks(axis, lines=True)))
            )
        sentences += [
            f"{text} lies on data"
            for text, box, data in covers
            if _inside(data, box.x0, box.y0, box.x1, box.y1).any()
        ]
    return sentences


def _texts(figure: Figure) -> Iterator[tuple[str, Bbox]]:
    """Yield every visible text with its rectangle in pixels; a legend counts as one text."""
    from matplotlib.legend import Legend
    from matplotlib.text import Text

    drawn = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text().strip()]
    ticks = {text for panel in figure.axes for axis in (panel.xaxis, panel.yaxis) for text in _ticks(axis)}
    labels = {text for text, seen in ticks if seen}
    others = {text for text, _ in ticks}
    for legend in figure.findobj(Legend):
        yield "legend", _smaller(legend.get_window_extent())
        others |= set(legend.get_texts()) | {legend.get_title()}
    for text in drawn:
        if text in labels or text not in others:
            yield text.get_text(), _smaller(text.get_window_extent())


def _ticks(axis: Axis) -> Iterator[tuple[object, bool]]:
    """Yield the labels of an axis' ticks, with True for each visible label."""
    low, high = sorted(map(float, axis.get_view_interval()))
    panel = axis.axes.axison and axis.axes.get_visible()
    for minor in (False, True):
        positions = axis.get_ticklocs(minor=minor)
        ticks = axis.get_minor_ticks() if minor else axis.get_major_ticks()
        for tick, position in zip(ticks, positions, strict=False):
            for label in (tick.label1, tick.label2):
                yield label, bool(panel and label.get_visible() and low <= position <= high)


def _smaller(box: Bbox) -> Bbox:
    """Return a rectangle without its outermost pixels, which letters do not reach."""
    return box.padded(-2.0)


# Key picture of a figure: one panel, drawn for a small place such as a gallery.


_SIZE, _DOTS = (3.2, 2.14), 150
"""Width and height in inches, and dots per inch: lettering of 8 points is 17 of the 321 pixels high."""
_LETTERS = 20
"""Mean number of letters of the entries of a legend up to which two fit beside each other."""
_PANEL_LETTER = re.compile(r"^\([a-z]\)\s*")


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
    panel.set_title(_PANEL_LETTER.sub("", panel.get_title(loc="left")), loc="left", pad=3.0)
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
    place_legends(figure)
    canvas = figure.bbox.padded(1.0)
    for label in (panel.xaxis.label, panel.yaxis.label):
        box = label.get_window_extent()
        if not (canvas.contains(*box.min) and canvas.contains(*box.max)):
            label.set_text(_two_lines(label.get_text()))
            figure.set_layout_engine("constrained")
            place_legends(figure)


def _two_lines(text: str) -> str:
    """Return a text with a line break at the space nearest to its middle, outside of formulas."""
    spaces = [n for n, letter in enumerate(text) if letter == " " and text.count("$", 0, n) % 2 == 0]
    if not spaces:
        return text
    middle = min(spaces, key=lambda n: abs(2 * n - len(text)))
    return f"{text[:middle]}\n{text[middle + 1 :]}"
