"""The data set of collisions: rows that follow from one another, and what kinetic theory says of them."""

from time import sleep

import numpy as np
import pytest
import xarray as xr
from scenes import gas
from scipy import stats

import gaspart as gp
from gaspart import theory
from gaspart.analysis.collisions import record_collisions


@pytest.mark.parametrize("boundary", ["periodic", "wall"])
def test_rows_agree_with_the_events(boundary):
    scene = gas(2, 20, 0.2, boundary)
    data = gp.collision_data(scene, 200, seed=3)
    assert data.sizes["collision"] >= 200
    assert np.all(data["approach"] > 0.0)
    assert np.all(data["approach"] <= data["relative_speed"] * (1 + 1e-12))
    assert np.allclose((data["normal"] ** 2).sum("axis"), 1.0)
    sim = gp.Simulation(scene, gp.EventDriven(), seed=3)
    sim.record_events = True
    sim.advance(until=float(data["time"][-1]))
    times, particles = sim.events["time"], sim.events["particles"]
    last = dict.fromkeys(range(20), np.nan)
    expected = []
    for time, pair in zip(times, particles, strict=True):
        if pair[1] >= 0:
            expected.append([time - last[particle] for particle in pair])
        last.update({particle: time for particle in pair if particle >= 0})
    assert np.array_equal(data["free_time"], np.array(expected), equal_nan=True)
    assert np.array_equal(data["particles"], particles[particles[:, 1] >= 0])


@pytest.fixture(scope="module", params=[2, 3])
def data(request):
    return gp.collision_data(gas(request.param, 200, 0.2), 30_000, seed=5, equilibration=5.0)


def test_the_contact_value_is_that_of_theory(data):
    dimension = data.sizes["axis"]
    chi = gp.contact_value(data)
    finite = theory.collision_rate_finite_size_factor(0.2, dimension, 200)
    assert chi.error < 0.01 * chi.value
    assert abs(chi.value - float(theory.contact_value(0.2, dimension)) * float(finite)) < 3 * chi.error


def test_impact_parameters_are_uniform(data):
    """The offset's power d - 1 is uniform, for the flux of pairs through a disc (a line) is."""
    cosine = (data["approach"] / data["relative_speed"]).values
    offset = np.sqrt(1.0 - cosine**2) ** (data.sizes["axis"] - 1)
    assert stats.kstest(offset, "uniform").pvalue > 0.001


def test_the_mean_free_path_is_that_of_theory(data):
    path = data["free_path"].values
    path = path[np.isfinite(path)]
    expected = float(theory.mean_free_path(0.2, data.sizes["axis"]))
    # neighbouring flights share a collision; twice the error of independent ones covers that
    assert abs(path.mean() - expected) < 3 * 2 * path.std() / np.sqrt(len(path))


def test_invalid_input_is_refused():
    with pytest.raises(gp.SceneError, match="gravity"):
        gp.collision_data(gp.Scene(gp.Container((9.0, 9.0)), gravity=(0.0, -1.0)), 10)
    with pytest.raises(gp.SceneError, match="collisions = 0"):
        gp.collision_data(gas(2, 20, 0.2), 0)
    with pytest.raises(gp.SimulationError, match="no event"):
        gp.collision_data(gp.Scene(gp.Container((9.0, 9.0), "periodic"), [gp.Species(2, 0.5)]), 10)
    mixed = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(5, r, speed=1.0) for r in (0.3, 0.5)])
    with pytest.raises(gp.SceneError, match="equal particles"):
        gp.contact_value(gp.collision_data(mixed, 50))


def test_a_file_written_a_second_later_has_the_same_bytes(tmp_path):
    data = record_collisions(gas(2, 20, 0.2), tmp_path / "one.nc", 100, seed=3)
    sleep(1.01)  # formats store seconds
    record_collisions(gas(2, 20, 0.2), tmp_path / "other.nc", 100, seed=3)
    assert (tmp_path / "one.nc").read_bytes() == (tmp_path / "other.nc").read_bytes()
    with xr.open_dataset(tmp_path / "one.nc") as read:
        xr.testing.assert_identical(read.load(), data)
