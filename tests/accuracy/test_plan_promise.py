"""The promise of advice, on random scenes: the advised run reaches the required accuracy, judged by a run ten
times as long, at no more than 1.5 times the cost of the best candidate."""

import numpy as np
import pytest
import uneven
from advised import COSTS_MORE, LEAST_REACHED, OBSERVABLES, results

from gaspart.accuracy import pilot

MISSED = 1
"""Of three: more would be missed in 1 % of trials if each were reached with a probability of 95 %."""


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setattr(pilot, "cache_directory", lambda: tmp_path / "cache")


def test_a_random_scene_of_every_fourth_kind(tmp_path):
    """The first is advised to be run by time steps; the others are the shortest of three of their kind."""
    found = results(tmp_path / "results", (0, 180, 41))
    assert {one["kind"] for one in found if "reached" in one} == set(list(OBSERVABLES)[::4])
    assert sum(not one["reached"] for one in found) <= MISSED


def test_scenes_that_are_not_even(tmp_path):
    """A column, a slit, one that falls, a few particles; of more than one miss the chance is 1 %."""
    found = results(tmp_path / "results", (200, 203, 209, 212), uneven.scene)
    assert sum(one["reached"] for one in found) >= 3


@pytest.mark.thorough
def test_a_hundred_scenes_that_are_not_even(tmp_path):
    made = [one for one in results(tmp_path / "results", range(100), uneven.scene) if "reached" in one]
    assert len(made) >= 95
    assert np.mean([one["reached"] for one in made]) >= LEAST_REACHED


@pytest.mark.thorough
def test_a_hundred_random_scenes(tmp_path):
    made = [one for one in results(tmp_path / "results", range(100)) if "reached" in one]
    assert len(made) == 100
    assert np.mean([one["reached"] for one in made]) >= LEAST_REACHED
    assert np.mean([one["cost"] <= COSTS_MORE for one in made]) >= LEAST_REACHED
