"""The bounds within which theory of transport is claimed, and the fit of the transfer at collisions."""

import numpy as np
import pytest
import xarray as xr

from gaspart.reproduction.figures import dsmc, transport
from gaspart.reproduction.table import Table, entries, from_rows


@pytest.mark.parametrize(
    ("dimension", "eta", "subjects"),
    [
        (3, 0.01, ["viscosity over Chapman", "growth by", "bulk viscosity over"]),
        (3, 0.3, ["viscosity over Enskog", "growth by", "bulk viscosity over"]),
        (3, 0.45, ["growth by"]),
        (2, 0.01, ["viscosity over Chapman", "growth by", "bulk viscosity over"]),
        (2, 0.4, ["growth by"]),
    ],
)
def test_theory_has_a_verdict_only_where_it_is_known(dimension, eta, subjects):
    row = {"dimension": dimension, "packing_fraction": eta, "count": 256, "finite": 0.99}
    row |= entries(dict.fromkeys(("value", "growth", "bulk", "difference"), (1.0, 0.01)))
    claims = [one for one in transport.claim_viscosity(from_rows("point", [row])) if not one.no_verdict]
    assert [one.claim[: len(text)] for one, text in zip(claims, subjects, strict=True)] == subjects


def test_the_transfer_is_fitted_where_cells_are_narrow_and_steps_short():
    width, step = np.array([0.2, 0.3, 0.4, 0.5, 2.0]), np.array([0.1, 0.4, 0.1, 0.8, 0.1])
    transfer = np.where(width < 1.0, width**2 * (0.1132 - 0.03 * width - 0.02 * step), 9.0)
    columns = {"part": ["fluxes"] * 5, "width": width, "step": step, "transfer": transfer}
    ds = xr.Dataset({name: ("point", values) for name, values in columns.items()})
    ds["transfer_error"] = 0.01 * ds["transfer"]
    fit = dsmc._fit_transfer(Table(ds, "point"))
    assert [found.value for found in fit.values()] == pytest.approx([0.1132, -0.03, -0.02])
    assert np.isnan(dsmc._fit_transfer(Table(ds.isel(point=[0, 1, 4]), "point"))["coefficient"].value)
