import numpy as np
from reproduction.families.drawn import Points, draw, lines, obeys, shows, varied
from reproduction.families.wall_pressure.data import pressures

from gaspart import theory
from gaspart.reproduction.families.wall_pressure.figure import wall_pressure

NAMES = {2: "discs", 3: "spheres"}


def deviation(ds, points, shift, label):
    """100 (P / theory - 1) of some containers, with both uncertainties."""
    own = ds.isel(point=points)
    error = 100.0 * np.hypot(own["pressure_error"], own["expected_error"]) / own["expected"]
    ratio = own["pressure"] / own["expected"]
    return Points(label, own["packing_fraction"] + shift, 100.0 * (ratio - 1.0), error)


def test_pressures_against_temperature_and_density_and_their_deviation():
    ds = varied(pressures(), "density", "temperature")
    temperatures, densities, residuals = draw(wall_pressure, ds).axes
    series = ds.isel(point=[2, 8, 9]).sortby("temperature")
    t, n = series["temperature"], float(series["density"][0].round(9))
    label = f"$\\eta={series['packing_fraction'][0].item():.2g}$"
    shows(
        temperatures,
        "temperature",
        "P/",
        Points(label, t, series["pressure"] / n, series["pressure_error"] / n),
    )
    obeys(lines(temperatures)[0], lambda x: np.full_like(x, float(series["expected"][0]) / n))
    obeys(lines(temperatures)[1], np.ones_like)
    expected = []
    for dimension, name in NAMES.items():
        own = ds.isel(point=(ds["dimension"] == dimension).values)
        corrected = own["bulk_pressure"] / own["expected"] / own["density"]
        expected += [
            Points(f"{name}, $F/$wall", own["packing_fraction"], own["whole_pressure"] / own["density"]),
            Points(
                f"{name}, corrected", own["packing_fraction"], own["pressure"] * corrected,
                own["pressure_error"] * corrected,
            ),
        ]  # fmt: skip
    shows(densities, "", "P/", *expected)  # the label is below the residuals
    obeys(lines(densities)[0], lambda eta: theory.compressibility_factor(eta, 2))
    obeys(lines(densities)[1], lambda eta: theory.compressibility_factor(eta, 3))
    shows(
        residuals, "packing fraction", "theory",
        deviation(ds, [0, 1, 2, 8, 9], 0.0, "discs, slit"), deviation(ds, [6], 0.003, "discs, closed"),
        deviation(ds, [3, 4, 5], 0.0, "spheres, slit"), deviation(ds, [7], 0.003, "spheres, closed"),
    )  # fmt: skip


def test_one_dimension_without_temperatures_leaves_their_panel_empty():
    axes = draw(wall_pressure, pressures().isel(point=[0, 1, 6])).axes
    shows(axes[0], "temperature", "P/")
    assert len(axes[1].containers) == 2
