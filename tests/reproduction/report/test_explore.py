"""The data of what a reader may vary on the page."""

import json

import numpy as np
import pytest
import xarray as xr

from gaspart.reproduction.report.explore import costs, series
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


def test_the_costs_are_those_of_the_model_by_engine():
    dims = ("gas", "observable", "count", "accuracy", "engine")
    seconds = np.arange(16.0).reshape(1, 2, 2, 2, 2)
    seconds[0, 1, 1, 1, 1] = np.nan
    dataset = xr.Dataset(
        {"model": (dims, seconds), "gas_dimension": ("gas", [3]), "gas_packing_fraction": ("gas", [0.2])},
        coords={
            "observable": ["Z", "D"],
            "count": [10, 20],
            "accuracy": [0.1, 0.01],
            "engine": ["event", "step"],
        },
    )
    found = costs(dataset)
    assert [one["name"].split()[:3] for one in found] == [
        [name, "of", str(count)] for count in (10, 20) for name in ("Z", "D")
    ]
    assert found[0]["seconds"] == {"event": [0.0, 2.0], "step": [1.0, 3.0]}
    assert found[3]["seconds"] == {"event": [12.0, 14.0], "step": [13.0, None]}
