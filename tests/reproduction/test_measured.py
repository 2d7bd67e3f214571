"""The table of numbers that this program has measured."""

import numpy as np
import pytest
import xarray as xr
from reproduction.families.test_virial import equation_of_state

from gaspart import theory
from gaspart.reproduction.measured import COLUMNS, reference_values


def gases(**columns):
    """Two points of one measurement."""
    shared = {"packing_fraction": [0.1, 0.2], "count": [256, 256], "dimension": [3, 2]}
    return xr.Dataset({name: ("point", values) for name, values in (shared | columns).items()})


@pytest.fixture
def folder(tmp_path):
    for dimension, name in ((2, "virial_discs"), (3, "virial_spheres")):
        count = ("packing_fraction", np.full(10, 1000))
        equation_of_state(dimension).assign(count=count).to_netcdf(tmp_path / f"{name}.nc")
    spheres = gases(diffusion=[0.9, np.nan], diffusion_error=[0.002, np.nan])
    spheres.to_netcdf(tmp_path / "msd_spheres.nc")
    value = {
        "value": [1.01, 0.99],
        "value_error": [0.02, 0.03],
        "bulk": [1.0, 1.1],
        "bulk_error": [0.01, 0.02],
    }
    for name in ("viscosity", "conductivity"):
        gases(**value).to_netcdf(tmp_path / f"{name}.nc")
    return tmp_path


def test_every_quantity_has_its_unit_and_two_digits_of_its_error(folder):
    rows = list(reference_values(folder))
    assert all(tuple(row) == COLUMNS for row in rows)
    found = {(row["dimension"], row["quantity"], row["packing_fraction"]): row for row in rows}
    assert found[3, "diffusion", "0.1"]["value"] == "0.9000"
    assert len([row for row in rows if row["quantity"] == "diffusion"]) == 1
    viscosity = 0.99 * theory.enskog_viscosity(0.2, 2)
    assert float(found[2, "viscosity", "0.2"]["value"]) == pytest.approx(viscosity, abs=1e-3)
    assert float(found[2, "bulk_viscosity", "0.2"]["error"]) == pytest.approx(
        0.02 * theory.enskog_bulk_viscosity(0.2, 2), rel=0.05
    )
    for dimension in (2, 3):
        z, contact = (float(found[dimension, name, "0.1"]["value"]) for name in ("Z", "contact_value"))
        assert contact == pytest.approx((z - 1.0) / (2.0 ** (dimension - 1) * 0.1), rel=1e-3)


def test_a_missing_measurement_is_an_error(folder):
    (folder / "conductivity.nc").unlink()
    with pytest.raises(OSError, match="conductivity"):
        list(reference_values(folder))


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_table_of_the_package_is_near_theory(dimension):
    """Z by its errors, and dilute gases' viscosity and conductivity to some per cent."""
    rows = theory.measurements("Z", dimension)
    deviation = (rows.value - theory.compressibility_factor(rows.packing_fraction, dimension)) / np.hypot(
        rows.error, theory.compressibility_uncertainty(rows.packing_fraction, dimension)
    )
    assert 0.4 < np.sqrt(np.mean(deviation**2)) < 1.6
    for quantity, enskog in (
        ("viscosity", theory.enskog_viscosity),
        ("conductivity", theory.enskog_conductivity),
    ):
        row = theory.measurements(quantity, dimension)[0]
        assert (
            abs(row.value / enskog(row.packing_fraction, dimension) - 1.0)
            < 0.01 + 3.0 * row.error / row.value
        )
