"""A short run of the program for the tables of relaxing speeds, against them."""

from pathlib import Path

import numpy as np
import pytest

import gaspart
from gaspart.reproduction.relaxation import relaxation


@pytest.mark.parametrize(("dimension", "exact"), [(2, 2.0), (3, 5.0 / 3.0)])
def test_relaxing_speeds_are_those_of_the_table(dimension, exact):
    """Within 4.5 standard errors of 200 000 particles: 0.003 for the kurtosis, near 0.001 for the part that
    was never hit. The last rows are Maxwell's."""
    count = 200_000
    table = np.loadtxt(
        Path(gaspart.__file__).parent / f"theory/data/relaxation_{dimension}d.csv", delimiter=",", skiprows=1
    )
    collisions, kurtosis, missed, speed = relaxation(dimension, count, 14.0, seed=1).T
    inside = collisions < table[-1, 1]
    known = [np.interp(collisions[inside], table[:, 1], table[:, k]) for k in (2, 4, 5)]
    error = 4.5 / np.sqrt(count)
    assert inside.sum() > 20
    assert np.abs(kurtosis[inside] - known[0]).max() < 1.5 * error
    assert np.abs(missed[inside] - known[1]).max() < 0.5 * error + 1e-3
    assert np.abs(speed[inside] - known[2]).max() < 0.5 * error
    assert kurtosis[-1] == pytest.approx(exact, abs=0.02)
