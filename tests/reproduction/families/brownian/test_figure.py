import numpy as np
import xarray as xr
from reproduction.families.drawn import Points, column, draw, follows, lines, obeys, shows, varied

from gaspart import theory
from gaspart.reproduction.families.brownian import figure as brownian


def rows(**values):
    return xr.Dataset(values | {
        "equal_speeds": ("point", [False, True]),
        "stepped": ("point", [False, True]),
        "is_light": ("point", [False, True]),
        "mass": ("point", [100.0, 1.0]),
        "gas_mass": ("point", [1.0, 1.0]),
        "radius": ("point", [10.0, 10.0]),
        "duration": ("point", [580.0, 300.0]),
        "friction": ("point", [0.05, 0.1]),
    })  # fmt: skip


def test_displacements_and_velocities_are_drawn_with_their_deviations():
    time = np.linspace(0.0, 8.0, 81) * np.array([[1.0], [0.9]])
    ds = rows(
        time=(("point", "lag"), time),
        msd=(("point", "lag"), theory.langevin_msd(time, 1 / 6, 1.0)),
        msd_error=(("point", "lag"), np.full(time.shape, 0.01)),
        vacf=(("point", "lag"), np.exp(-time)),
        vacf_error=(("point", "lag"), np.full(time.shape, 0.01)),
        expected_msd=(("point", "lag"), 0.93 * theory.langevin_msd(time, 1 / 6, 1.0)),
        expected_vacf=(("point", "lag"), 0.93 * np.exp(-time)),
    )
    ds = varied(ds, "time", "mass", "gas_mass")
    for name in ("time", "msd", "msd_error", "vacf", "vacf_error", "expected_msd", "expected_vacf"):
        ds[name][1, 70:] = np.nan  # a shorter run has fewer lags
    msd, ratio, vacf, difference = draw(brownian.brownian_msd, ds).axes
    first, second = ds.isel(point=0), ds.isel(point=1, lag=slice(70))
    shows(
        msd, "", "Delta r", column(first, "$M=100\\,m$", "time", "msd", some=True),
        column(second, "equal speeds, steps", "time", "msd", some=True),
    )  # fmt: skip
    shows(
        vacf, "", "V(t)", column(first, "$M=100\\,m$", "time", "vacf", some=True),
        column(second, "equal speeds, steps", "time", "vacf", some=True),
    )  # fmt: skip
    relative, absolute = [], []
    for row in (first, second):
        curve = np.maximum(theory.langevin_msd(row["time"], 1 / 6, 1.0), 1e-300)
        relative.append(
            Points(None, row["time"], row["msd"] / curve - 1.0, row["msd_error"] / curve, some=True)
        )
        difference_of = row["vacf"] - np.exp(-row["time"])
        absolute.append(Points(None, row["time"], difference_of, row["vacf_error"], some=True))
    shows(ratio, "time", "ratio", *relative)
    shows(difference, "time", "difference", *absolute)
    langevin = theory.langevin_msd(second["time"][1:], 1 / 6, 1.0)
    follows(lines(ratio)[-1], second["time"][1:], second["expected_msd"][1:] / langevin - 1.0)
    drawn = second.isel(lag=np.flatnonzero(second["time"] < brownian.LONGEST))
    follows(lines(difference)[-1], drawn["time"], drawn["expected_vacf"] - np.exp(-drawn["time"]))
    assert len(lines(ratio)) == len(lines(difference)) == 1  # none of the heavy particle
    obeys(lines(msd)[0], lambda t: theory.langevin_msd(t, 1 / 6, 1.0))
    obeys(lines(vacf)[0], lambda t: np.exp(-t))


def test_paths_are_drawn_from_above_and_start_in_the_middle():
    way = np.cumsum(np.random.default_rng(1).standard_normal((2, 4, 50, 3)), axis=2)
    way -= way[:, :, :1]
    way[1, :, 40:] = np.nan
    ds = rows(way=(("point", "path", "frame", "axis"), way))
    figure = draw(brownian.brownian_paths, ds)
    for index, axis in enumerate(figure.axes):
        paths = [one for one in lines(axis) if len(one.get_xdata()) > 1]
        for path, one in zip(way[index], paths, strict=True):
            follows(one, path[:, 0], path[:, 1])
        (sphere,) = axis.patches
        assert sphere.get_radius() == 10.0
        assert (axis.get_xlabel(), axis.get_ylabel()) == ("$x$ (length)", "$y$ (length)")
        assert ("M=100", "M=1\\")[index] in axis.get_title(loc="left")
