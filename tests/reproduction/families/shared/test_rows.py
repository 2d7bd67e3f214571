import numpy as np

from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.families.shared.rows import entries, estimates, from_rows


def test_entries_are_what_an_estimate_is_read_from():
    number = Estimate(2.0, 0.1, 7)
    ds = from_rows("point", [entries({"a": number, "b": (np.ones(2), np.zeros(2))})], ("bin",))
    assert list(ds) == ["a", "a_error", "a_freedom", "b", "b_error"]
    assert Estimate.of(ds.isel(point=0), "a") == number
    np.testing.assert_array_equal(estimates(ds, "b"), [[[1.0, 1.0]], [[0.0, 0.0]]])
    assert entries({"b": (1.0, 0.5)}, 3) == {"b": 1.0, "b_error": 0.5, "b_freedom": 3}
