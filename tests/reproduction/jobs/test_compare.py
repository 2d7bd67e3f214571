"""Steps beside exact runs from the same state."""

import math

import numpy as np
import pytest
import xarray as xr

from gaspart.engines import TimeStepped
from gaspart.reproduction.jobs.compare import compare
from gaspart.scene.container import Container
from gaspart.scene.scene import Scene
from gaspart.scene.species import Species

GAS = Scene(
    Container((11.0,) * 3, boundary="periodic"),
    species=(Species(256, 0.5, temperature=1.0, arrangement="lattice"),),
)


@pytest.fixture(scope="module")
def run():
    engines = [TimeStepped(step) for step in (4.0, 0.2, 0.002)]
    with pytest.warns(UserWarning, match="misses"):
        return xr.Dataset(*compare(GAS, engines, (1,), equilibration=5.0, interval=0.7, samples=3))


def test_short_steps_find_every_contact_and_long_ones_do_not(run):
    assert (run.collisions[2] == run.exact_collisions[2]).all()
    assert run.virial[2].values == pytest.approx(run.exact_virial[2].values, rel=1e-3)
    assert run.collisions[1].sum() < run.exact_collisions[1].sum()
    assert run.missed[1].sum() > 0
    assert np.abs(run.energy_drift[1:]).max() < 1e-12


def test_the_exact_runs_cover_the_same_time(run):
    assert run.steps.values.tolist() == [4, 4, 350]
    rate = run.exact_collisions.sum("snapshot") / (run.steps * run.time_step)
    assert rate[1] == pytest.approx(float(rate[2]), rel=0.1)
    assert run.exact_z[2].mean() == pytest.approx(1.52, abs=0.1)


def test_a_refused_step_is_told_of(run):
    assert run.refused.values.tolist() == [1, 0, 0]
    assert math.isnan(run.collisions[0, 0]) and math.isnan(run.missed[0, 0])
