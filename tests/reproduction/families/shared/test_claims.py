import numpy as np
import xarray as xr

from gaspart.reproduction.families.shared.claims import deviations, rows


def test_rows_are_the_positions_along_a_dimension():
    dataset = xr.Dataset({"Z": ("point", [1.0, 2.0])})
    assert [float(row["Z"]) for row in rows(dataset, "point")] == [1.0, 2.0]
    assert rows(dataset, "fit") == []


def test_deviations_are_in_their_standard_deviations():
    dataset = xr.Dataset({"Z": ("point", [1.0, 2.0]), "Z_error": ("point", [0.3, 0.0])})
    dataset = dataset.assign(theory=("point", [2.0, 1.0]), theory_error=("point", [0.4, 0.1]))
    np.testing.assert_allclose(deviations(dataset, "Z", "theory"), [-2.0, 10.0])
