"""Work that several processes share: results, what is sent meanwhile, and processes that are lost."""

from pathlib import Path

import pytest
from calls import shared

import gaspart as gp
from gaspart.workers import Lost, in_processes


@pytest.fixture(autouse=True)
def path(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parent))


def test_each_call_is_made_once_and_what_it_tells_arrives():
    finished, received = {}, []
    calls = [("return", 5), ("leave", 7), ("return", 9)]
    in_processes(shared, calls, 2, finished.__setitem__, lambda *message: received.append(message))
    assert finished == {0: 5, 1: Lost(7), 2: 9} and str(finished[1]) == "its process ended with code 7"
    assert sorted(received) == [(0, 5), (1, 7), (2, 9)]


def test_what_a_call_raises_is_raised_here():
    with pytest.raises(gp.SceneError, match="value = 5: is refused"):
        in_processes(shared, [("refuse", 5)], 1, {}.__setitem__)
