"""Blocks of counts and impulses of a short run."""

from dataclasses import replace

import numpy as np
import pytest

import gaspart as gp
from gaspart.analysis.run import open_run
from gaspart.reproduction.figures.estimators import blocks_of
from gaspart.trajectory.reading import open_trajectory


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A few spheres that fall in a container 4 high, of which three quarters are measured."""
    container = gp.Container((6.0, 6.0, 4.0), ("periodic", "periodic", "wall"))
    scene = gp.Scene(container, [gp.Species(20, 0.4, temperature=1.0)], gravity=(0.0, 0.0, -0.5))
    path = tmp_path_factory.mktemp("falling") / "run.nc"
    gp.run(scene, gp.EventDriven(), 5, 65.0, 0.5, path, tallies=[gp.ImpulseTally("z", 16)])
    with open_trajectory(path) as data, open_run(data, 0.0) as found:
        yield found


def test_blocks_have_all_particles_in_counts_and_impulses(run):
    counted, impulses = blocks_of(run, 0.5)
    assert counted.shape == impulses.shape == (32, 8)
    assert np.allclose(counted.sum(axis=1), 20.0) and np.allclose(impulses.sum(axis=1), 20.0)
    places = run.positions[1:129, :, 2]
    assert counted[0] == pytest.approx(np.histogram(places[:4], 8, (0.0, 4.0))[0] / 4.0)
    assert impulses.mean(axis=0) == pytest.approx(counted.mean(axis=0), abs=0.4)


def test_other_bins_and_runs_without_impulses_are_refused(run):
    for width in (0.3, 0.1):
        with pytest.raises(gp.SceneError, match="do not divide"):
            blocks_of(run, width)
    with pytest.raises(gp.SceneError, match="None"):
        blocks_of(replace(run, data=run.data.assign_attrs(tallies="[]")), 0.5)
