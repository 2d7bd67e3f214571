"""Runs that write trajectories: what is refused, and what happens when something goes wrong."""

import os
import subprocess
import sys
import textwrap
from itertools import product

import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart.files import only_process
from gaspart.trajectory import amber, opening, recording, run
from gaspart.trajectory import run as stage
from gaspart.trajectory.amber import stored_header
from gaspart.trajectory.opening import checkpoint_path, partial_path
from gaspart.trajectory.recipe import read_recipe


def test_no_frame_is_lost_to_rounding(tmp_path):
    """0.1 is not a binary fraction: frames are at n x 0.1, and each is a whole number of steps on."""
    scene = gas(2, 10, 0.1)
    for engine in (gp.EventDriven(), gp.TimeStepped(time_step=0.02)):
        path = gp.run(scene, engine, 1, 30.0, 0.1, tmp_path / f"{engine.name}.nc")
        with gp.open_trajectory(path) as data:
            assert data.sizes["frame"] == 301
            assert np.abs(data["time"] - 0.1 * np.arange(301)).max() < 1e-13
            if engine.name == "step":
                assert np.array_equal(data["steps"], 5 * np.arange(301))


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"duration": 1.1}, "duration = 1.1: must be a whole multiple of sample_interval, 0.5"),
        ({"duration": 0.25}, "duration = 0.25: must be a whole multiple of sample_interval"),
        ({"duration": float("nan")}, "duration = nan: must be positive"),
        ({"sample_interval": 0.0}, "sample_interval = 0.0: must be positive"),
        ({"sample_interval": 1e-10}, "sample_interval = 1e-10: makes more frames"),
        (
            {"engine": gp.TimeStepped(0.2)},
            "sample_interval = 0.5: must be a whole multiple of time_step, 0.2",
        ),
        ({"follow": 5}, "follow = 5: must be at most 4, the number of particles"),
        ({"follow": 0}, "follow = 0: must be a whole number of at least 1"),
        ({"seed": -1}, "seed = -1: must be a whole number"),
        ({"scene": gp.Scene(gp.Container((5.0, 5.0)))}, "a run needs at least one particle"),
        ({"checkpoint_seconds": -1.0}, "checkpoint_seconds = -1.0: must not be negative"),
    ],
)
def test_invalid_settings_are_refused_before_anything_is_written(tmp_path, change, complaint):
    settings = {"scene": gas(2, 4, 0.1), "engine": gp.EventDriven(), "seed": 1, "duration": 1.0}
    settings = {**settings, "sample_interval": 0.5, "path": tmp_path / "run.nc", **change}
    with pytest.raises(gp.SceneError, match=complaint.replace("(", r"\(")):
        gp.run(**settings)
    assert list(tmp_path.iterdir()) == []


def test_a_complete_trajectory_is_kept_and_another_run_never_overwrites_it(tmp_path):
    scene, path = gas(2, 10, 0.1), tmp_path / "run.nc"
    gp.run(scene, gp.EventDriven(), 1, 1.0, 0.5, path)
    before, stamp = path.read_bytes(), path.stat().st_mtime_ns
    gp.run(scene, gp.EventDriven(), 1, 1.0, 0.5, path)
    assert path.stat().st_mtime_ns == stamp
    with pytest.raises(gp.SceneError, match=r"run\.nc.*of another run"):
        gp.run(scene, gp.EventDriven(), 2, 1.0, 0.5, path)
    assert path.read_bytes() == before
    gp.run(scene, gp.EventDriven(), 2, 1.0, 0.5, path, overwrite=True)
    assert read_recipe(path).seed == 2
    assert list(tmp_path.iterdir()) == [path]


def test_a_run_under_way_belongs_to_one_process_and_is_not_replaced_by_another_run(tmp_path):
    scene, path = gas(2, 10, 0.1), tmp_path / "run.nc"
    partial = partial_path(path)
    gp.run(scene, gp.EventDriven(), 1, 1.0, 0.5, path).rename(partial)
    with pytest.raises(gp.SceneError, match=r"run\.nc\.partial.*of another run"):
        gp.run(scene, gp.EventDriven(), 2, 1.0, 0.5, path)
    with only_process(partial), pytest.raises(gp.SceneError, match="another process"):
        gp.resume(path)
    assert gp.resume(path) == path
    with pytest.raises(gp.SceneError, match="already complete"):
        gp.resume(path)
    with pytest.raises(gp.SceneError, match=r"there is no other\.nc\.partial"):
        gp.resume(tmp_path / "other.nc")


def test_what_is_no_complete_trajectory_is_not_called_complete(tmp_path):
    path = tmp_path / "run.nc"
    content = gp.run(gas(2, 10, 0.1), gp.EventDriven(), 1, 1.0, 0.5, path).read_bytes()
    size = (len(content) - len(stored_header_of(path))) // 3
    shorter = bytearray(content[:-size])
    shorter[7] -= 1
    for changed, rule in (
        (b"CDF\x01" + bytes(100), "is not a trajectory written by gaspart"),
        (b"my notes", "is not a readable NetCDF file"),
        (content[:-1], "is truncated"),
        (content[:-9] + b"9" + content[-8:], "frame 2 is damaged"),
        (shorter, r"has 2 of 3 frames, and there is no run\.nc\.partial"),
        (content, "is already complete"),
    ):
        path.write_bytes(changed)
        with pytest.raises(gp.SceneError, match=rule):
            gp.resume(path)


def stored_header_of(path):
    with path.open("rb") as file:
        return stored_header(file)


def test_a_trajectory_ends_in_nc(tmp_path):
    for name in ("gas.txt", "gas", "gas.nc.partial", "gas.gsd"):
        with pytest.raises(gp.SceneError, match="must end in .nc"):
            gp.run(gas(2, 10, 0.1), gp.EventDriven(), 1, 1.0, 0.5, tmp_path / name)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("command", "moment"),
    [
        *product(["resume", "run"], ["begun_as", "may_replace", "is_blank", "open_locked"]),
        ("resume", "read_recipe"),  # `run` reads it under the lock, when no other process can finish the file
    ],
)
def test_a_run_that_another_process_finishes_meanwhile(tmp_path, monkeypatch, command, moment):
    """At each moment at which its files are looked at."""
    recipe, path = (gas(2, 10, 0.1), gp.EventDriven(), 1, 1.0, 0.5), tmp_path / "run.nc"
    complete = gp.run(*recipe, path).read_bytes()
    path.rename(partial_path(path))
    original = getattr(run, moment, None) or getattr(stage, moment)

    def after_it_was_finished(*arguments, **options):
        if not path.exists():
            partial_path(path).rename(path)
        return original(*arguments, **options)

    for module in (run, stage):
        if hasattr(module, moment):
            monkeypatch.setattr(module, moment, after_it_was_finished)
    if command == "resume" and moment in ("read_recipe", "begun_as"):
        with pytest.raises(gp.SceneError, match=r"run\.nc': is already complete"):
            gp.resume(path)
    else:
        assert (gp.resume(path) if command == "resume" else gp.run(*recipe, path)) == path
    assert path.read_bytes() == complete
    assert list(tmp_path.iterdir()) == [path]


def test_a_run_killed_while_its_header_was_written_begins_again(tmp_path):
    path = tmp_path / "run.nc"
    recipe = (gas(2, 10, 0.1), gp.EventDriven(), 1, 1.0, 0.5)
    complete = gp.run(*recipe, path).read_bytes()
    for length in (1, 4, 13, 20, 24, 30, 500):  # of which the first word is written last
        path.unlink()
        partial_path(path).write_bytes((bytes(8) + complete[8:])[:length])
        assert gp.run(*recipe, path).read_bytes() == complete
    assert list(tmp_path.iterdir()) == [path]


def test_files_that_are_no_trajectories(tmp_path):
    import netCDF4

    complete = gp.run(gas(2, 10, 0.1), gp.EventDriven(), 1, 1.0, 0.5, tmp_path / "run.nc").read_bytes()
    with netCDF4.Dataset(tmp_path / "foreign", "w") as file:
        file.title = "of somebody else"
    contents = {"frames": complete[:-1], "header": complete[:600], "text": b"container:\n", "empty": b""}
    for name, content in contents.items():
        (tmp_path / name).write_bytes(content)
    complaints = {
        "missing": "cannot be read: No such file",
        "frames": f"is truncated: {len(complete) - 1} bytes, where 3 frames need {len(complete)}",
        "header": "is truncated or damaged: 600 bytes, where the header alone needs",
        "text": "is not a readable NetCDF file",
        "empty": "is not a readable NetCDF file",
        "foreign": "is not a trajectory written by gaspart",
    }
    for name, complaint in complaints.items():
        with pytest.raises(gp.SceneError, match=complaint) as caught:
            gp.open_trajectory(tmp_path / name)
        assert "\n" not in str(caught.value) and name in str(caught.value)


def test_a_file_that_another_process_appends_to_while_it_is_opened(tmp_path, monkeypatch):
    complete = gp.run(gas(2, 10, 0.1), gp.EventDriven(), 1, 1.0, 0.5, tmp_path / "run.nc").read_bytes()
    with open(tmp_path / "run.nc", "rb") as file:
        frame = amber.frame_bytes(stored_header(file))
    partial = tmp_path / "replica.nc.partial"
    shorter = bytearray(complete[:-frame])
    shorter[7] -= 1
    partial.write_bytes(shorter)
    is_blank = amber.is_blank

    def after_one_more(file):
        partial.write_bytes(complete)
        return is_blank(file)

    monkeypatch.setattr(amber, "is_blank", after_one_more)
    with opening.open_verified(partial) as (_, _, frames):
        assert frames == 3


def test_folders_that_cannot_be_written_to(tmp_path):
    scene = gas(2, 4, 0.1)
    for path in (tmp_path / "nowhere" / "run.nc", tmp_path):
        with pytest.raises(gp.SceneError, match="must be a file in an existing folder"):
            gp.run(scene, gp.EventDriven(), 1, 1.0, 0.5, path)
    assert list(tmp_path.iterdir()) == []


FULL_DISK = """
    import resource, signal, sys
    from scenes import gas
    import gaspart as gp

    limit = int(sys.argv[2])
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    gp.Simulation(gas(2, 100, 0.1), gp.EventDriven(), 1).advance(1.0)  # all kernels are in the cache now
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    try:
        gp.run(gas(2, 100, 0.1), gp.EventDriven(), 1, 10.0, 0.5, sys.argv[1])
    except gp.SceneError as error:
        sys.exit(str(error))
"""


def test_a_full_disk_loses_nothing(tmp_path):
    """A limit on the file's size fails a write where a full disk would: in a frame, or in the header."""
    path, reference = tmp_path / "run.nc", tmp_path / "reference.nc"
    complete = gp.run(gas(2, 100, 0.1), gp.EventDriven(), 1, 10.0, 0.5, reference).read_bytes()
    for limit, frames in ((len(complete) // 2, range(5, 15)), (1000, None)):
        command = [sys.executable, "-c", textwrap.dedent(FULL_DISK), str(path), str(limit)]
        # What measures coverage would have to write as well.
        env = {key: value for key, value in _environment().items() if not key.startswith("COVERAGE")}
        done = subprocess.run(command, capture_output=True, text=True, env=env)
        assert done.returncode == 1
        assert "cannot be written: File too large" in done.stderr and done.stderr.count("\n") == 1
        if frames:
            with gp.open_trajectory(partial_path(path)) as data:
                assert data.sizes["frame"] in frames
            assert gp.resume(path).read_bytes() == complete
            path.unlink()
    assert list(tmp_path.iterdir()) == [reference]


def _environment():
    return {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}


def test_a_broken_invariant_stops_the_run_and_keeps_its_state(tmp_path, monkeypatch):
    path, checked = tmp_path / "run.nc", []

    def check(simulation, state):
        checked.append(simulation.time)
        if simulation.time == 2.0:
            raise gp.SimulationError("at time 2 the energy has drifted")

    monkeypatch.setattr(gp.Simulation, "check_invariants", check)
    with pytest.raises(gp.SimulationError, match=r"drifted; its state is kept in .*run\.nc\.failed\.npz"):
        gp.run(gas(2, 10, 0.1), gp.EventDriven(), 1, 4.0, 0.5, path)
    assert not path.exists()
    with gp.open_trajectory(partial_path(path)) as data:
        assert data["time"].values.tolist() == [0.0, 0.5, 1.0, 1.5]
    with np.load(path.with_name("run.nc.failed.npz")) as kept:
        assert kept["trajectory frames"] == 4


def test_progress_is_reported(tmp_path, monkeypatch):
    monkeypatch.setattr(recording, "_PROGRESS", 0.0)
    reported = []
    settings = {"path": tmp_path / "run.nc", "progress": lambda *x: reported.append(x)}
    gp.run(gas(2, 10, 0.1), gp.EventDriven(), 1, 2.0, 0.5, **settings)
    times, durations, collisions = zip(*reported, strict=True)
    assert times[-1] == 2.0 and set(durations) == {2.0}
    assert list(times) == sorted(times) and list(collisions) == sorted(collisions) and collisions[-1] > 0


def test_a_damaged_checkpoint_costs_the_work_and_nothing_else(tmp_path):
    scene, path = gas(2, 10, 0.1), tmp_path / "run.nc"
    complete = gp.run(scene, gp.EventDriven(), 1, 2.0, 0.5, path).read_bytes()
    kept = gp.run(scene, gp.EventDriven(), 1, 2.0, 0.5, tmp_path / "kept.nc", keep_checkpoint=True)
    written = checkpoint_path(kept).read_bytes()
    checkpoint_path(kept).unlink()
    kept.unlink()
    parts = written[:4], written[:20], written[:200], written[:-1], written[200:]
    for spoilt in (b"", *parts, bytes(200) + written):
        path.rename(partial_path(path))
        checkpoint_path(path).write_bytes(spoilt)
        assert gp.resume(path).read_bytes() == complete
        assert list(tmp_path.iterdir()) == [path]
