import math

import numpy as np
import pytest
from claims.data import claim

from gaspart import claims
from gaspart.claims import Estimate, judge


def test_table_goes_out_and_comes_back(tmp_path):
    path = tmp_path / "claims" / "virial_discs.csv"
    made = [
        claim(np.float64(1.234), np.float32(0.01), 0.02, Estimate(1.23, 0.004)),
        claim(9.0, text='Z at "0.2", dense'),
        claim(error=math.nan, kind="reproduction", text="Z at 0.3"),
    ]
    claims.write(path, "virial_discs", made)
    assert path.read_text().splitlines()[0] == ",".join(claims.COLUMNS)
    rows = claims.read(path)
    assert [row["verdict"] for row in rows] == judge(made) == ["agrees", "disagrees", "inconclusive"]
    assert [row["claim"] for row in rows] == [one.claim for one in made]
    assert rows[0]["measured"] == 1.234
    assert rows[0]["source"] == "theory (± 0.004)"
    assert rows[0]["deviation_sigma"] == pytest.approx(made[0].deviation_sigma, abs=1e-3)
    assert not list(path.parent.glob("*.partial"))

    table = claims.collect([path, path])
    assert tuple(table.columns) == claims.COLUMNS
    assert len(table) == 6
    table.to_csv(path, index=False)
    assert claims.summary(path).splitlines() == [
        "6 claims: 2 agree, 2 disagree, 2 inconclusive",
        *['disagrees: virial_discs: Z at "0.2", dense'] * 2,
    ]


def test_collecting_nothing_gives_an_empty_table(tmp_path):
    table = claims.collect([])
    assert tuple(table.columns) == claims.COLUMNS
    table.to_csv(tmp_path / "claims.csv", index=False)
    assert claims.summary(tmp_path / "claims.csv") == "0 claims: 0 agree, 0 disagree, 0 inconclusive"


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
