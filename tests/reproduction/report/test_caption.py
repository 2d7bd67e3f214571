"""The parts of a caption, and that each caption of the project has them."""

import re
from pathlib import Path

import pytest

from gaspart.reproduction.families.registry import families
from gaspart.reproduction.report.page import divided

REPORT = Path(__file__).parents[3] / "workflow/report"
MOST_WORDS = 120
LONG = """**Discs freeze.** (a) Pressure of
discs.

*Theory.* That they do.

*Panels.* (b) *g*\\ (*r*).
"""


def test_a_caption_is_divided():
    parts = divided(LONG)
    assert (parts.finding, parts.plain) == ("Discs freeze", "Discs freeze")
    assert "Pressure of\ndiscs" in parts.reading and "<em>g</em>" in parts.reading
    assert "Panels" not in parts.reading and "Theory" in parts.details


def test_a_caption_begins_with_its_finding():
    with pytest.raises(ValueError, match="begins with its finding"):
        divided("Discs freeze.")


@pytest.mark.parametrize("figure", families())
def test_how_to_read_a_figure_takes_few_words(figure, capsys):
    text = (REPORT / f"{figure}.rst").read_text(encoding="utf-8")
    parts = divided(re.sub(r"\{\{.*?\}\}", "0.123(4)", text, flags=re.DOTALL))
    assert capsys.readouterr().err == ""  # docutils has nothing to complain about
    words = re.sub(r"<math.*?</math>", "formula", parts.reading, flags=re.DOTALL)
    assert len(re.sub(r"<[^>]+>", "", words).split()) <= MOST_WORDS
