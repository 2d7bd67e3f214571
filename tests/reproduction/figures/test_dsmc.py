"""Transport coefficients of a dilute gas, and the fit of the transfer at collisions."""

import numpy as np
import pytest
import xarray as xr
from reproduction.made import simulated

from gaspart.reproduction.figures import dsmc
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table

GAS = {
    "dimension": 3, "count": 64, "radius": 0.5, "packing_fraction": 0.0025, "boundary": "periodic",
    "temperature": 1.0, "exact_temperature": True, "engine": "dsmc", "cells_per_side": 1,
    "collisions_per_particle": 600, "samples": 1200, "lags": 30, "follow": 1, "replicas": 6,
}  # fmt: skip


@pytest.mark.filterwarnings("ignore:gaspart")
def test_coefficients_of_a_gas_are_near_their_exact_values(tmp_path):
    """One cell of half a mean free path: viscosity 1.023 times, diffusion once."""
    made = {"fluxes": {"stress": True}, "paths": {"displacements": True}}
    root = str(tmp_path)
    points = [simulated(Point(name, "one", "simulate", GAS | more, root, 1)) for name, more in made.items()]
    ds = dsmc.measure(points, {"parts": {name: [name] for name in made}, "blocks": 4})
    width = float(ds["width"][0])
    assert width == pytest.approx(0.5, abs=0.01)
    expected = {
        "viscosity": 1.0 + 0.1132 * width**2, "conductivity": 1.0 + 0.0453 * width**2, "diffusion": 1.0,
    }  # fmt: skip
    for (name, value), row in zip(expected.items(), (0, 0, 1), strict=True):
        found, error = float(ds[name][row]), float(ds[f"{name}_error"][row])
        assert error < 0.15 * value
        assert abs(found - value) < 4.5 * error


def test_the_transfer_is_fitted_where_cells_are_narrow_and_steps_short():
    width, step = np.array([0.2, 0.3, 0.4, 0.5, 2.0]), np.array([0.1, 0.4, 0.1, 0.8, 0.1])
    transfer = np.where(width < 1.0, width**2 * (0.1132 - 0.03 * width - 0.02 * step), 9.0)
    columns = {"part": ["fluxes"] * 5, "width": width, "step": step, "transfer": transfer}
    ds = xr.Dataset({name: ("point", values) for name, values in columns.items()})
    ds["transfer_error"] = 0.01 * ds["transfer"]
    fit = dsmc._fit_transfer(Table(ds, "point"))
    assert [found.value for found in fit.values()] == pytest.approx([0.1132, -0.03, -0.02])
    assert np.isnan(dsmc._fit_transfer(Table(ds.isel(point=[0, 1, 4]), "point"))["coefficient"].value)
