import numpy as np
import pytest
import xarray as xr
from matplotlib.patches import StepPatch
from reproduction.families.drawn import Points, column, draw, follows, line, lines, obeys, shows, varied
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
    shows(
        histograms, "speed", "probability density",
        *(Points(None, middle, event["density"][k], event["density_error"][k]) for k in range(3)),
    )  # fmt: skip
    outlines = [patch for patch in histograms.patches if isinstance(patch, StepPatch)]
    for k, patch in enumerate(outlines):
        values, edges, _ = patch.get_data()
        assert values == pytest.approx(step["density"][k].values)
        assert edges[:-1] == pytest.approx(ds["lower"].values)
        assert f"t={float(ds['time'][ds['shown'][k]]):g}" in patch.get_label()
    assert len(outlines) == 3
    obeys(line(histograms, "Maxwell"), lambda u: theory.maxwell_pdf(u, 3, 1 / 3))
    relaxation = theory.relaxation(3)
    for top, bottom, name, curve, labels, y_label in (
        (kurtosis, kurtosis_residual, "kurtosis", relaxation.kurtosis, (None, None), "kurtosis"),
        (unhit, unhit_residual, "never_hit", relaxation.never_hit, ("stepped", "event"), "never hit"),
    ):
        rows = [one.isel(frame=slice(1, None)) for one in (step, event)]
        shows(
            top, "", y_label,
            *(column(row, label, "collisions", name) for row, label in zip(rows, labels, strict=True)),
        )  # fmt: skip
        obeys(lines(top)[0], curve)
        sigmas = [
            Points(None, row["collisions"], (row[name] - curve(row["collisions"])) / row[f"{name}_error"])
            for row in rows
        ]
        shows(bottom, "", "residual", *sigmas)
    assert "collisions per particle" in unhit_residual.get_xlabel()


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
    shows(
        density, "", "probability density",
        *(
            Points(f"$\\eta={0.1 * (k + 1):.2g}$, event", middle, row["density"], row["density_error"])
            for k, row in enumerate(rows)
        ),
    )  # fmt: skip
    shows(
        residual, "", "residual",
        *(Points(None, beside[k], row["residual"]) for k, row in enumerate(rows)),
    )  # fmt: skip
    shows(
        tail, "", "probability density",
        *(
            Points(None, beside[k][:-1], row["density"][:-1], row["density_error"][:-1])
            for k, row in enumerate(rows)
        ),
    )  # fmt: skip
    assert tail.get_yscale() == "log"
    for axis in (density, tail):
        obeys(lines(axis)[0], lambda u: theory.maxwell_pdf(u, dimension, 1 / dimension))
    for k, row in enumerate(rows):
        follows(lines(difference)[k], ds["speed"], 1000**0.5 * row["difference"])
    assert "speed" in difference.get_xlabel() and "difference" in difference.get_ylabel()
