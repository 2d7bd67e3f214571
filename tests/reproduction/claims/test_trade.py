"""Rows of the table of efforts."""

import trade
from reproduction.claims.data import claim

from gaspart.reproduction.claims import table


def test_a_row_has_the_time_of_a_run_and_what_its_claims_decide(tmp_path, monkeypatch):
    monkeypatch.setattr(trade, "TABLE", tmp_path / "trade.csv")
    (tmp_path / "claims").mkdir()
    table.write(tmp_path / "claims/gas.csv", "gas", [claim(1.01, 0.01), claim(6.0, 5.0, text="wide")])
    for effort, cpu in (("1", "90.0"), ("0.25", "30.0"), ("1", "80.0")):
        trade.record(effort, tmp_path, cpu, "50.0")
    rows = trade.read()
    assert [(row["effort"], row["CPU min"]) for row in rows] == [("0.25", "30.0"), ("1", "80.0")]
    counts = [rows[0][name] for name in ("claims", "conclusive", "agree", "disagree")]
    assert counts == ["3", "2", "2", "0"]  # with the family
