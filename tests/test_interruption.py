"""SIGINT and SIGTERM: exit codes, one line, a checkpoint, and the same bytes after a resumption."""

import json
import os
import re
import shlex
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart.interruption import SIGNALS, defer_signals
from gaspart.trajectory import recording
from gaspart.trajectory.opening import checkpoint_path

SCENE = gas(3, 200, 0.2)
ENVIRONMENT = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
STARTED = []
LONG = ["--duration", "1e9", "--sample-interval", "1e6", "--seed", "3", "--quiet"]


def start(*arguments, folder):
    """The command line in a process of its own."""
    command = [sys.executable, "-m", "gaspart", *map(str, arguments)]
    process = subprocess.Popen(
        command, cwd=folder, env=ENVIRONMENT, text=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
    )
    STARTED.append(process)
    return process


@pytest.fixture(autouse=True)
def nothing_runs_on():
    """What a test has started ends with it, also if it fails."""
    yield
    while STARTED:
        STARTED.pop().kill()


def catches(process, number=signal.SIGTERM):
    """Whether a process has set its handler; Python itself sets one for SIGINT only."""
    status = Path(f"/proc/{process.pid}/status").read_text()
    return bool(int(re.search(r"SigCgt:\s*(\w+)", status)[1], 16) >> (number - 1) & 1)


def wait_for(condition):
    deadline = time.monotonic() + 300
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.005)


def ended(process, number):
    """The line that a process prints when it is ended by a signal."""
    process.send_signal(number)
    printed = process.communicate(timeout=120)[1]
    assert process.returncode == 128 + number, printed
    assert printed.count("\n") == 1 and printed.startswith("gaspart: "), printed
    return printed


def test_a_run_with_crossings_only_ends_with_a_checkpoint(tmp_path):
    """Two discs that cross a thin periodic axis, and never meet: there is no event of the model."""
    discs = [gp.Particle((0.5, height), (1.0, 0.0), 0.05) for height in (1e9, 9e9)]
    gp.Scene(gp.Container((1.0, 1e10), "periodic"), particles=discs).to_file(tmp_path / "scene.yaml")
    long = ["--duration", "1e12", "--sample-interval", "1e12", "--checkpoint-seconds", "1", "--quiet"]
    process = start("run", "scene.yaml", "-o", "run.nc", *long, folder=tmp_path)
    wait_for(checkpoint_path(tmp_path / "run.nc").exists)
    assert "continues it from time" in ended(process, signal.SIGINT)


def plain_line(number):
    return f"gaspart: {'interrupted' if number == signal.SIGINT else 'terminated'}\n"


@pytest.fixture
def folder(tmp_path):
    SCENE.to_file(tmp_path / "scene.yaml")
    return tmp_path


def saved_time(path, engine):
    """The time of a run's checkpoint. The clock of the event-driven engine is zero at each epoch's start."""
    with np.load(checkpoint_path(path)) as saved:
        return float(saved["start"] + saved["clock"] if engine == "event" else saved["steps"] * 0.015625)


@pytest.mark.parametrize(("engine", "number"), [("event", signal.SIGINT), ("threads", signal.SIGTERM)])
def test_a_run_ends_with_a_checkpoint_and_says_how_to_continue(folder, engine, number):
    options = ["--checkpoint-seconds", "1"]
    if engine == "threads":
        options += ["--engine", "step", "--time-step", "0.015625", "--threads", "2"]
    process = start("run", "scene.yaml", "-o", "a run.nc", *LONG, *options, folder=folder)
    wait_for(checkpoint_path(folder / "a run.nc").exists)
    before = saved_time(folder / "a run.nc", engine)
    printed = ended(process, number)
    command = re.search(r"`gaspart (resume .*)` continues it from time (\S+) of 1e\+09", printed)
    assert shlex.split(command[1]) == ["resume", "a run.nc"]
    reached = saved_time(folder / "a run.nc", engine)
    assert reached == pytest.approx(float(command[2]), rel=1e-5) and reached > before
    process = start(*shlex.split(command[1]), "--quiet", folder=folder)
    wait_for(lambda: catches(process))
    process.send_signal(number)
    printed = process.communicate(timeout=120)[1]
    assert process.returncode == 128 + number
    early = ("", plain_line(number))  # before the command had started
    assert printed in early or "nothing was changed" in printed or "continues it from time" in printed


@pytest.mark.parametrize(("wait", "number"), [(0.0, signal.SIGTERM), (0.5, signal.SIGINT)])
def test_other_commands_end_at_once_during_imports_too(folder, number, wait):
    # for some seconds; so many more that they need more memory than there is would be refused at once
    process = start("collisions", "scene.yaml", "-o", "met.nc", "--count", "5000000", folder=folder)
    wait_for(lambda: catches(process))
    time.sleep(wait)
    process.send_signal(number)
    printed = process.communicate(timeout=60)[1]
    assert process.returncode == 128 + number
    assert printed in ("", plain_line(number))
    assert [path.name for path in folder.iterdir()] == ["scene.yaml"]


def test_an_ignored_signal_stays_ignored(folder):
    """As in a process in the background of a shell script."""
    handler = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        process = start("run", "scene.yaml", "-o", "run.nc", *LONG, folder=folder)
    finally:
        signal.signal(signal.SIGINT, handler)
    wait_for(lambda: catches(process))
    process.send_signal(signal.SIGINT)
    time.sleep(0.3)
    assert process.poll() is None
    ended(process, signal.SIGTERM)


@pytest.fixture
def interrupted_at(monkeypatch):
    """Let a signal arrive in the middle of a run, between two bytecodes of a stretch."""
    monkeypatch.setattr(gp.EventDriven, "first_segment", 20)
    monkeypatch.setattr(recording, "_SEGMENT", 1e-9)
    advance = gp.Simulation.advance

    def interrupted_at(when, number):
        def advance_and_interrupt(simulation, **limits):
            advance(simulation, **limits)
            if simulation.time >= when and when not in done:
                done.add(when)
                signal.raise_signal(number)

        done = set()
        monkeypatch.setattr(gp.Simulation, "advance", advance_and_interrupt)

    return interrupted_at


def test_python_raises_keyboard_interrupt_after_a_checkpoint(tmp_path, interrupted_at):
    whole = gp.run(SCENE, gp.EventDriven(), 3, 4.0, 0.5, tmp_path / "whole.nc").read_bytes()
    handlers = [signal.getsignal(number) for number in SIGNALS]
    interrupted_at(1.7, signal.SIGINT)
    path = tmp_path / "run.nc"
    with pytest.raises(KeyboardInterrupt):
        gp.run(SCENE, gp.EventDriven(), 3, 4.0, 0.5, path)
    assert [signal.getsignal(number) for number in SIGNALS] == handlers
    with np.load(checkpoint_path(path)) as saved:
        assert saved["trajectory frames"] == 4
    assert gp.resume(path).read_bytes() == whole


@pytest.mark.parametrize("number", SIGNALS, ids=["SIGINT", "SIGTERM"])
def test_a_program_with_a_handler_of_its_own_decides(tmp_path, interrupted_at, number):
    whole = gp.run(SCENE, gp.EventDriven(), 3, 4.0, 0.5, tmp_path / "whole.nc").read_bytes()
    path, calls = tmp_path / "run.nc", []
    before = signal.signal(number, lambda *_: calls.append(checkpoint_path(path).exists()))
    try:
        interrupted_at(1.7, number)
        assert gp.run(SCENE, gp.EventDriven(), 3, 4.0, 0.5, path).read_bytes() == whole
    finally:
        signal.signal(number, before)
    assert calls == [True]


def test_a_signal_at_the_end_of_the_work_is_not_lost():
    with pytest.raises(KeyboardInterrupt), defer_signals() as signals:
        signal.raise_signal(signal.SIGINT)
        assert signals.pending == signal.SIGINT


JOB = """
    import sys
    from pathlib import Path
    from types import SimpleNamespace

    folder, script = Path(sys.argv[1]), sys.argv[2]
    scene = {"container": {"lengths": [9.0, 9.0]}, "species": [{"count": 9, "radius": 0.5, "speed": 1.0}]}
    recipe = {"scene": scene, "engine": {"name": "event"}, "seeds": [[1], [2]], "duration": 1e9}
    recipe |= {"sample_interval": 1e6, "displacements": False, "follow": None, "correlations": None}
    snakemake = SimpleNamespace(
        rule="simulate", wildcards=["gas"], log=[str(folder / "log")], output=[str(folder / "point")],
        params=SimpleNamespace(parameters=recipe, job="simulate"),
    )
    sys.path.insert(0, str(Path(script).parent))
    exec(Path(script).read_text())
"""


def test_a_job_of_the_workflow_ends_with_a_checkpoint(tmp_path):
    script = Path(__file__).parents[1] / "workflow/scripts/simulate.py"
    process = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(JOB), tmp_path, script], text=True, stderr=subprocess.PIPE
    )
    begun = tmp_path / "point.partial/replica-0.nc.partial"
    wait_for(lambda: begun.exists() or process.poll() is not None)
    time.sleep(3.0)
    process.send_signal(signal.SIGTERM)
    printed = process.communicate(timeout=120)[1]
    assert process.returncode == 143, printed
    assert re.fullmatch(r"gaspart: simulate gas: terminated; .*\(\S+log\)\n", printed), printed
    assert "Traceback" not in (tmp_path / "log").read_text()
    saved = (tmp_path / "point.partial/replica-0.nc.checkpoint.npz").exists()
    assert saved == ("`gaspart resume" in printed)


@pytest.mark.parametrize("signals", [6, pytest.param(500, marks=pytest.mark.thorough)])
def test_runs_that_are_disturbed_at_random_moments_end_in_the_same_bytes(tmp_path, signals):
    """For both engines, with one and two threads. A large number takes a quarter of an hour."""
    script = Path(__file__).with_name("kills.py")
    command = [sys.executable, script, tmp_path, str(signals), str(signals)]
    done = subprocess.run(command, capture_output=True, text=True, env=ENVIRONMENT)
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    assert report["signals"] >= signals


def test_a_folder_goes_with_its_process(tmp_path):
    code = (
        "import sys, time; from gaspart.interruption import exit_on_signals, scratch_folder\n"
        "exit_on_signals()\nwith scratch_folder() as folder:\n"
        "    (folder / 'a').touch(); print(folder, flush=True); time.sleep(60)"
    )
    environment = {**ENVIRONMENT, "TMPDIR": str(tmp_path)}
    process = subprocess.Popen(
        [sys.executable, "-c", code], env=environment, stdout=subprocess.PIPE, text=True
    )
    assert Path(process.stdout.readline().strip()).parent == tmp_path
    process.terminate()
    assert process.wait() == 143 and not os.listdir(tmp_path)


def test_a_signal_in_the_first_milliseconds_costs_one_line():
    early = "import os, signal, gaspart.__main__ as m; m._exit(signal.SIGTERM, None)"
    done = subprocess.run([sys.executable, "-c", early], env=ENVIRONMENT, capture_output=True)
    assert (done.returncode, done.stderr) == (143, b"gaspart: terminated\n")


def test_a_home_that_cannot_be_written_costs_no_line(folder):
    environment = {**ENVIRONMENT, "HOME": "/dev/null", "XDG_CACHE_HOME": "", "XDG_CONFIG_HOME": ""}
    environment.pop("MPLCONFIGDIR", None)
    code = "from gaspart.__main__ import main; main(); import matplotlib; matplotlib.get_cachedir()"
    done = subprocess.run(
        [sys.executable, "-c", code, "info", "nowhere.nc"],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
    )
    assert done.stderr.count("\n") == 1 and done.stderr.startswith("gaspart: error: file = 'nowhere.nc'")


def test_streams_that_are_full_or_closed(folder):
    def shell(line):
        command = f"{shlex.quote(sys.executable)} -m gaspart {line}"
        return subprocess.run(
            ["bash", "-c", command], cwd=folder, env=ENVIRONMENT, capture_output=True, text=True
        )

    short = "--duration 1 --sample-interval 0.5"
    for number, redirection in enumerate(("2>&-", ">&-", "2>/dev/full", ">&- 2>&- <&-")):
        done = shell(f"run scene.yaml -o {number}.nc {short} {redirection}")
        assert (done.returncode, done.stderr) == (0, ""), redirection
        assert (folder / f"{number}.nc").read_bytes() == (folder / "0.nc").read_bytes()
    done = shell("info 0.nc >/dev/full")
    assert done.returncode == 1
    assert done.stderr == "gaspart: error: a file or the standard output: No space left on device\n"
    for command in ("--help", "--version", "new --list"):
        assert shell(f"{command} >/dev/full").stderr == done.stderr
    for command in (
        "theory Z --eta 0.3",
        "info 0.nc",
        "check scene.yaml",
        "--help",
        "--version",
        "new --list",
    ):
        done = shell(f"{command} >&-")
        assert done.returncode == 1
        assert done.stderr == "gaspart: error: a file or the standard output: Bad file descriptor\n"
    assert shell("info nowhere.nc 2>/dev/full").returncode == 2
    assert shell("info nowhere.nc 2>&-").returncode == 2


def test_too_few_file_descriptors_never_change_the_file(folder):
    """Git, which is asked for the revision, was not started, and the file had none."""
    undisturbed = subprocess.run(["bash", "-c", run_with(256, "whole.nc")], cwd=folder, env=ENVIRONMENT)
    assert undisturbed.returncode == 0
    for limit in (8, 12):
        done = subprocess.run(
            ["bash", "-c", run_with(limit, "run.nc")],
            cwd=folder,
            env=ENVIRONMENT,
            capture_output=True,
            text=True,
        )
        if done.returncode == 0:
            assert (folder / "run.nc").read_bytes() == (folder / "whole.nc").read_bytes()
            (folder / "run.nc").unlink()
        else:
            assert done.returncode in (1, 2) and "Too many open files" in done.stderr
            assert done.stderr.count("\n") == 1


def run_with(limit, name):
    options = "--duration 1 --sample-interval 0.5"
    return (
        f"ulimit -n {limit}; exec {shlex.quote(sys.executable)} -m gaspart run scene.yaml -o {name} {options}"
    )
