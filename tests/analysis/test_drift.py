"""Drifts of runs that are not steady, and none of steady runs."""

import numpy as np
from scipy.signal import lfilter

import gaspart as gp
from gaspart.analysis import series as drift
from gaspart.cli import main


def test_a_steady_series_drifts_once_in_many_and_a_rising_one_always():
    rng = np.random.default_rng(1)
    for memory in (0.0, 0.8, -0.5):
        steady = [lfilter([1.0], [1.0, -memory], rng.standard_normal(600))[200:] for _ in range(300)]
        assert sum(bool(drift._drift("x", 10.0 + one)) for one in steady) <= 2
        rise = 20.0 / (1.0 - memory) / np.sqrt(400.0) * np.sqrt(12.0) * np.linspace(0.0, 1.0, 400)
        assert sum("drifts from" in drift._drift("x", 10.0 + one + rise) for one in steady) > 295
    assert drift._drift("x", np.ones(100)) == ""


def test_an_open_scene_that_still_fills_is_said_to_drift(tmp_path, capsys):
    """From few particles: the density of the whole run is below that to which the faces lead."""
    container = gp.Container((40.0, 8.0), ("wall", "periodic"))
    faces = {name: gp.Open(activity=0.1, temperature=1.0) for name in ("x_low", "x_high")}
    scene = gp.Scene(container, [gp.Species(5, 0.3, temperature=1.0)], faces=faces, centres_to_walls=True)
    path = gp.run(scene, gp.EventDriven(), 1, 30.0, 0.1, tmp_path / "run.nc")
    assert main(["measure", str(path), "density", "--axis", "x", "--start", "0"]) == 0
    assert "(not steady: the number of particles drifts from" in capsys.readouterr().out


def test_a_gas_that_cools_drifts_and_one_in_equilibrium_does_not(tmp_path, capsys):
    for restitution, drifts in ((gp.Restitution(normal=0.9), True), (None, False)):
        kind = gp.Species(100, 0.5, temperature=1.0)
        scene = gp.Scene(gp.Container((20.0, 20.0)), [kind], restitution=restitution)
        path = gp.run(scene, gp.EventDriven(), 1, 100.0, 0.5, tmp_path / f"{drifts}.nc")
        assert main(["measure", str(path), "density", "temperature"]) == 0
        assert ("the kinetic energy of a particle drifts" in capsys.readouterr().out) == drifts
