""""""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from reproduction.claims.data import claim

from gaspart.reproduction import claims
from gaspart.reproduction.claims import Estimate, judge
from gaspart.reproduction.claims.table import (
    NOT_MEASURED,
    concise,
    fill_caption,
    literal_copies,
)


def test_table_goes_out_and_comes_back(tmp_path):
    path = tmp_path / "claims" / "virial_discs.csv"
    made = [
        claim(np.float64(1.234), np.float32(0.01), 0.02, Estimate(1.23, 0.004)),
        replace(claim(9.0, text='Z at "0.2", dense'), measured=Estimate(9.0, 0.01, 5)),
        claim(error=math.nan, kind="reproduction", text="Z at 0.3"),
    ]
    claims.write(path, "virial_discs", made)
    assert path.read_text().splitlines()[0] == ",".join(claims.COLUMNS)
    rows = claims.read(path)
    *alone, family = rows
    assert [row["verdict"] for row in alone] == judge(made) == ["agrees", "disagrees", "inconclusive"]
    assert [row["claim"] for row in alone] == [one.claim for one in made]
    assert (family["kind"], family["form"], family["verdict"]) == ("family", "distribution", "disagrees")
    assert rows[0]["measured"] == 1.234
    assert (rows[0]["source"], rows[0]["allowance"]) == ("theory", 0.004)
    assert (rows[0]["degrees_of_freedom"], rows[1]["degrees_of_freedom"]) == (math.inf, 5.0)
    assert [row["scattered"] for row in rows] == [0.0, 1.0, 0.0, 0.0]
    assert rows[2]["why"] == "not measured in this run"
    assert rows[0]["deviation_sigma"] == pytest.approx(made[0].deviation_sigma, abs=1e-3)
    assert not list(path.parent.glob("*.partial"))

    table = claims.collect([path, path])
    assert tuple(table.columns) == claims.COLUMNS
    assert len(table) == 8
    table.to_csv(path, index=False)
    assert claims.summary(path).splitlines() == [
        "8 claims",
        "tests: 2 agree, 2 disagree",
        "reproductions: 2 inconclusive",
        "families: 2 disagree",
        *[
            'disagrees: virial_discs: Z at "0.2", dense',
            f"disagrees: virial_discs: {family['claim']}",
        ]
        * 2,
    ]
    assert claims.counts(claims.read(path))["test"] == {"agrees": 2, "disagrees": 2}


def test_two_claims_with_one_text_are_refused(tmp_path):
    with pytest.raises(ValueError, match="occurs twice"):
        claims.write(tmp_path / "a.csv", "figure", [claim(), claim()])
    assert not (tmp_path / "a.csv").exists()


def test_foreign_tables_are_refused(tmp_path):
    path = tmp_path / "other.csv"
    path.write_text("a,b\n1,2\n")
    with pytest.raises(ValueError, match=r"other\.csv: not a claims table"):
        claims.read(path)
    claims.write(path, "figure", [claim()])
    path.write_text(path.read_text().replace(",agrees,", ",perhaps,"))
    with pytest.raises(ValueError, match="verdict: 'perhaps'"):
        claims.read(path)


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
