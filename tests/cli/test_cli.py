"""The command line."""

import io
import os
import re
import shlex
import subprocess
import sys
import threading
from pathlib import Path

import pytest
import xarray as xr

import gaspart as gp
from gaspart import theory
from gaspart.cli import main, progress

GAS = """\
container: {lengths: [12.0, 12.0], boundary: wall}
species:
- {count: 20, radius: 0.5, temperature: 1.0}
"""
PERIODIC = """\
container: {lengths: [20.0, 20.0], boundary: periodic}
species:
- {count: 200, radius: 0.5, temperature: 1.0}
"""
CONFIGS = Path(__file__).parents[2] / "config"
BRIEFLY = ["--duration", "1", "--sample-interval", "0.5"]


def shell(*arguments, folder):
    """`python -m gaspart` in a process of its own."""
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-m", "gaspart", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, cwd=folder, env=env)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.yaml").write_text(GAS)
    return tmp_path


@pytest.mark.interpreted
def test_run_info_and_the_command_that_reproduces_it(folder, capsys):
    for options in (
        ["--engine", "event", "--boxes-per-side", "3,4", "--seed", "1,2", "--displacements", "--follow", "9"],
        ["--engine", "step", "--time-step", "0.1", "--precision", "float32", "--no-rewind"],
        ["--boxes-per-side", "3,4", "--seed", "1,2", "--correlations", "0.125,3,0.25"],
    ):
        assert main(["run", "scene.yaml", "-o", "run.nc", *BRIEFLY, *options, "--force"]) == 0
        capsys.readouterr()
        assert main(["info", "run.nc"]) == 0
        output = capsys.readouterr().out
        assert "20 hard discs, 3 of 3 frames, complete" in output
        assert f"gaspart {gp.__version__}, python " in output
        assert re.search(r"drift of the energy: \d\.\de-\d\d", output)
        assert " collisions per particle" in output
        assert main(["info", "run.nc", "--scene"]) == 0
        (folder / "again.yaml").write_text(capsys.readouterr().out)
        command = shlex.split(re.search(r"gaspart (run scene.yaml .*)", output)[1])
        command[1] = "again.yaml"
        command[command.index("run.nc")] = "again.nc"
        assert main([*command, "--force"]) == 0
        assert (folder / "again.nc").read_bytes() == (folder / "run.nc").read_bytes()


@pytest.mark.interpreted
def test_resume_and_info_of_an_unfinished_run(folder, capsys):
    assert main(["run", "scene.yaml", "-o", "run.nc", *BRIEFLY]) == 0
    complete = (folder / "run.nc").read_bytes()
    (folder / "run.nc").rename(folder / "run.nc.partial")
    with (folder / "run.nc.partial").open("r+b") as file:  # as after two frames
        file.seek(7)
        file.write(b"\x02")
    assert main(["info", "run.nc"]) == 0
    assert "2 of 3 frames, unfinished: `gaspart resume`" in capsys.readouterr().out
    assert main(["resume", "run.nc"]) == 0
    assert (folder / "run.nc").read_bytes() == complete
    assert main(["resume", "run.nc"]) == 2
    assert "already complete" in capsys.readouterr().err


def test_collisions_become_a_data_set(folder, capsys):
    assert main(["collisions", "scene.yaml", "-o", "met.nc", "--count", "100", "--seed", "4"]) == 0
    assert "collisions, mean free path" in capsys.readouterr().out
    with xr.open_dataset(folder / "met.nc") as data:
        same = gp.collision_data(gp.Scene.from_file("scene.yaml"), 100, seed=4)
        assert data.identical(same)
    assert main(["collisions", "scene.yaml", "-o", "nowhere/met.nc", "--count", "5"]) == 2


def test_no_command_is_a_mistake_and_the_version_is_printed(tmp_path):
    assert shell(folder=tmp_path).returncode == 2
    assert shell("--version", folder=tmp_path).stdout == f"gaspart {gp.__version__}\n"


def test_a_broken_invariant_is_exit_code_1_and_ctrl_c_130(folder, capsys, monkeypatch):
    for error, code, text in (
        (gp.SimulationError("the energy\nhas drifted"), 1, "the energy has drifted"),
        (KeyboardInterrupt(), 130, "interrupted"),
        (MemoryError(), 1, "not enough memory"),
        (OSError(5, "Input/output error", "run.nc"), 1, "run.nc: Input/output error"),
    ):
        monkeypatch.setattr("gaspart.runs.entry.run", lambda *_, error=error, **__: throw(error))
        assert main(["run", "scene.yaml", "-o", "run.nc", *BRIEFLY]) == code
        output = capsys.readouterr().err
        assert text in output and output.count("\n") == 1


def test_progress_is_one_line_on_a_terminal_and_nothing_elsewhere(monkeypatch):
    assert progress.progress(quiet=False) is None and progress.progress(quiet=True) is None
    terminal = io.StringIO()
    terminal.isatty = lambda: True
    monkeypatch.setattr(sys, "stderr", terminal)
    clock = iter([100.0, 110.0])
    monkeypatch.setattr(progress.time, "monotonic", lambda: next(clock))
    show = progress.progress(quiet=False)
    show(20.0, 100.0, 1000)
    show(40.0, 100.0, 51000)
    assert terminal.getvalue() == "\r\033[K 40.0%  5e+03 collisions/s  0:00:30 left"


def test_waiting_is_shown_on_a_terminal_after_a_while(monkeypatch):
    shown = threading.Event()

    class Terminal(io.StringIO):
        def isatty(self):
            return True

        def write(self, text):
            shown.set()
            return super().write(text)

    monkeypatch.setattr(sys, "stderr", Terminal())
    monkeypatch.setattr(progress, "_PATIENCE", 0.0)
    with progress.waiting("compiling") as end:
        assert shown.wait(60.0)
        end()
        written = sys.stderr.getvalue()
        assert written.startswith("\r\033[Kcompiling 0:00:00") and written.endswith("\r\033[K")
    assert sys.stderr.getvalue() == written  # it has ended
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    with progress.waiting("compiling"):
        pass
    assert progress.picture_progress() is None and sys.stderr.getvalue() == ""


def throw(error):
    raise error


@pytest.mark.filterwarnings("error")
def test_theory(capsys):
    assert main(["theory", "Z", "--eta", "0.3"]) == 0
    output = capsys.readouterr().out
    first, source, domain = output.splitlines()
    value, error = re.fullmatch(r"Z\(eta = 0\.3, dimension = 3\) = (\S+) \+- (\S+)", first).groups()
    assert "Kolafa" in source and "from 0 to 0.539" in domain
    assert float(value) == pytest.approx(float(theory.compressibility_factor(0.3, 3)), rel=1e-9)
    assert 0 < float(error) < 1e-3

    assert main(["theory", "collision_rate", "--eta", "0.1,0.2", "--dimension", "2", "--mass", "4"]) == 0
    values = [float(line.split(" = ")[-1]) for line in capsys.readouterr().out.splitlines()[:2]]
    assert values == pytest.approx([float(theory.collision_rate(eta, 2, mass=4.0)) for eta in (0.1, 0.2)])

    for name in ("contact_value", "mean_free_path", "diffusion_coefficient", "viscosity"):
        assert main(["theory", name, "--eta", "0.1", "--dimension", "2"]) == 0
        assert main(["theory", name, "--eta", "1e308"]) == 2

    capsys.readouterr()
    for wrong, complaint in (
        (["Z", "--eta", "0.9", "--dimension", "3"], "holds from 0 to"),
        (["Z", "--eta", "nan"], "'nan' must be a finite number and at least 0"),
        (["collision_rate", "--eta", "0.1", "--diameter=-1"], "'-1' must be a finite number and above 0"),
        (["viscosity", "--eta", "0.1", "--diameter", "1e308"], "diameter = 1e+308: must be from 1e-30 to"),
        (["Z", "--eta", "0.1", "--dimension", "4"], "--dimension: 4: unknown name; known are 2, 3"),
        (["Z", "--eta", "0.1", "--dimension", "3", "--mass", "2"], "mass = 2.0: Z does not depend on it"),
    ):
        assert main(["theory", *wrong]) == 2
        output = capsys.readouterr().err
        assert complaint in output and output.count("\n") == 1


@pytest.mark.interpreted
def test_check_reports_failed_checks_by_its_exit_code(folder, capsys):
    assert main(["check", "scene.yaml"]) == 0
    assert main(["run", "scene.yaml", "-o", "run.nc", *BRIEFLY]) == 0
    assert main(["check", "run.nc"]) == 0
    capsys.readouterr()
    assert main(["check", "run.nc", "--radius", "2"]) == 1
    assert "WRONG overlaps: the deepest is 0." in capsys.readouterr().out
    assert main(["check", "run.nc", "--lengths", "8,12"]) == 1
    assert "WRONG container" in capsys.readouterr().out
    assert main(["check", "run.nc", "--boundary", "periodic"]) == 1
    assert "WRONG momentum" in capsys.readouterr().out
    for wrong, complaint in (
        (["scene.yaml", "--radius", "1"], "radius = 1.0: has a meaning for trajectories only"),
        (["run.pdb"], "must end in .yaml, .nc, .gsd, .xyz"),
    ):
        assert main(["check", *wrong]) == 2
        output = capsys.readouterr().err
        assert complaint in output and output.count("\n") == 1


def test_check_of_a_config_is_that_of_the_workflow(folder, capsys):
    assert main(["check", str(CONFIGS / "paper.yaml")]) == 0
    assert re.search(r"ok +config: \d+ experiments of \d+ points", capsys.readouterr().out)
    (folder / "alone.yaml").write_text("experiments: {}\n")
    assert main(["check", "alone.yaml"]) == 2
    assert "alone.yaml: title = None: is required" in capsys.readouterr().err


def test_advice_names_engine_length_cost_and_reason(folder, capsys):
    (folder / "gas.yaml").write_text(PERIODIC)
    assert main(["advise", "gas.yaml", "--observable", "Z", "--accuracy", "0.01", "--budget", "60s"]) == 0
    output = capsys.readouterr().out
    for part in ("engine ", "replicas ", "run length ", "predicted cost ", "standard error ", "why not "):
        assert part in output
    (folder / "empty.yaml").write_text(PERIODIC.replace("200", "0"))
    for wrong, complaint in (
        (["gas.yaml", "--accuracy", "2"], "accuracy = 2"),
        (["empty.yaml"], "count = 0: advice is for a gas: the scene is empty"),
    ):
        assert main(["advise", *wrong]) == 2
        output = capsys.readouterr().err
        assert complaint in output and output.count("\n") == 1
