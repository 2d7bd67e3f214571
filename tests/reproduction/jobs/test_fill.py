"""Filling a container: every failure counted, until the attempts are spent."""

import pytest
import xarray as xr

import gaspart as gp
from gaspart.reproduction.jobs.fill import fill


@pytest.mark.parametrize("boundary", ["wall", "periodic"])
def test_failures_are_counted_until_the_attempts_are_spent(boundary):
    scene = gp.Scene(gp.Container((8.0, 8.0), boundary), [gp.Species(60, 0.5)])  # far above saturation
    found = xr.Dataset(*fill(scene, attempts=300, seeds=[(1,), (2,)]))
    for replica in range(2):
        placed = int(found["placed"][replica])
        failures = found["failures"][replica].values
        assert 20 < placed < 60
        assert (failures[:placed] >= 0).all()
        assert (failures[placed:] == -1).all()
        assert failures[:placed].sum() + placed <= int(found["attempts"][replica]) == 300 * 60
