import numpy as np

from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.families.shared.rows import entries, estimates, from_rows


def test_shorter_arrays_and_absent_numbers_are_nan():
    ds = from_rows("point", [{"a": 1.0, "b": np.ones(3, dtype=int)}, {"b": np.zeros(2), "c": 2}], ("lag",))
    assert ds["a"].dims == ds["c"].dims == ("point",)
    assert ds["b"].dims == ("point", "lag")
    np.testing.assert_array_equal(ds["b"].values[0], 1.0)
    np.testing.assert_array_equal(ds["b"].values[1], [0.0, 0.0, np.nan])
    np.testing.assert_array_equal(ds["a"].values, [1.0, np.nan])
    np.testing.assert_array_equal(ds["c"].values, [np.nan, 2.0])
    assert not ds["a"].attrs


def test_a_row_without_an_array_has_nan_in_its_place():
    ds = from_rows("point", [{"b": np.ones((1, 2))}, {"b": np.nan}], ("path", "frame"))
    np.testing.assert_array_equal(ds["b"].values, [[[1.0, 1.0]], [[np.nan, np.nan]]])


def test_dimensions_and_units_are_those_of_the_key_without_error():
    row = {"a": np.ones(2), "a_error": np.ones(2), "b": np.ones(3), "count": 5, "name": "x"}
    ds = from_rows("gas", [row, row], {"a": ("bin",), "b": ("step",)}, {"a": "length"})
    assert ds["a_error"].dims == ("gas", "bin")
    assert ds["b"].dims == ("gas", "step")
    units = {name: variable.attrs.get("units") for name, variable in ds.data_vars.items()}
    assert units == {"a": "length", "a_error": "length", "b": "1", "count": "1", "name": None}
    assert ds["count"].dtype.kind == "i"
    assert ds["name"].values.tolist() == ["x", "x"]


def test_entries_are_what_an_estimate_is_read_from():
    number = Estimate(2.0, 0.1, 7)
    ds = from_rows("point", [entries({"a": number, "b": (np.ones(2), np.zeros(2))})], ("bin",))
    assert list(ds) == ["a", "a_error", "a_freedom", "b", "b_error"]
    assert Estimate.of(ds.isel(point=0), "a") == number
    np.testing.assert_array_equal(estimates(ds, "b"), [[[1.0, 1.0]], [[0.0, 0.0]]])
    assert entries({"b": (1.0, 0.5)}, 3) == {"b": 1.0, "b_error": 0.5, "b_freedom": 3}
