"""What a figure draws, read back from its panels, for comparison with the data set that it was made from."""

import numpy as np
from matplotlib.container import ErrorbarContainer

from gaspart.rendering import style
from gaspart.rendering.legibility import flaws

HIGHEST = 1.8
"""Of a figure on a page: its height over its width."""


def draw(function, dataset):
    """The figure of a data set as drawn for a page, and legible there. (The smoke run draws each for a column
    of a journal too.)"""
    with style.use_style("page"):
        figure = function(dataset)
        style.finish(figure)
    assert not flaws(figure)
    width, height = figure.get_size_inches()
    assert width == style.PAGE and height <= HIGHEST * width
    return figure


def shows(axis, x, y, error):
    """Assert that a panel's points are this one series, with bars of y alone."""
    (drawn,) = [one for one in axis.containers if isinstance(one, ErrorbarContainer)]
    assert drawn.has_yerr and not drawn.has_xerr
    ends = np.array([path.vertices[:, 1] for path in drawn.lines[2][0].get_paths()]).T
    for found, wanted in zip((*drawn.lines[0].get_data(), *ends), (x, y, y - error, y + error), strict=True):
        np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-12)


def lines(axis):
    """The lines of a panel that are drawn in its coordinates and belong to no series of points."""
    bars = [one for one in axis.containers if isinstance(one, ErrorbarContainer)]
    parts = {part for one in bars for part in (one.lines[0], *one.lines[1])}
    return [one for one in axis.lines if one not in parts and one.get_transform() is axis.transData]
