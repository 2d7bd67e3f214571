"""The data of what a reader may choose on the page."""

import json

import numpy as np
import pytest
import xarray as xr

from gaspart.reproduction.families.tradeoff.choices import ENGINES, PARTS
from gaspart.reproduction.families.tradeoff.figure import NAMES
from gaspart.reproduction.report.explore import engines, series
from gaspart.theory.state import compressibility_factor


def test_the_series_reach_the_equation_of_state_where_it_is_dilute():
    at = xr.Dataset(
        {"Z": ("packing_fraction", [1.5]), "Z_error": ("packing_fraction", [np.nan])},
        coords={"packing_fraction": [0.1]},
    )
    found = series({"first": at, "second": at}, {"first": (2, 0.65), "second": (3, 0.49)})
    assert [one["name"] for one in found] == ["discs", "spheres"]
    for dimension, one in zip((2, 3), found, strict=True):
        n = np.argmin(np.abs(np.array(one["packing_fraction"]) - 0.1))
        z = float(compressibility_factor(one["packing_fraction"][n], dimension))
        assert one["sums"][0] == [1.0] * 101
        assert one["sums"][9][n] == pytest.approx(z, rel=1e-5) == one["reference"][n]
        assert one["measured"] == [[0.1], [1.5], [None]]
        assert "NaN" not in json.dumps(one)


def test_costs_and_errors_of_all_engines_are_those_of_the_map():
    """Two observables, of which one was measured at one of two packing fractions."""
    shape = (2, 2, 3, len(ENGINES))
    cost = np.arange(1.0, 1.0 + np.prod(shape)).reshape(shape)
    cost[1, 0] = np.nan  # nothing was run
    cost[0, 0, 0, 1], cost[0, 0, 0, 2] = np.inf, np.nan  # out of reach; not run
    error = np.full((*shape, len(PARTS)), 0.00123456)
    error[0, 0, 0, 2] = np.nan
    dims = ("quantity", "fraction", "accuracy", "solver")
    dataset = xr.Dataset(
        {"cost": (dims, cost), "error": ((*dims, "part"), error)},
        coords={
            "quantity": ["Z", "D"],
            "fraction": [0.01, 0.3],
            "accuracy": [0.1, 0.01, 0.001],
            "solver": list(ENGINES),
            "part": list(PARTS),
            "count": [1000, 10000],
        },
    )
    found = engines(dataset)
    assert found["count"] == 1000 and found["accuracies"] == [0.1, 0.01, 0.001]
    assert [one["name"] for one in found["engines"]] == [NAMES[engine] for engine in ENGINES]
    z, d = found["observables"]
    assert (z["name"], z["fractions"], d["fractions"]) == ("compressibility factor Z", [0.01, 0.3], [0.3])
    assert z["cost"][0][0] == [1.0, -1.0, None, 4.0] and d["cost"] == [cost[1, 1].tolist()]
    assert z["error"][0][0][0] == [0.00123] * len(PARTS) and z["error"][0][0][2] == [None] * len(PARTS)
    assert "NaN" not in json.dumps(found) and "Infinity" not in json.dumps(found)
