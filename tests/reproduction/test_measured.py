"""The table of numbers that this program has measured."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from measured import COLUMNS, reference_values
from relaxation import relaxation
from reproduction.figures.test_virial import equation_of_state

import gaspart
from gaspart import theory


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


# A short run of the program for the tables of relaxing speeds, against them.


@pytest.mark.parametrize(("dimension", "exact"), [(2, 2.0), (3, 5.0 / 3.0)])
def test_relaxing_speeds_are_those_of_the_table(dimension, exact):
    """Within 4.5 standard errors of 200 000 particles: 0.003 for the kurtosis, near 0.001 for the part that
    was never hit. The last rows are Maxwell's."""
    count = 200_000
    table = np.loadtxt(
        Path(gaspart.__file__).parent / f"theory/data/relaxation_{dimension}d.csv", delimiter=",", skiprows=1
    )
    collisions, kurtosis, missed, speed = relaxation(dimension, count, 14.0, seed=1).T
    inside = collisions < table[-1, 1]
    known = [np.interp(collisions[inside], table[:, 1], table[:, k]) for k in (2, 4, 5)]
    error = 4.5 / np.sqrt(count)
    assert inside.sum() > 20
    assert np.abs(kurtosis[inside] - known[0]).max() < 1.5 * error
    assert np.abs(missed[inside] - known[1]).max() < 0.5 * error + 1e-3
    assert np.abs(speed[inside] - known[2]).max() < 0.5 * error
    assert kurtosis[-1] == pytest.approx(exact, abs=0.02)
