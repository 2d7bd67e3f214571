"""A sweep in several processes, of which signals end the one that called it."""

import hashlib
import os
import re
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

SCRIPT = """
import sys
import gaspart as gp

scene = gp.Scene(gp.Container((30.0, 30.0)), [gp.Species(250, 0.5, temperature=1.0)], gravity=(0.0, -0.1))
over = {"gravity": [[0.0, -0.1], [0.0, -0.2], [0.0, -0.3]]}
options = {"folder": "swept", "duration": 2400.0, "samples": 400, "workers": int(sys.argv[1])}
data = gp.sweep(scene, over, ["collision_rate"], **options)
print(set(data.failure.values))
"""


def begun(folder, workers):
    folder.mkdir(exist_ok=True)
    command = [sys.executable, "-c", SCRIPT, str(workers)]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.Popen(command, cwd=folder, text=True, **pipes)


def processes_of(folder):
    """The processes whose working directory is a folder."""
    found = []
    for path in Path("/proc").glob("[0-9]*"):
        try:
            if os.readlink(path / "cwd") == str(folder) and (path / "stat").read_text().split()[2] != "Z":
                found.append(int(path.name))
        except OSError:  # it has ended, or is another user's
            continue
    return found


def under_way(folder):
    """Whether a point has several frames. On a busy machine the other one may begin when it is done."""
    for path in folder.rglob("*.nc.partial"):
        with suppress(FileNotFoundError):  # renamed meanwhile: the point is done
            if path.stat().st_size > 100_000:
                return True
    return False


def made(folder):
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in folder.rglob("*")
        if path.is_file()
    }


def until(condition):
    for _ in range(6000):
        if condition():
            return True
        time.sleep(0.05)
    return False


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    output, _ = begun(folder, 1).communicate()
    assert output == "{''}\n"
    return made(folder)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_no_process_outlives_the_caller_and_no_bit_changes(tmp_path, whole, number):
    folder = tmp_path / "run"
    first = begun(folder, 2)
    assert until(lambda: under_way(folder))
    assert len(processes_of(folder)) > 1
    first.send_signal(number)
    output, errors = first.communicate()
    assert first.returncode == -number and output == ""
    assert re.fullmatch(r"(\d of 3 points: .*\n)*", errors)
    assert until(lambda: not processes_of(folder))
    saved = len(list(folder.rglob("*.checkpoint.npz")))
    assert saved > 0 or number == signal.SIGKILL
    output, errors = begun(folder, 2).communicate()
    assert output == "{''}\n" and errors.count("\n") == 3
    assert made(folder) == whole


def test_a_process_that_is_killed_costs_its_own_point(tmp_path):
    folder = tmp_path / "run"
    first = begun(folder, 2)
    assert until(lambda: under_way(folder))
    worker = next(one for one in processes_of(folder) if one != first.pid)
    os.kill(worker, signal.SIGKILL)
    output, errors = first.communicate()
    assert first.returncode == 0 and "its process ended with code -9" in output and "''" in output
    assert len(list(folder.rglob("*.nc"))) == 2 and "is NaN: its process ended with code -9" in errors
