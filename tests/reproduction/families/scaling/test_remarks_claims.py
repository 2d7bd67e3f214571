"""The claims about source A's remarks hold on a machine of known costs, and fail on falsified data."""

import pytest
from reproduction.claims.data import judged

from gaspart.reproduction.families.scaling.claims import remarks


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("near_box_visits", 14.0, "searched within reach"),
        ("near_missed", 1.0, "difference of the contacts"),
        ("own_first", 0.1, "end in the own box"),
        ("huge_tests", 0.0, "pairs tested more"),
    ],
)
def test_false_remarks_are_noticed(name, value, text, dataset):
    ds = dataset("box_count")
    ds[name] = ds[name] * 0.0 + value
    found = [verdict for claim, verdict in judged(remarks(ds)).items() if text in claim]
    assert found == ["disagrees"]


def test_remarks_about_time_are_decided(dataset):
    """Leaving out boxes costs more than it saves on the known machine, and a further test little."""
    found = judged(remarks(dataset("box_count")))
    decided = {
        claim: verdict for claim, verdict in found.items() if "within reach over" in claim or "huge" in claim
    }
    assert list(decided.values()) == ["agrees", "source in error", "agrees", "source in error"]
