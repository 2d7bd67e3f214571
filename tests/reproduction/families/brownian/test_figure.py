import numpy as np
import xarray as xr
from reproduction.families.drawn import Points, column, draw, follows, lines, shows, varied

from gaspart import theory
from gaspart.reproduction.families.brownian import figure as brownian


def rows(**values):
    light = {name: [False, True] for name in ("equal_speeds", "stepped", "is_light")}
    gases = {"mass": [100.0, 1.0], "gas_mass": [1.0, 1.0], "radius": [10.0, 10.0]}
    runs = {"duration": [580.0, 300.0], "friction": [0.05, 0.1]}
    columns = {name: ("point", column) for name, column in {**light, **gases, **runs}.items()}
    return xr.Dataset(values | columns)


def test_displacements_and_velocities_are_drawn_with_their_deviations():
    time = np.linspace(0.0, 8.0, 81) * np.array([[1.0], [0.9]])
    msd, vacf, error = theory.langevin_msd(time, 1 / 6, 1.0), np.exp(-time), np.full(time.shape, 0.01)
    curves = {"time": time, "msd": msd, "msd_error": error, "vacf": vacf, "vacf_error": error}
    curves |= {"expected_msd": 0.93 * msd, "expected_vacf": 0.93 * vacf}
    ds = rows(**{name: (("point", "lag"), values) for name, values in curves.items()})
    ds = varied(ds, "time", "mass", "gas_mass")
    for name in curves:
        ds[name][1, 70:] = np.nan  # a shorter run has fewer lags
    msd, ratio, vacf, difference = draw(brownian.brownian_msd, ds).axes
    first, second = ds.isel(point=0), ds.isel(point=1, lag=slice(70))
    shows(msd, column(first, "time", "msd", some=True), column(second, "time", "msd", some=True))
    shows(vacf, column(first, "time", "vacf", some=True), column(second, "time", "vacf", some=True))
    relative, absolute = [], []
    for row in (first, second):
        curve = np.maximum(theory.langevin_msd(row["time"], 1 / 6, 1.0), 1e-300)
        relative.append(Points(row["time"], row["msd"] / curve - 1.0, row["msd_error"] / curve, some=True))
        absolute.append(Points(row["time"], row["vacf"] - np.exp(-row["time"]), row["vacf_error"], some=True))
    shows(ratio, *relative)
    shows(difference, *absolute)


def test_paths_are_drawn_from_above_and_start_in_the_middle():
    way = np.cumsum(np.random.default_rng(1).standard_normal((2, 4, 50, 3)), axis=2)
    way -= way[:, :, :1]
    way[1, :, 40:] = np.nan
    ds = rows(way=(("point", "path", "frame", "axis"), way))
    for index, axis in enumerate(draw(brownian.brownian_paths, ds).axes):
        paths = [one for one in lines(axis) if len(one.get_xdata()) > 1]
        for path, one in zip(way[index], paths, strict=True):
            follows(one, path[:, 0], path[:, 1])
