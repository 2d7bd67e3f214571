import numpy as np
import pytest
import xarray as xr
from matplotlib.patches import StepPatch
from reproduction.families.drawn import Points, column, draw, follows, lines, shows, varied
from reproduction.families.speeds.data import relaxation_measurement

from gaspart import theory
from gaspart.reproduction.families.speeds import figure as speeds


def distribution(dimension, points):
    """What `measure.distribution` gives of gases in equilibrium."""
    edges, steps = np.linspace(0.0, 2.5, 21), np.linspace(0.0, 2.5, 51)
    expected = np.diff(theory.maxwell_cdf(edges, dimension, 1 / dimension)) / np.diff(edges)
    bins, columns = ("point", "bin"), ("point", "step")
    return xr.Dataset(
        {
            "density": (bins, np.tile(expected, (points, 1))),
            "density_error": (bins, np.full((points, 20), 0.01)),
            "residual": (bins, np.ones((points, 20))),
            "difference": (columns, np.full((points, 51), 0.01)),
            "samples": ("point", np.full(points, 1000)),
            "packing_fraction": ("point", 0.1 * np.arange(1, points + 1)),
            "engine": ("point", ["event"] * points),
        },
        coords={"lower": ("bin", edges[:-1]), "upper": ("bin", edges[1:]), "speed": ("step", steps)},
        attrs={"dimension": dimension},
    )


def test_histograms_kurtosis_and_the_fraction_never_hit():
    ds = varied(relaxation_measurement())
    histograms, kurtosis, kurtosis_residual, unhit, unhit_residual = draw(speeds.speed_relaxation, ds).axes
    middle = 0.5 * (ds["lower"] + ds["upper"])
    event, step = (ds.sel(engine=name) for name in ("event", "step"))
    shows(histograms, *(Points(middle, event["density"][k], event["density_error"][k]) for k in range(3)))
    outlines = [patch.get_data() for patch in histograms.patches if isinstance(patch, StepPatch)]
    for k, (values, edges, _) in enumerate(outlines):
        assert values == pytest.approx(step["density"][k].values)
        assert edges[:-1] == pytest.approx(ds["lower"].values)
    assert len(outlines) == 3
    relaxation = theory.relaxation(3)
    rows = [one.isel(frame=slice(1, None)) for one in (step, event)]
    for top, bottom, name in (
        (kurtosis, kurtosis_residual, "kurtosis"),
        (unhit, unhit_residual, "never_hit"),
    ):
        curve = getattr(relaxation, name)
        shows(top, *(column(row, "collisions", name) for row in rows))
        sigmas = [(row[name] - curve(row["collisions"])) / row[f"{name}_error"] for row in rows]
        shows(bottom, *(Points(row["collisions"], s) for row, s in zip(rows, sigmas, strict=True)))


@pytest.mark.parametrize(
    ("function", "dimension", "points"),
    [(speeds.speed_distribution_spheres, 3, 3), (speeds.speed_distribution_discs, 2, 1)],
)
def test_density_residuals_tails_and_the_difference_of_the_distribution(function, dimension, points):
    ds = varied(distribution(dimension, points), "packing_fraction")
    ds["density"][:, -1] = 0.0  # a bin in which nothing was seen
    density, residual, tail, difference = draw(function, ds).axes
    middle, width = 0.5 * (ds["lower"] + ds["upper"]), 0.125
    rows = [ds.isel(point=k) for k in range(points)]
    beside = [middle + width * 0.25 * (k - 0.5 * (points - 1)) for k in range(points)]
    shows(density, *(Points(middle, row["density"], row["density_error"]) for k, row in enumerate(rows)))
    shows(residual, *(Points(beside[k], row["residual"]) for k, row in enumerate(rows)))
    seen = [row.isel(bin=slice(-1)) for row in rows]
    shows(tail, *(Points(beside[k][:-1], row["density"], row["density_error"]) for k, row in enumerate(seen)))
    for k, row in enumerate(rows):
        follows(lines(difference)[k], ds["speed"], 1000**0.5 * row["difference"])
