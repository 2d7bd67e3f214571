"""The claims about the ideal number of boxes where a source errs, and where there is no minimum."""

from reproduction.claims.data import judged

from gaspart.reproduction.families.scaling.claims import ideal_boxes


def test_plateaus_are_decided(dataset):
    ds = dataset("ideal_boxes")
    ds["plateau_penalty"] = ds["plateau_penalty"] * 0.0 + 1.5
    found = [verdict for claim, verdict in judged(ideal_boxes(ds)).items() if "worst N" in claim]
    assert found == 4 * ["source in error"]


def test_no_minimum_is_no_pass(dataset):
    found = judged(ideal_boxes(dataset("ideal_boxes")))
    assert found["ideal number of boxes per particle, N = 1200000, r = 0.1"] == "inconclusive"
