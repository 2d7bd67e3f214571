"""Tables of figures: made from the columns of points, read by attributes, claimed row by row."""

from copy import copy

import numpy as np
import pytest
import xarray as xr

from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.table import Table, each, entries, from_rows, merge_with_prefixes, table

COMMON = {"source": "theory at {eta:.2g}", "fails_if": "it is wrong", "required": 0.1}


def columns(n, scale):
    return {
        "eta": scale * n,
        "dimension": 2 + n % 2,
        "gas": "dense" if n > 2 else "dilute",
        "Z": Estimate(1.0 + n, 0.1 * n, 10),
        "expected": (1.1 + n, 0.01),
        "profile": Estimate(np.full(3, n), np.ones(3), n),
    }


def gases(numbers=(3, 1, 2)):
    return table("point", numbers, columns, 0.125, inner=("bin",), units={"Z": "pressure"})


def test_estimates_and_pairs_become_variables_with_their_uncertainties():
    dataset = gases()
    assert dataset["Z_error"].values.tolist() == [pytest.approx(0.1 * n) for n in (3, 1, 2)]
    assert dataset["profile_freedom"].dims == ("point", "bin") and "expected_freedom" not in dataset
    assert dataset["Z_error"].attrs["units"] == "pressure" and dataset["Z_freedom"].attrs["units"] == "1"


def test_columns_are_attributes_and_so_are_those_of_a_row():
    rows = Table(gases().assign_attrs(order=np.int64(4)), "point")
    z = rows.Z
    assert z == Estimate([4.0, 2.0, 3.0], gases()["Z_error"].values, 10)
    assert rows.profile[0] == Estimate(np.full(3, 3.0), 1.0, 3)
    assert rows.eta.tolist() == [0.375, 0.125, 0.25] and rows.order == 4
    row = rows[1]
    assert z[1] == row.Z and (row.eta, row.gas, row.dimension) == (0.125, "dilute", 3)
    assert [one.eta for one in rows] == rows.eta.tolist() and copy(rows).eta.size == 3
    assert "{gas}, {dimension}".format_map(row) == "dilute, 3"
    with pytest.raises(AttributeError, match="pressure: no such column"):
        _ = rows.pressure


def test_tables_with_different_rows_have_one_data_set():
    dataset = merge_with_prefixes(gas=from_rows("gas", [{"eta": 1.0}]), point=gases()).assign_attrs(order=4)
    rows, none = Table.from_prefixed(dataset, "point"), Table.from_prefixed(dataset, "other")
    assert dataset["point_Z"].sizes == {"point": 3} and Table.from_prefixed(dataset, "gas").eta.tolist() == [
        1.0
    ]
    assert rows.Z == Table(gases(), "point").Z and rows.order == 4 and not none
    with pytest.raises(AttributeError, match="gas_eta: no such column"):
        _ = rows.gas_eta


def test_rows_are_chosen_sorted_and_grouped():
    rows = Table(gases(), "point")
    assert rows[rows.eta > 0.2].eta.tolist() == [0.375, 0.25]
    assert rows.sorted_by("eta").Z.value.tolist() == [2.0, 3.0, 4.0]
    assert rows.sorted_by("dimension", "eta").eta.tolist() == [0.25, 0.125, 0.375]
    groups = [(dimension, gas, part.eta.tolist()) for dimension, gas, part in rows.by("dimension", "gas")]
    assert groups == [(2, "dilute", [0.25]), (3, "dense", [0.375]), (3, "dilute", [0.125])]
    assert [part.eta.tolist() for _, part in rows.by(rows.eta > 0.2)] == [[0.125], [0.375, 0.25]]
    assert not rows[rows.eta > 1.0] and not list(rows[:0].by("dimension"))
    assert not Table(xr.Dataset(), "point") and list(Table(xr.Dataset(), "point")) == []


def test_rows_lie_along_the_dimension_of_the_table_first():
    dataset = gases().transpose("bin", "point")
    assert Table(dataset, "point").profile.value.shape == (3, 3)
    assert Table(dataset, "bin").profile[0].value.tolist() == [3.0, 1.0, 2.0]


def test_each_row_has_its_claim():
    rows = Table(gases(), "point")
    claims = each(
        rows, "Z of a {gas} gas, {eta:.2f}", measured=rows.Z, expected=rows.expected,
        allowance_source="another theory", no_verdict=np.where(rows.dimension == 2, "a disc", ""), **COMMON,
    )  # fmt: skip
    assert [claim.claim for claim in claims] == [
        "Z of a dense gas, 0.38",
        "Z of a dilute gas, 0.12",
        "Z of a dilute gas, 0.25",
    ]
    assert [claim.measured for claim in claims] == list(rows.Z)
    assert [claim.expected for claim in claims] == list(rows.expected)
    assert [claim.no_verdict for claim in claims] == ["", "", "a disc"]
    assert claims[2].source == "theory at 0.25" and type(claims[0].no_verdict) is str
    bounds = each(rows, "Z", Claim.at_least, measured=rows.Z, bound=[1, 2, 3], **COMMON)
    assert [claim.claim for claim in bounds] == [f"Z (at least {n})" for n in (1, 2, 3)]
    assert each(rows[:0], "Z", measured=rows.Z[:0], expected=1.0, **COMMON) == []


def test_numbers_that_are_not_one_for_each_row_are_refused():
    rows = Table(gases(), "point")
    with pytest.raises(ValueError, match="expected: 2 values for 3 rows"):
        each(rows, "Z", measured=rows.Z, expected=[1.0, 2.0], **COMMON)


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


def test_a_row_has_no_replicas_that_only_other_rows_have():
    rows = [{"z": np.array([1.0, 2.0])}, {"z": np.array([3.0])}, {"z": np.nan}]
    few, fewer, none = Table(from_rows("gas", rows, ("gas_replica",)), "gas")
    assert few.z.tolist() == [1.0, 2.0] and fewer.z.tolist() == [3.0] and np.isnan(none.z).all()


def test_degrees_of_freedom_may_be_one_number_for_an_array():
    row = {"a": np.ones(2), "a_error": np.ones(2), "a_freedom": 3}
    ds = from_rows("gas", [row], {"a": ("bin",)})
    assert ds["a_freedom"].dims == ("gas",) and Table(ds, "gas").a.freedom.tolist() == [[3.0, 3.0]]


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
    assert ds["b"].values.tolist() == [[1.0, 1.0]] and ds["b_error"].values.tolist() == [[0.0, 0.0]]
    assert entries({"b": (1.0, 0.5)}, 3) == {"b": 1.0, "b_error": 0.5, "b_freedom": 3}
