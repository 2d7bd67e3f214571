import numpy as np
import pytest
import xarray as xr
from experiments.speeds.data import relaxation_measurement

from gaspart import theory
from gaspart.experiments.speeds import figure as speeds
from gaspart.rendering import style


def distribution(dimension, points):
    """What `measure.distribution` gives of gases in equilibrium."""
    edges, steps = np.linspace(0.0, 2.5, 21), np.linspace(0.0, 2.5, 51)
    expected = np.diff(theory.maxwell_cdf(edges, dimension, 1 / dimension)) / np.diff(edges)
    bins, columns = ("point", "bin"), ("point", "step")
    return xr.Dataset(
        {
            "density": (bins, np.tile(expected, (points, 1))),
            "density_error": (bins, np.full((points, 20), 0.01)),
            "residual": (bins, np.zeros((points, 20))),
            "difference": (columns, np.zeros((points, 51))),
            "samples": ("point", np.full(points, 1000)),
            "packing_fraction": ("point", 0.1 * np.arange(1, points + 1)),
            "engine": ("point", ["event"] * points),
        },
        coords={"lower": ("bin", edges[:-1]), "upper": ("bin", edges[1:]), "speed": ("step", steps)},
        attrs={"dimension": dimension},
    )


def test_relaxation_shows_histograms_curves_and_residuals(tmp_path):
    with style.applied():
        figure = speeds.speed_relaxation(relaxation_measurement())
        style.save(figure, tmp_path / "relaxation.png")
    labels = [axis.get_ylabel() for axis in figure.axes]
    assert len(labels) == 5 and sum("residual" in label for label in labels) == 2
    theory_line = figure.axes[1].lines[0]
    assert theory_line.get_ydata()[0] == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("draw", "dimension", "points"),
    [(speeds.speed_distribution_spheres, 3, 3), (speeds.speed_distribution_discs, 2, 1)],
)
def test_distribution_shows_density_cumulative_and_residuals(tmp_path, draw, dimension, points):
    with style.applied():
        figure = draw(distribution(dimension, points))
        style.save(figure, tmp_path / "distribution.svg")
    assert len(figure.axes) == 4
    curve = figure.axes[0].lines[0]
    assert curve.get_ydata() == pytest.approx(theory.maxwell_pdf(curve.get_xdata(), dimension, 1 / dimension))
