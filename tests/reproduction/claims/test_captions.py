import re
from pathlib import Path

import pytest

from gaspart.reproduction.claims.table import (
    NOT_MEASURED,
    concise,
    fill_caption,
    literal_copies,
)

REPORT = Path(__file__).parents[3] / "workflow/report"
ROWS = [
    {"claim": "friction rate, mass 1", "measured": "0.0512", "uncertainty": "0.0014", "expected": "0.05"},
    {"claim": "friction rate, mass 100", "measured": "0.51", "uncertainty": "0.03", "expected": "0.5"},
    {"claim": "diffusion", "measured": "nan", "uncertainty": "nan", "expected": "1.0"},
    {"claim": "viscosity", "measured": "", "uncertainty": "", "expected": "1.0"},
]


def test_a_place_is_filled_with_the_value_of_its_claim():
    caption = "The rate is {{friction\nrate, mass 100}}, and D {{ diffusion }} or {{viscosity}}, {{another}}."
    expected = f"The rate is 0.51(3), and D {NOT_MEASURED} or {NOT_MEASURED}, {NOT_MEASURED}."
    assert fill_caption(caption, ROWS) == expected


def test_a_place_names_one_claim():
    with pytest.raises(ValueError, match="2 claims begin so"):
        fill_caption("{{friction rate}}", ROWS)


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (0.93012, 0.0161, "0.930(16)"),
        (0.93012, 0.0261, "0.93(3)"),
        (12.3, 0.195, "12.3(2)"),
        (12345.0, 678.0, "12300(700)"),
        (3.14159, 0.0, "3.1416"),
    ],
)
def test_uncertainties_are_in_units_of_the_last_digit(value, error, text):
    assert concise(value, error) == text


def test_a_copy_of_a_measured_number_is_found():
    assert literal_copies("with a rate of 0.051 here", ROWS) == ["0.051: friction rate, mass 1"]
    assert literal_copies("with a rate of {{friction rate, mass 1}}; 0.05 by theory, 0.4 not", ROWS) == []


def test_captions_state_no_measured_number_themselves():
    """A sentence about what was measured has its numbers from the claims."""
    wrong = []
    for path in sorted(REPORT.glob("*.rst")):
        text = re.sub(r"\{\{.*?\}\}", "", " ".join(path.read_text(encoding="utf-8").split()))
        for sentence in re.split(r"(?<=[.:;])\s", text):
            if re.search(r"\b(as measured|the measure(d|ment) (is|one)|come[s]? out)\b", sentence):
                wrong += [f"{path.name}: {sentence}"] if re.search(r"\d+(\.\d+)? ?%|\d\.\d", sentence) else []
    assert wrong == []
