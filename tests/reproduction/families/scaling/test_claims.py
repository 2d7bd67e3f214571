"""The scaling figures' claims hold on a machine of known costs, and fail on falsified data."""

import pytest
from reproduction.claims.data import judged
from reproduction.families.scaling.data import SCALING

from gaspart.reproduction import claims as core
from gaspart.reproduction.claims import judge
from gaspart.reproduction.families.scaling import claims as scaling
from gaspart.reproduction.families.scaling.claims import ideal_boxes, remarks


@pytest.mark.parametrize("figure", SCALING)
def test_tests_and_identities_hold_on_a_known_machine(figure, dataset, tmp_path):
    claims = getattr(scaling, figure)(dataset(figure))
    wrong = [
        claim.claim
        for claim, verdict in zip(claims, judge(claims), strict=True)
        if claim.kind != "reproduction" and verdict == "disagrees"
    ]
    assert wrong == []
    core.write(tmp_path / "claims.csv", figure, claims)
    assert len(core.read(tmp_path / "claims.csv")) == len(claims) + len(core.family_test(claims))


FALSIFIED = {
    "naive_scaling": ({"tests_excess": 0.5}, "N(N-1)/2"),
    "box_count": ({"crossing_searches": 1.0, "crossing_searches_error": 0.01}, "searched at a crossing"),
    "ideal_boxes": ({"penalty": 2.0, "penalty_error": 0.01}, "worst of all gases"),
    "linear_scaling": ({"list_share": 1.0, "list_share_error": 0.01}, "neighbour list"),
    "event_scaling": ({"pairs_excess": 0.1}, "N(N-1)/2"),
}


@pytest.mark.parametrize("figure", SCALING)
def test_claims_can_fail(figure, dataset):
    ds = dataset(figure)
    changes, text = FALSIFIED[figure]
    for name, value in changes.items():
        ds[name] = ds[name] * 0.0 + value
    found = [verdict for claim, verdict in judged(getattr(scaling, figure)(ds)).items() if text in claim]
    assert found == ["disagrees"]


def test_pair_tests_that_go_missing_are_noticed(dataset):
    ds = dataset("box_count")
    ds["pair_tests"] = 0.9 * ds.pair_tests
    assert any(
        "pair tests" in claim
        for claim, verdict in judged(scaling.box_count(ds)).items()
        if verdict == "disagrees"
    )


def test_quick_round_widths_are_noticed(dataset):
    ds = dataset("box_count")
    ds["advantage"] = ds.advantage + 0.1
    found = [verdict for claim, verdict in judged(scaling.box_count(ds)).items() if "power of two" in claim]
    assert found == ["disagrees", "disagrees"]


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


def test_plateaus_are_decided(dataset):
    ds = dataset("ideal_boxes")
    ds["plateau_penalty"] = ds["plateau_penalty"] * 0.0 + 1.5
    found = [verdict for claim, verdict in judged(ideal_boxes(ds)).items() if "worst N" in claim]
    assert found == 4 * ["source in error"]


def test_no_minimum_is_no_pass(dataset):
    found = judged(ideal_boxes(dataset("ideal_boxes")))
    assert found["ideal number of boxes per particle, N = 1200000, r = 0.1"] == "inconclusive"
