"""Drifts of runs that are not steady, and none of steady runs."""

import math

import numpy as np
import pytest
from scipy.signal import lfilter

import gaspart as gp
from gaspart.analysis.drift import Series, describe, drift_of, trend_of
from gaspart.cli import main

REMARK = "not steady"


def is_remarked(series):
    trend = trend_of(series)
    return trend is not None and bool(describe([{"x": trend}]))


def relaxing(rng, number, time):
    """A series of variance 1 with correlations exp(-|t| / time), started in equilibrium."""
    memory = math.exp(-1.0 / time)
    noise = rng.standard_normal(number) * math.sqrt(1.0 - memory**2)
    noise[0] = rng.standard_normal()
    return lfilter([1.0], [1.0, -memory], noise)


def test_a_steady_series_drifts_once_in_many_and_a_rising_one_always():
    rng = np.random.default_rng(1)
    for memory in (0.0, 0.8, -0.5):
        steady = [lfilter([1.0], [1.0, -memory], rng.standard_normal(600))[200:] for _ in range(100)]
        assert sum(is_remarked(Series(10.0 + one)) for one in steady) <= 5  # 0.8 of 100 are expected
        rise = 20.0 / (1.0 - memory) / np.sqrt(400.0) * np.sqrt(12.0) * np.linspace(0.0, 1.0, 400)
        assert sum(is_remarked(Series(10.0 + one + rise)) for one in steady) > 97
    assert not is_remarked(Series(np.ones(100)))


@pytest.mark.parametrize("time", [10.0, 100.0, 1000.0])
def test_modes_slower_than_the_run_do_not_drift(time):
    """75 frames, as in the first run of the README; the series alone would be remarked in most runs."""
    rng, number = np.random.default_rng(1), 75
    slow = [relaxing(rng, number, time) for _ in range(100)]
    assert sum(is_remarked(Series(one, 1.0, number / time, thermal=True)) for one in slow) <= 3
    phases, frame = rng.uniform(0.0, 2.0 * np.pi, 100), np.arange(number)
    strength = rng.rayleigh(1.0, 100)
    sound = [a * np.cos(frame / time + phase) for a, phase in zip(strength, phases, strict=True)]
    assert sum(is_remarked(Series(one, 1.0, 10.0, number / time, thermal=True)) for one in sound) <= 3
    assert sum(is_remarked(Series(one)) for one in slow + sound) > (0 if time < 30.0 else 50)
    swing = [one + 8.0 * np.cos(2.0 * np.pi * frame / number) for one in slow]
    assert all(is_remarked(Series(one, 1.0, number / time, 1.0, thermal=True)) for one in swing)


def test_replicas_show_a_drift_that_one_run_does_not():
    rng = np.random.default_rng(2)
    runs = [{"x": trend_of(Series(rng.standard_normal(200) + np.linspace(0.0, 0.5, 200)))} for _ in range(30)]
    assert sum(bool(describe([run])) for run in runs) < 10 and "x drifts from" in describe(runs)


def test_an_atmosphere_that_falls_is_remarked_by_every_way_to_measure_it(tmp_path, capsys):
    scene = gp.Scene(
        gp.Container((6.0, 6.0, 60.0), ("periodic", "periodic", "wall")),
        [gp.Species(300, 0.5)],
        gravity=(0.0, 0.0, -0.05),
    )
    paths = [gp.run(scene, seed=seed, duration=60.0, sample_interval=0.5, path=tmp_path / f"run-{seed}.nc")
             for seed in (1, 2)]  # fmt: skip
    remark = drift_of(*paths)
    assert "the kinetic energy of a particle" in remark and "the mean position along z" in remark
    assert main(["measure", str(paths[0]), "temperature", "speeds", "-o", str(tmp_path / "a.png")]) == 2
    for option in ([], ["-o", str(tmp_path / "a.png")]):
        assert main(["measure", str(paths[0]), "temperature", *option]) == 0
        assert capsys.readouterr().out.count(REMARK) == 1
    measured = gp.measure(paths[0], "temperature")
    assert measured.attrs["drift"] == drift_of(paths[0]) and REMARK in repr(measured)
    assert REMARK in measured._repr_html_() and REMARK in measured.plot().get_title(loc="left")
    assert gp.measure(paths, "temperature").attrs["drift"] == remark
    assert REMARK not in repr(gp.measure(paths[0], "force", start=50.0, end=60.0))  # too few frames to know


@pytest.mark.thorough
def test_an_open_scene_that_still_fills_is_said_to_drift(tmp_path, capsys):
    """From few particles: the density of the whole run is below that to which the faces lead."""
    container = gp.Container((40.0, 20.0), ("wall", "periodic"))
    faces = {name: gp.Open(activity=0.1, temperature=1.0) for name in ("x_low", "x_high")}
    scene = gp.Scene(container, [gp.Species(5, 0.3, temperature=1.0)], faces=faces, centres_to_walls=True)
    for seed in range(5):
        path = gp.run(scene, gp.EventDriven(), seed, 30.0, 0.2, tmp_path / f"{seed}.nc")
        assert main(["measure", str(path), "density", "--axis", "x"]) == 0
        assert "(not steady: the number of particles drifts from" in capsys.readouterr().out


def test_the_first_gas_of_the_readme_is_steady(tmp_path):
    scene = gp.Scene(gp.Container((48.0, 36.0)), [gp.Species(300, 0.5, speed=1.0)])
    runs = [gp.run(scene, seed=seed, duration=40.0, sample_interval=0.4, path=tmp_path / f"{seed}.nc")
            for seed in range(10)]  # fmt: skip
    assert sum(bool(drift_of(path)) for path in runs) <= 1
    assert drift_of(*runs) == ""


@pytest.mark.thorough
def test_temperatures_that_meet_and_a_crystal_that_melts_drift(tmp_path):
    pair = [gp.Species(600, 0.5, temperature=8.0), gp.Species(600, 0.5, mass=100.0, temperature=0.5)]
    meeting = gp.Scene(gp.Container((60.0, 60.0)), pair)
    side = (500 * math.pi / 6.0 / 0.49) ** (1.0 / 3.0)
    solid = gp.Species(500, 0.5, temperature=1.0, arrangement="lattice")
    melting = gp.Scene(gp.Container((side,) * 3, "periodic"), [solid])
    for scene, duration, word in ((meeting, 40.0, "species 1"), (melting, 60.0, "collision rate")):
        for seed in range(3):
            path = gp.run(
                scene, seed=seed, duration=duration, sample_interval=0.2, path=tmp_path / f"{word}{seed}.nc"
            )
            assert word in drift_of(path)
