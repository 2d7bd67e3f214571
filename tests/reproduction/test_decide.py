"""More effort for what open claims depend on, whatever their deviations are."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from gaspart.analysis.estimate import Estimate
from gaspart.errors import SceneError
from gaspart.reproduction import decide
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.config import EFFORTS, keep_efforts, read_efforts, write_efforts
from gaspart.reproduction.decide import Open, find_open, next_efforts
from gaspart.reproduction.points.points import effort_of

BLOCK = {"experiments": ["hot", "cold"]}


def stated(figure, block, data):
    """A claim on each row, and one on the last two together."""
    values, errors = data.Z.values, data.Z_error.values
    both = Estimate(values[1:].mean(), float(np.hypot(*errors[1:]) / 2.0))
    rows = [("mean of the last two", both)]
    rows += [(f"row {n}", Estimate(*row)) for n, row in enumerate(zip(values, errors, strict=True))]
    return [Claim(text, measured, 1.0, 0.01, "exact", "nothing") for text, measured in rows]


def measured(shift=0.0, errors=(0.005, 0.02, 0.03)):
    made = ["hot/T=2", "cold/T=1", "cold/T=0.5\ncold/T=0.4"]
    columns = {
        "Z": np.ones(3) + shift * np.array(errors),
        "Z_error": np.array(errors),
        "row_made_of": np.array(made),
    }
    return xr.Dataset({name: ("row", values) for name, values in columns.items()})


@pytest.fixture(autouse=True)
def _claims(monkeypatch):
    monkeypatch.setattr(decide, "claims_of", stated)


def test_a_claim_is_open_by_its_uncertainty_and_needs_what_its_experiments_need():
    found = find_open("figure", BLOCK, measured(), {"hot": 0.25, "cold": 0.5})
    cold = frozenset({"cold"})
    assert [(one.claim, one.experiments) for one in found] == [
        ("mean of the last two", cold), ("row 1", cold), ("row 2", cold),
    ]  # fmt: skip
    assert [one.effort for one in found] == pytest.approx([0.5 * 3.25, 2.0, 4.5])


@pytest.mark.parametrize("shift", [-50.0, 3.0, 50.0])
def test_deviations_change_nothing(shift):
    present = {"hot": 1.0, "cold": 1.0}
    assert find_open("figure", BLOCK, measured(shift), present) == find_open(
        "figure", BLOCK, measured(), present
    )


def test_a_claim_whose_rows_are_not_known_depends_on_all_experiments():
    data = measured().drop_vars("row_made_of")
    found = find_open("figure", BLOCK, data, {"hot": 1.0, "cold": 2.0})
    assert {one.experiments for one in found} == {frozenset({"hot", "cold"})}


def test_efforts_are_doubled_up_to_the_most_and_hopeless_claims_are_left():
    present = {"a": 0.25, "b": 3.0, "c": 4.0, "d": 1.0}
    undecided = [
        Open("f", "1", frozenset({"a", "b"}), 1.0),
        Open("f", "2", frozenset({"c"}), 5.0),
        Open("f", "3", frozenset({"d"}), 8.5),
    ]
    assert next_efforts(undecided, present) == {"a": 0.5, "b": 4.0}
    assert next_efforts(undecided[1:], present) == {}


def test_points_keep_the_largest_effort_with_which_they_were_made(tmp_path):
    config = {
        "effort": 0.25,
        "experiments": {"a": {}, "b": {"effort": 2.0}, "c": {}, "d": {"least_effort": 0.5}},
    }
    write_efforts(tmp_path, {"a": 1.0, "b": 1.0})
    write_efforts(tmp_path, {"c": 0.25, "removed": 4.0})
    assert keep_efforts(config, tmp_path) == {"a": 1.0}
    assert [effort_of(config, name) for name in "abcd"] == [1.0, 2.0, 0.25, 0.5]
    assert keep_efforts(config, tmp_path / "none") == {}


def test_efforts_that_cannot_be_read_are_named_with_their_file(tmp_path):
    (tmp_path / EFFORTS).write_text("a: much\n")
    with pytest.raises(SceneError) as caught:
        read_efforts(tmp_path)
    assert (caught.value.key, caught.value.file) == ("a", str(tmp_path / EFFORTS))
