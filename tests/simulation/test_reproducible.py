"""The same scene, engine and seed give the same bits, whatever happens on the way."""

import os
import signal
import struct
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart.trajectory import amber, recording
from gaspart.trajectory.amber import frame_count
from gaspart.trajectory.opening import checkpoint_path, partial_path

ENGINES = {
    "event": gp.EventDriven(),
    "direct": gp.EventDriven(search="direct"),
    "step": gp.TimeStepped(time_step=0.03125),
    "float32": gp.TimeStepped(time_step=0.03125, precision="float32"),
    "dsmc": gp.DSMC(time_step=0.03125, cells_per_side=2),
    "enskog": gp.DSMC(time_step=0.03125, cells_per_side=1, model="enskog"),
}
every_engine = pytest.mark.parametrize(
    "engine",
    [
        pytest.param(engine, id=name, marks=[pytest.mark.thorough] * (name == "float32"))
        for name, engine in ENGINES.items()
    ],
)


class Cut(BaseException):
    """Stands for a kill, at a moment of the test's choice."""


def small(boundary):
    return gas(3, 60, 0.2, boundary)


def test_the_same_bytes_in_another_process(tmp_path):
    here = gp.run(small("wall"), ENGINES["event"], (1, 2), 4.0, 0.5, tmp_path / "here.nc")
    scene, there = tmp_path / "scene.yaml", tmp_path / "there.nc"
    small("wall").to_file(scene)
    settings = ["--duration", "4", "--sample-interval", "0.5", "--seed", "1,2"]
    gaspart("run", scene, "-o", there, *settings, env={"PYTHONHASHSEED": "5", "TZ": "Asia/Tokyo"})
    assert here.read_bytes() == there.read_bytes()


@every_engine
def test_another_sampling_interval_changes_no_bit(tmp_path, engine):
    """Compared in float64: displacements, counters, energy."""
    runs = {
        every: gp.open_trajectory(
            gp.run(small("periodic"), engine, 7, 8.0, every, tmp_path / f"{every}.nc", displacements=True)
        )
        for every in (0.125, 0.5, 8.0)
    }
    often = runs[0.125]
    for every in (0.5, 8.0):
        seldom, common = runs[every], often.isel(frame=slice(None, None, int(every / 0.125)))
        for name in ("time", "displacements", "velocities", "kinetic_energy", *amber.counters(engine)):
            assert np.array_equal(seldom[name], common[name]), name
    for data in runs.values():
        data.close()


@every_engine
def test_checkpoints_change_no_bit(tmp_path, engine):
    plain = gp.run(small("wall"), engine, 7, 4.0, 2.0, tmp_path / "plain.nc")
    often = gp.run(small("wall"), engine, 7, 4.0, 2.0, tmp_path / "often.nc", checkpoint_seconds=0.0)
    assert plain.read_bytes() == often.read_bytes()


@every_engine
@pytest.mark.parametrize("cut_after", [1, 2, 5, 9])
def test_cut_short_after_any_checkpoint_and_resumed(tmp_path, monkeypatch, engine, cut_after):
    cut_and_resume(tmp_path, monkeypatch, cut_after, small("periodic"), engine, displacements=True)


def test_spins_and_counters_of_some_particles_cut_short_and_resumed(tmp_path, monkeypatch):
    rough = replace(gas(2, 40, 0.2, "wall"), restitution=gp.Restitution(0.9, 0.5))
    cut_and_resume(tmp_path, monkeypatch, 5, rough, ENGINES["event"], follow=7)


def cut_and_resume(tmp_path, monkeypatch, cut_after, scene, engine, **settings):
    """Checkpoints lie between frames here, and at frames; the work after the last one is lost on purpose."""
    monkeypatch.setattr(gp.EventDriven, "first_segment", 20)
    monkeypatch.setattr(recording, "_SEGMENT", 1e-9)  # segments stay short
    complete = gp.run(scene, engine, 7, 4.0, 0.5, tmp_path / "complete.nc", **settings).read_bytes()
    path, write, saved = tmp_path / "cut.nc", recording.write_checkpoint, []

    def write_some(*arguments):
        if len(saved) == cut_after:
            raise Cut
        saved.append(arguments)
        write(*arguments)

    monkeypatch.setattr(recording, "write_checkpoint", write_some)
    with pytest.raises(Cut):
        gp.run(scene, engine, 7, 4.0, 0.5, path, checkpoint_seconds=0.0, **settings)
    monkeypatch.setattr(recording, "write_checkpoint", write)
    assert checkpoint_path(path).exists() and not path.exists()
    assert gp.resume(path).read_bytes() == complete
    assert sorted(tmp_path.iterdir()) == sorted([path, tmp_path / "complete.nc"])


def gaspart(*arguments, env=None, wait=True):
    """Start the command line in a process of its own."""
    command = [sys.executable, "-m", "gaspart", *map(str, arguments)]
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), **(env or {})}
    process = subprocess.Popen(command, env=env, stdout=subprocess.DEVNULL)
    if wait:
        assert process.wait() == 0
    return process


def frames_in(partial):
    """Frames of a file that is being written; 0 if it is not there yet."""
    try:
        with partial.open("rb") as file:
            return frame_count(file)
    except (OSError, struct.error):
        return 0


@pytest.mark.parametrize("engine", ["event", pytest.param("step", marks=pytest.mark.thorough)])
def test_killed_again_and_again_and_resumed(tmp_path, engine):
    """kill -9, at moments that differ from run to run of this test; the finished file never does."""
    scene, path = tmp_path / "scene.yaml", tmp_path / "run.nc"
    gas(3, 2000, 0.2).to_file(scene)
    step = ["--time-step", "0.015625"] if engine == "step" else []
    settings = ["--engine", engine, "--duration", "64", "--sample-interval", "0.5", "--seed", "3", *step]
    settings += ["--displacements", "--quiet", "--checkpoint-seconds", "0"]
    partial, reached = partial_path(path), 0
    for _ in range(3):
        process = gaspart("run", scene, "-o", path, *settings, wait=False)
        deadline = time.monotonic() + 120
        while frames_in(partial) < reached + 5 and process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.003)
        assert process.poll() is None, "the run was over before it could be killed"
        process.send_signal(signal.SIGKILL)
        process.wait()
        assert partial.exists() and not path.exists()
        with gp.open_trajectory(partial) as data:  # what there is can be read
            assert data.sizes["frame"] >= reached + 5
            assert np.isfinite(data["coordinates"].values).all()
            reached = data.sizes["frame"]
    gaspart("resume", path, "--checkpoint-seconds", "1")
    assert sorted(tmp_path.iterdir()) == [path, scene]
    undisturbed = tmp_path / "undisturbed.nc"
    gaspart("run", scene, "-o", undisturbed, *settings[:-2])
    assert path.read_bytes() == undisturbed.read_bytes()
