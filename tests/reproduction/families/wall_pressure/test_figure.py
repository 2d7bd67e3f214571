import numpy as np
from reproduction.families.drawn import Points, draw, shows, varied
from reproduction.families.wall_pressure.data import pressures

from gaspart.reproduction.families.wall_pressure.figure import wall_pressure


def deviation(ds, points, shift):
    """100 (P / theory - 1) of some containers, with both uncertainties."""
    own = ds.isel(point=points)
    error = 100.0 * np.hypot(own["pressure_error"], own["expected_error"]) / own["expected"]
    ratio = own["pressure"] / own["expected"]
    return Points(own["packing_fraction"] + shift, 100.0 * (ratio - 1.0), error)


def test_pressures_against_temperature_and_density_and_their_deviation():
    ds = varied(pressures(), "density", "temperature")
    temperatures, densities, residuals = draw(wall_pressure, ds).axes
    series = ds.isel(point=[2, 8, 9]).sortby("temperature")
    t, n = series["temperature"], float(series["density"][0].round(9))
    shows(temperatures, Points(t, series["pressure"] / n, series["pressure_error"] / n))
    expected = []
    for dimension in (2, 3):
        own = ds.isel(point=(ds["dimension"] == dimension).values)
        corrected = own["bulk_pressure"] / own["expected"] / own["density"]
        expected += [
            Points(own["packing_fraction"], own["whole_pressure"] / own["density"]),
            Points(own["packing_fraction"], own["pressure"] * corrected, own["pressure_error"] * corrected),
        ]
    shows(densities, *expected)
    groups = ([0, 1, 2, 8, 9], 0.0), ([6], 0.003), ([3, 4, 5], 0.0), ([7], 0.003)
    shows(residuals, *(deviation(ds, *group) for group in groups))
    axes = draw(wall_pressure, pressures().isel(point=[0, 1, 6])).axes  # discs only, at one temperature
    shows(axes[0])
    assert len(axes[1].containers) == 2
