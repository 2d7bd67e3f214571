"""Rows of the table of efforts."""

import pytest
import trade
from reproduction.claims.data import claim

from gaspart.reproduction.claims import table


def test_a_row_has_the_time_by_kind_of_work_and_what_claims_decide(tmp_path, monkeypatch):
    monkeypatch.setattr(trade, "TABLE", tmp_path / "trade.csv")
    for rule, seconds in (
        ("warm/a/event", 30),
        ("simulate/gas/x=1", 60),
        ("simulate/gas/x=2", 90),
        ("claims", 6),
    ):
        log = tmp_path / f"logs/{rule}.log"
        log.parent.mkdir(parents=True, exist_ok=True)
        log.write_text(f"processor time: {seconds}.00 s, memory: 5.0 MB\n")
    (tmp_path / "claims").mkdir()
    table.write(tmp_path / "claims/gas.csv", "gas", [claim(1.01, 0.01), claim(6.0, 5.0, text="wide")])
    for effort in ("1", "0.25", "1"):
        trade.record(effort, tmp_path)
    first, second = trade.read()
    assert {first["effort"], second["effort"]} == {"1", "0.25"}
    times = {"kernels": 0.5, "simulations": 2.5, "timings": 0.0, "figures": 0.0, "other": 0.1, "CPU min": 3.1}
    assert {name: float(first[name]) for name in times} == pytest.approx(times)
    assert (first["claims"], first["conclusive"], first["agree"], first["disagree"]) == (
        "3",
        "2",
        "2",
        "0",
    )  # with the family
