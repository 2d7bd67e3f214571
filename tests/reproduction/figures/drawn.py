"""What a figure draws, read back from its panels, for comparison with the data set that it was made from."""

from dataclasses import dataclass

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


def varied(dataset, *kept, seed=1):
    """The data set with every number of every variable but `kept` changed by its own factor of 0.9 to 1.1.

    So no two columns are equal, as they often are where a made-up measurement agrees with theory.
    """
    rng = np.random.default_rng(seed)
    return dataset.assign({
        name: values * rng.uniform(0.9, 1.1, values.shape)
        for name, values in dataset.data_vars.items()
        if name not in kept and values.dtype.kind == "f"
    })  # fmt: skip


@dataclass
class Points:
    """One series of points. x, y: (n,).

    error, x_error: (n,) or (2, n) lengths of the bars, or None without bars. some: of these points only
    some are drawn.
    """

    x: object
    y: object
    error: object = None
    x_error: object = None
    some: bool = False


def column(dataset, x, y, some=False):
    """The points of columns x, y and y_error."""
    return Points(dataset[x], dataset[y], dataset[f"{y}_error"], some=some)


def estimates(dataset, name):
    """(2, ...) the values of a variable and their errors."""
    return np.stack([dataset[name].values, dataset[f"{name}_error"].values])


def shows(axis, *expected):
    """Assert that a panel's points are these series, in order."""
    drawn = [one for one in axis.containers if isinstance(one, ErrorbarContainer)]
    assert len(drawn) == len(expected)
    for container, points in zip(drawn, expected, strict=True):
        _same(container, points)


def _same(container, points):
    x, y = (np.asarray(values, dtype=float) for values in container.lines[0].get_data())
    wanted = [np.ravel(np.asarray(values, dtype=float)) for values in (points.x, points.y)]
    errors = [_bars(values, wanted[0].size) for values in (points.x_error, points.error)]
    if points.some:
        assert x.size > 1
        at = [np.flatnonzero(np.isclose(wanted[0], place, rtol=1e-12))[0] for place in x]
        wanted, errors = [values[at] for values in wanted], [bar and [e[at] for e in bar] for bar in errors]
    _close(x, wanted[0])
    _close(y, wanted[1])
    bars = list(container.lines[2])
    for values, error, coordinate in zip(wanted, errors, (0, 1), strict=True):
        assert (container.has_xerr, container.has_yerr)[coordinate] == (error is not None)
        if error is not None:
            ends = np.array([path.vertices[:, coordinate] for path in bars.pop(0).get_paths()])
            known = np.isfinite(ends.reshape(-1, 2)).all(axis=1)
            _close(
                ends.reshape(-1, 2)[known], np.stack([values - error[0], values + error[1]], axis=1)[known]
            )
            assert np.array_equal(known, np.isfinite(values + error[0] + error[1]))


def _bars(error, size):
    """Lengths of error bars below and above."""
    if error is None:
        return None
    lengths = np.asarray(error, dtype=float)
    return list(np.broadcast_to(lengths.ravel() if lengths.size == size else lengths, (2, size)))


def _close(drawn, wanted):
    np.testing.assert_allclose(drawn, wanted, rtol=1e-9, atol=1e-12)


def lines(axis):
    """The lines of a panel that are drawn in its coordinates and belong to no series of points."""
    parts = {
        part
        for one in axis.containers
        if isinstance(one, ErrorbarContainer)
        for part in (one.lines[0], *one.lines[1])
    }
    return [one for one in axis.lines if one not in parts and one.get_transform() is axis.transData]


def follows(drawn, x, y):
    """Assert that a line goes through these points (n,)."""
    _close(np.asarray(drawn.get_xdata(), dtype=float), np.asarray(x, dtype=float))
    _close(np.asarray(drawn.get_ydata(), dtype=float), np.asarray(y, dtype=float))
