import numpy as np
import pytest
import xarray as xr

from gaspart import theory
from gaspart.experiments.brownian import figure as brownian
from gaspart.rendering import style


def rows(**values):
    return xr.Dataset(values | {
        "experiment": ("point", ["brownian_heavy", "brownian_source"]),
        "mass": ("point", [100.0, 1.0]),
        "gas_mass": ("point", [1.0, 1.0]),
        "radius": ("point", [10.0, 10.0]),
        "duration": ("point", [580.0, 300.0]),
        "friction": ("point", [0.05, 0.1]),
    })  # fmt: skip


def test_curves_lie_on_theirs(tmp_path):
    time = np.linspace(0.0, 8.0, 81) * np.array([[1.0], [0.9]])
    ds = rows(
        time=(("point", "lag"), time),
        msd=(("point", "lag"), theory.langevin_msd(time, 1 / 6, 1.0)),
        msd_error=(("point", "lag"), np.full(time.shape, 0.01)),
        vacf=(("point", "lag"), np.exp(-time)),
        vacf_error=(("point", "lag"), np.full(time.shape, 0.01)),
    )
    with style.applied():
        figure = brownian.brownian_msd(ds)
        style.save(figure, tmp_path / "msd.png")
    for axis in (figure.axes[1], figure.axes[3]):
        for container in axis.containers:
            assert container.lines[0].get_ydata() == pytest.approx(0.0, abs=1e-12)


def test_every_path_begins_in_the_middle(tmp_path):
    way = np.cumsum(np.random.default_rng(1).standard_normal((2, 4, 50, 3)), axis=2)
    way -= way[:, :, :1]
    way[1, :, 40:] = np.nan
    with style.applied():
        figure = brownian.brownian_paths(rows(way=(("point", "path", "frame", "axis"), way)))
        style.save(figure, tmp_path / "paths.svg")
    for index, axis in enumerate(figure.axes):
        paths = [line for line in axis.lines if len(line.get_xdata()) > 1]
        assert len(paths) == 4
        for n, line in enumerate(paths):
            assert line.get_xdata() == pytest.approx(way[index, n, :, 0], nan_ok=True)
