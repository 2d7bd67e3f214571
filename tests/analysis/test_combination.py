"""Observables of several runs: their mean, with the scatter of the runs."""

from dataclasses import replace

import numpy as np
import pytest
from scenes import gas

import gaspart as gp

GAS = gas(3, 64, 0.2, exact_temperature=True)


@pytest.fixture(scope="module")
def paths(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs")
    return [gp.run(GAS, gp.EventDriven(), seed, 20.0, 0.25, folder / f"{seed}.nc") for seed in range(12)]


def test_a_scalar_is_the_mean_of_the_runs_with_their_scatter(paths):
    found = gp.analysis.replicas("Z", paths)
    each = np.array([float(gp.analysis.compressibility_factor(path).estimate) for path in paths])
    assert np.array_equal(found["compressibility_factor_replicas"], each)
    assert float(found.estimate) == pytest.approx(each.mean())
    assert float(found.error) == pytest.approx(each.std(ddof=1) / np.sqrt(12))
    assert found.attrs["freedom"] == 11
    assert abs(float(found.deviation)) < 4.0
    assert found.summary.startswith("Z = ") and "theory" in found.summary
    legend = found.plot(theory=True).get_legend()
    assert legend.get_texts()[0].get_text() == "replicas"


def test_the_scatter_agrees_with_the_uncertainty_of_single_runs(paths):
    """Both estimate the same thing: their ratio is within the scatter of 11 degrees of freedom."""
    found = gp.analysis.replicas("Z", paths)
    single = np.mean([float(gp.analysis.compressibility_factor(path).error) ** 2 for path in paths]) ** 0.5
    assert 0.45 < float(found.error) * np.sqrt(12) / single < 1.75


def test_speeds_of_runs_of_other_energies_are_in_joint_bins(tmp_path):
    scene = gas(3, 32, 0.1)
    drawn = replace(scene, species=[replace(scene.species[0], exact_temperature=False)])
    files = [gp.run(drawn, gp.EventDriven(), n, 10.0, 0.25, tmp_path / f"{n}.nc") for n in range(3)]
    found = gp.analysis.replicas("speeds", files)
    ends = [gp.measure(file, "speeds")["speed"].values[-1] for file in files]
    assert len(set(ends)) == 3 and found["speed"].values[-1] == max(ends)
    width = float(found["speed"][1] - found["speed"][0])
    assert float(found.estimate.sum()) * width == pytest.approx(1.0, abs=1e-3)
    assert found.theory is not None
    empty = found.estimate.values == 0.0  # in all runs, which says nothing of the error
    assert empty.any() and np.isnan(found.error.values[empty]).all()
    assert (found.error.values[~empty] > 0.0).all()


def test_equal_counts_of_two_runs_are_no_error_of_zero(tmp_path):
    """Few particles: some bins have by chance the same count in both runs."""
    scene = gas(3, 16, 0.05)
    files = [gp.run(scene, gp.EventDriven(), n, 4.0, 0.5, tmp_path / f"{n}.nc") for n in range(2)]
    speeds = gp.analysis.replicas("speeds", files)
    each = speeds["speed_distribution_replicas"].values
    same = np.isclose(each[0], each[1], rtol=1e-9) & (each[0] > 0.0)
    assert same.any() and np.isnan(speeds.error.values[same]).all()
    assert (speeds.error.values[~same & (each.max(axis=0) > 0.0)] > 0.0).all()


def test_what_are_no_replicas_is_refused(paths, tmp_path):
    def refused(rule, *sources, name="Z"):
        with pytest.raises(gp.SceneError, match=rule):
            gp.analysis.replicas(name, list(sources))

    refused("must be a list of two runs or more", paths[0])
    with pytest.raises(gp.SceneError, match="must be a list of two runs or more"):
        gp.analysis.replicas("Z", str(paths[0]))
    refused(r"0\.nc: seed = '0': and the first state give .* as .*0\.nc", paths[0], paths[1], paths[0])
    other = gp.run(gas(3, 64, 0.1), gp.EventDriven(), 1, 20.0, 0.25, tmp_path / "other.nc")
    difference = (
        r"other\.nc: scene\.container\.lengths\[0\] = 6\.9.*: is 5\.5.* in .*0\.nc: replicas differ in"
    )
    refused(difference, paths[0], other)
    events, steps = (
        gp.Simulation(GAS, gp.EventDriven(), 1),
        gp.Simulation(GAS, gp.TimeStepped(time_step=1e-3), 2),
    )
    events.advance(duration=5.0)
    refused("run 2: engine.name = 'step': is 'event' in run 1", events, steps)
    shorter = gp.run(GAS, gp.EventDriven(), 99, 15.0, 0.25, tmp_path / "shorter.nc")
    rule = r"shorter\.nc: lag = '\d+ values from .*': \d+ values from .* in .*0\.nc: all runs need the same"
    refused(rule, paths[0], shorter, name="msd")
    refused("unknown observable", *paths[:2], name="ZZ")
    refused("must be trajectories, their paths or simulations", paths[0], 3)


def test_runs_of_one_state_are_one_run_whatever_their_seeds(paths, tmp_path):
    """Nothing is drawn after the start: other seeds give the same bits, of any length."""
    state = gp.last_state(paths[0])
    options = {"initial": state}
    same = [
        gp.run(GAS, gp.EventDriven(), seed, 8.0 * seed, 0.25, tmp_path / f"same{seed}.nc", **options)
        for seed in (1, 2)
    ]
    with pytest.raises(gp.SceneError, match=r"same2\.nc: seed = '2': .*same run, bit for bit, as .*same1"):
        gp.analysis.replicas("Z", same)
    simulations = [gp.Simulation(GAS, gp.EventDriven(), seed, **options) for seed in (1, 2)]
    for sim in simulations:
        sim.advance(duration=8.0 * sim.seed)
    with pytest.raises(gp.SceneError, match=r"run 2: seed = '2': .*same run, bit for bit, as run 1"):
        gp.analysis.replicas("Z", simulations)


def test_runs_of_one_state_without_a_common_time_are_one_run_too(paths, tmp_path):
    state = gp.last_state(paths[0])
    same = [
        gp.run(GAS, gp.EventDriven(), seed, 40.0 * interval, interval, tmp_path / f"{seed}.nc", initial=state)
        for seed, interval in ((1, 0.3), (2, 0.25 * 2**0.5))
    ]
    with pytest.raises(gp.SceneError, match=r"2\.nc: seed = '2': .*same run, bit for bit, as .*1\.nc"):
        gp.analysis.replicas("Z", same)


def test_thermal_walls_make_runs_of_one_state_different(tmp_path):
    faces = dict.fromkeys(("x_low", "x_high"), gp.Thermal(1.0, velocity=(0.0, 0.5)))
    scene = gp.Scene(
        gp.Container((12.0, 12.0), ("wall", "periodic")), [gp.Species(40, 0.5, temperature=1.0)], faces=faces
    )
    first = gp.run(scene, gp.EventDriven(), 1, 10.0, 0.5, tmp_path / "first.nc")
    runs = [
        gp.run(
            scene, gp.EventDriven(), seed, 20.0, 0.5, tmp_path / f"{seed}.nc", initial=gp.last_state(first)
        )
        for seed in (1, 2)
    ]
    assert gp.analysis.replicas("collision_rate", runs).attrs["freedom"] == 1
