"""Replicas that are killed, one or all, end in the bits of undisturbed ones."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from scenes import gas

import gaspart as gp
from gaspart.trajectory.amber import frame_count
from gaspart.trajectory.opening import partial_path

GASPART = [sys.executable, "-m", "gaspart"]
RUN = ["run", "scene.yaml", "-o", "run.nc", "--replicas", "2", "--seed", "4", "--sample-interval", "0.5"]
RUN += ["--duration", "160", "--displacements", "--quiet"]
OFTEN = ["--checkpoint-seconds", "0"]


def command(folder, *arguments):
    """Begin a command in a folder, at no git revision: somebody may edit the checkout meanwhile."""
    environment = os.environ | {"GIT_DIR": str(folder)}
    return subprocess.Popen(
        [*GASPART, *arguments], cwd=folder, env=environment, stderr=subprocess.PIPE, text=True
    )


def completed(folder, *arguments):
    """Carry out a command; returns the bytes of both replicas."""
    process = command(folder, *arguments)
    errors = process.communicate()[1]
    assert process.returncode == 0, errors
    assert not list(folder.glob("*.partial"))
    return [path.read_bytes() for path in gp.replica_paths(folder / "run.nc", 2)]


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    gas(3, 500, 0.3).to_file(folder / "scene.yaml")
    return completed(folder, *RUN)


def children(process):
    """The numbers of its processes."""
    return [int(n) for n in Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()]


def there(process):
    """Whether a process goes on: it exists, and has not ended."""
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state not in "ZX"


def wait(condition):
    deadline = time.monotonic() + 120.0
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.003)


def frames(path):
    """Those of an unfinished file, 0 before it has a header."""
    partial = partial_path(path)
    if not partial.exists() or partial.stat().st_size < 1024:
        return 0
    with partial.open("rb") as file:
        return frame_count(file)


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="finds processes as Linux does")
@pytest.mark.parametrize(
    ("disturbed", "again"),
    [
        ("all, by SIGINT", ["resume", "run.nc"]),
        pytest.param("all, by SIGKILL", RUN, marks=pytest.mark.thorough),
        pytest.param("one", ["resume", "run-2.nc"], marks=pytest.mark.thorough),
        ("the other one", RUN),
    ],
)
def test_killed_replicas_are_continued_to_the_same_bits(tmp_path, whole, disturbed, again):
    gas(3, 500, 0.3).to_file(tmp_path / "scene.yaml")
    files = gp.replica_paths(tmp_path / "run.nc", 2)
    process = command(tmp_path, *RUN, *OFTEN)
    wait(lambda: all(frames(path) >= 3 for path in files))
    workers = children(process)
    assert len(workers) == 2 and process.poll() is None
    if disturbed.startswith("all"):
        process.send_signal(signal.SIGINT if "INT" in disturbed else signal.SIGKILL)
    else:
        os.kill(workers[disturbed == "the other one"], signal.SIGKILL)
    errors = process.communicate()[1]
    wait(lambda: not any(map(there, workers)))  # none outlives the command
    if disturbed == "all, by SIGINT":
        assert process.returncode == 130 and "the same command continues it" in errors
    elif disturbed == "all, by SIGKILL":
        assert process.returncode == -9 and errors == ""
    else:
        assert process.returncode == 1 and "its process ended with code -9; the same command" in errors
    assert errors.count("\n") <= 1 and list(tmp_path.glob("*.partial"))
    assert completed(tmp_path, *again) == whole


def test_replicas_are_continued_to_a_longer_duration(tmp_path, whole):
    gas(3, 500, 0.3).to_file(tmp_path / "scene.yaml")
    short = [*RUN[: RUN.index("160")], "80", "--displacements", "--quiet", "--keep-checkpoint"]
    assert completed(tmp_path, *short) != whole
    assert completed(tmp_path, "resume", "run.nc", "--duration", "160") == whole
