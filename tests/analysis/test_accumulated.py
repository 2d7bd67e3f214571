"""Displacements and velocity correlations of a run with correlations: those that it has accumulated."""

import numpy as np
import pytest
from scenes import centred

import gaspart as gp

A = gp.analysis
INTERVAL, LAGS = 0.25, 6


def run(path, scene, **change):
    """Of 80 samples, with a frame at each of them."""
    own = {"duration": 20.0, "sample_interval": INTERVAL, "displacements": True}
    asked = gp.Correlations(INTERVAL, LAGS)
    return gp.run(scene, gp.EventDriven(), 3, path=path, correlations=asked, **{**own, **change})


def discs(boundary="periodic"):
    """40 of them at a packing fraction of 0.1."""
    side = (40 * np.pi / 4 / 0.1) ** 0.5
    return gp.Scene(
        gp.Container((side, side), boundary), [gp.Species(40, 0.5, temperature=2.0, exact_temperature=True)]
    )


@pytest.mark.parametrize("start", [None, 0.0, 12.5])
def test_they_are_means_over_pairs_of_samples_that_end_in_the_measured_part(tmp_path, start):
    path = run(tmp_path / "run.nc", discs())
    found = A.mean_squared_displacement(path, start=start)
    with gp.open_trajectory(path) as data:
        moved, time = centred(data["displacements"].values), data["time"].values
    first = max(LAGS, int(np.flatnonzero(time >= (5.0 if start is None else start))[0]))
    for lag in range(LAGS + 1):
        ends = np.arange(first + 1, len(time))
        squares = ((moved[ends] - moved[ends - lag]) ** 2).sum(axis=2).mean(axis=1)
        expected = squares.mean() * 40.0 / 39.0
        assert float(found.estimate[lag]) == pytest.approx(expected, rel=1e-12, abs=1e-12)
    assert found["lag"].values == pytest.approx(INTERVAL * np.arange(LAGS + 1))
    assert (found.error.values[1:] > 0.0).all() and found.theory is not None


def test_at_lag_0_the_velocities_of_alike_discs_have_the_temperature(tmp_path):
    """Which is exact: their energy about the centre of mass is conserved."""
    found = A.velocity_autocorrelation(run(tmp_path / "run.nc", discs()))
    assert float(found.estimate[0]) == pytest.approx(2.0, rel=1e-9)
    assert float(found.error[0]) == pytest.approx(0.0, abs=1e-9)


def test_between_walls_nothing_is_taken_off(tmp_path):
    """Of two walls momentum is conserved along one axis, of four along none."""
    found = A.velocity_autocorrelation(run(tmp_path / "closed.nc", discs("wall")))
    assert float(found.estimate[0]) == pytest.approx(2.0, rel=1e-9)
    found = A.velocity_autocorrelation(run(tmp_path / "slit.nc", discs(("periodic", "wall"))))
    with gp.open_trajectory(tmp_path / "slit.nc") as data:
        velocities = data["velocities"].values[data["time"].values > 5.0].astype(float)
    velocities[..., 0] -= velocities[..., 0].mean(axis=1, keepdims=True)
    free = (velocities[..., 0] ** 2).mean() * 40.0 / 39.0 + (velocities[..., 1] ** 2).mean()
    assert float(found.estimate[0]) == pytest.approx(0.5 * free, rel=1e-6)


def test_the_lags_of_frames_remain_within_reach(tmp_path):
    """By a number of lags, or a choice of particles."""
    path = run(tmp_path / "run.nc", discs())
    assert A.velocity_autocorrelation(path, lags=3).sizes["lag"] == 3
    assert A.mean_squared_displacement(path, species=0).sizes["lag"] > LAGS + 1
    assert A.mean_squared_displacement(path, per_axis=True).estimate.dims == ("axis", "lag")


def test_few_particles_in_the_file_change_nothing_but_the_theory(tmp_path):
    whole, followed = (run(tmp_path / f"{n}.nc", discs(), follow=n) for n in (40, 1))
    for function in (A.velocity_autocorrelation, A.mean_squared_displacement):
        found, other = function(whole), function(followed)
        assert found.theory is not None and other.theory is None
        assert np.array_equal(found.estimate, other.estimate) and np.array_equal(found.error, other.error)


@pytest.mark.parametrize("mass", [1.0, 3.0])
def test_errors_are_those_of_independent_runs(tmp_path, mass):
    """By the mean over lags of the squared scatter of 24 runs of one energy."""
    kinds = [(30, 1.0), (10, mass)]
    species = [gp.Species(n, 0.5, mass=m, temperature=1.0, exact_temperature=True) for n, m in kinds]
    scene = gp.Scene(discs().container, species)
    values, squares = [], []
    for seed in range(24):
        path = tmp_path / f"{seed}.nc"
        gp.run(scene, gp.EventDriven(), (4, seed), 160.0, 2.5, path, correlations=gp.Correlations(0.25, 6))
        found = A.velocity_autocorrelation(path)
        values.append(found.estimate.values)
        squares.append(found.error.values**2)
    ratio = np.mean(squares) / np.var(values, axis=0, ddof=1).mean()
    assert 0.5 < ratio < 2.0


def test_too_few_frames_are_refused(tmp_path):
    path = run(tmp_path / "run.nc", discs(), sample_interval=1.25)
    with pytest.raises(gp.SceneError, match="frames = 13: an error needs 17 with samples at all lags"):
        A.velocity_autocorrelation(path)
