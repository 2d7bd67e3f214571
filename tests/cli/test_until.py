"""`gaspart run --until`: what is printed, what `info` states, and what is refused."""

import shlex

import pytest

import gaspart as gp
from gaspart.accuracy.reached import AccuracyStatus
from gaspart.cli import main, run
from gaspart.trajectory.opening import partial_path

GAS = """\
container: {lengths: [5.0, 5.0, 5.0], boundary: periodic}
species:
- {count: 32, radius: 0.5, temperature: 1.0}
"""
RUN = ["run", "scene.yaml", "-o", "run.nc", "--quiet"]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.yaml").write_text(GAS)
    return tmp_path


def test_a_run_until_it_is_accurate_and_the_command_that_reproduces_it(folder, capsys):
    asked = ["--until", "Z=0.05", "--until", "collision_rate=0.05", "--start", "4", "--at-most", "1e3"]
    assert main([*RUN, *asked]) == 0
    z, rate, last = capsys.readouterr().out.splitlines()
    assert z.startswith("Z = 1.7") and "95 % interval 1.7" in z and z.endswith("required 0.05: reached")
    assert rate.startswith("collision_rate = ") and rate.endswith(": reached")
    assert last.startswith("run.nc is complete")
    written = (folder / "run.nc").read_bytes()
    assert main(["info", "run.nc"]) == 0
    output = capsys.readouterr().out.splitlines()
    assert ": 32 hard spheres, " in output[0] and output[0].endswith(" frames, complete")
    stated = "runs until Z=0.05, collision_rate=0.05 (relative standard errors), at most until time 1000"
    assert output[1:4] == [stated, z, rate]
    (command,) = [line.strip() for line in output if line.startswith("    gaspart run scene.yaml")]
    assert main([*shlex.split(command)[1:], "--force"]) == 0
    assert (folder / "run.nc").read_bytes() == written
    (folder / "run.nc").rename(partial_path(folder / "run.nc"))
    capsys.readouterr()
    assert main(["info", "run.nc"]) == 0
    assert "unfinished: `gaspart resume` continues it" in capsys.readouterr().out
    assert main(["resume", "run.nc", "--quiet"]) == 0
    assert capsys.readouterr().out.splitlines() == [z, rate, last]
    assert (folder / "run.nc").read_bytes() == written


def test_the_longest_duration_ends_a_run_with_a_line_that_says_what_was_reached(folder, capsys):
    assert (
        main([*RUN, "--sample-interval", "0.3", "--until", "Z=1e-4", "--until", "D=0.1", "--at-most", "9"])
        == 0
    )
    z, d, end, _ = capsys.readouterr().out.splitlines()
    assert "required 0.0001: not reached" in z
    assert d.startswith("D: required 0.1, not measured: duration: must cover 48 collisions of a particle")
    assert end == "the longest duration (--at-most) ended the run before all were reached"


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (["--until", "Z"], "'Z' must be the name of an observable, = and its relative accuracy"),
        (["--until", "Q=0.1"], "until.observable = 'Q': unknown observable; known are Z, pressure,"),
        (["--until", "Z=0"], "until.accuracy = 0.0: must be from 1e-08 to 1"),
        (["--until", "Z=0.1", "--duration", "9"], "--duration: excludes --until; the longest"),
        (["--until", "Z=0.1", "--at-most", "0"], "at_most = 0.0: must be positive"),
        (
            ["--until", "pressure:x low=0.1"],
            "until = 'pressure:x low': container.boundary: has no walls: measure",
        ),
        (["--at-most", "9"], "--at-most: needs --until"),
        ([], "required: --duration, --sample-interval, or --until; for this scene"),
    ],
)
def test_what_is_refused_in_one_line(folder, capsys, options, complaint):
    assert main([*RUN, *options]) == 2
    error = capsys.readouterr().err
    assert complaint in error and error.count("\n") == 1
    assert [path.name for path in folder.iterdir()] == ["scene.yaml"]


def test_the_line_of_progress_states_the_error_that_is_worst_beside_the_required_one():
    z = AccuracyStatus(gp.Accuracy("Z", 1e-3), "", 2.0, 2.0, 4e-3, 20.0, True)
    rate = AccuracyStatus(gp.Accuracy("collision_rate", 1e-2), "", 3.0, 3.0, 0.05, 20.0, True)
    status = run._Status()
    assert status.remark() == ""
    status.update([AccuracyStatus(gp.Accuracy("D", 0.1), rule="frames: few")])
    assert status.remark() == ""
    status.update([rate, z])
    assert status.remark() == "  Z: error 0.002, at most 0.0025, required 0.001"
