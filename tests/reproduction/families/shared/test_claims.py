import xarray as xr

from gaspart.reproduction.families.shared.claims import rows


def test_rows_are_the_positions_along_a_dimension():
    dataset = xr.Dataset({"Z": ("point", [1.0, 2.0])})
    assert [float(row["Z"]) for row in rows(dataset, "point")] == [1.0, 2.0]
    assert rows(dataset, "fit") == []
