"""The page of method and results: short, and its numbers are those of claims."""

import re
from pathlib import Path

from gaspart.reproduction.claims.table import fill_caption, place_fault
from gaspart.reproduction.registry import families

TEXT = (Path(__file__).parents[1] / "workflow/report/paper.md").read_text(encoding="utf-8")
PLACES = [" ".join(place.split()) for place in re.findall(r"\{\{(.*?)\}\}", TEXT, re.DOTALL)]


def test_it_is_short_and_states_no_measured_number_itself():
    assert len(TEXT.split()) <= 1500
    assert not place_fault(TEXT) and len(PLACES) > 15
    assert {place.split(":")[0] for place in PLACES} <= set(families())


def test_every_place_is_filled_from_the_claim_that_begins_so():
    rows = [{"claim": f"{place} and more", "measured": 1.234, "uncertainty": 0.01} for place in PLACES]
    text = fill_caption(TEXT, rows, "absent")
    assert text.count("1.234(10)") == len(PLACES) and "absent" not in text and "{{" not in text
