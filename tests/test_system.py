"""What Windows does not have, simulated here: no test was run on Windows itself."""

import os
import subprocess
import sys
import textwrap

import pytest

from gaspart import files, system

WITHOUT = """
    import os, signal, sys, warnings
    sys.modules["fcntl"] = None  # an import of it fails
    for module, names in {
        os: "fork getuid geteuid pread pwrite sysconf O_NOFOLLOW O_NONBLOCK",
        signal: "siginterrupt SIGHUP SIGKILL",
    }.items():
        for name in names.split():
            delattr(module, name)
    import gaspart.system
    gaspart.system.POSIX = False
    warnings.simplefilter("ignore")  # filelock says that it has no lock of the system
    import gaspart as gp
    from gaspart.errors import SceneError
    from gaspart.interruption import exit_on_signals
    from gaspart.reproduction.families.stability.measure import run_guarded
    from gaspart.reproduction.sweep import make_all

    exit_on_signals()
    box = gp.Container((8.0, 8.0), boundary="periodic")
    scene = gp.Scene(container=box, species=[gp.Species(count=10, radius=0.5, temperature=1.0)])
    for overwrite in (False, True):
        gp.run(scene, gp.EventDriven(), 1, 1.0, 0.0625, "run.nc", keep_checkpoint=True, overwrite=overwrite)
    assert sorted(os.listdir()) == ["run.nc", "run.nc.checkpoint.npz"]
    gp.resume("run.nc", duration=2.0)
    gp.view("run.nc").save("view.html")
    print(gp.analysis.collision_rate("run.nc").estimate.item() > 0.0)
    for refused in (lambda: run_guarded(print, [1], 1.0), lambda: make_all([], 2, False, print)):
        try:
            refused()
        except SceneError as error:
            print(error)
"""


def test_a_run_needs_nothing_that_windows_lacks(tmp_path):
    command = [sys.executable, "-c", textwrap.dedent(WITHOUT)]
    found = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert found.returncode == 0, found.stderr
    measured, fork, workers = found.stdout.splitlines()
    assert measured == "True" and "needs one that forks processes" in fork
    assert workers.startswith("workers = 2: more than one process needs Linux or macOS")
    assert sorted(os.listdir(tmp_path)) == ["run.nc", "run.nc.checkpoint.npz", "view.html"]


@pytest.mark.parametrize("there", [True, False])
def test_bytes_at_a_place_leave_the_position(tmp_path, monkeypatch, there):
    path = tmp_path / "file"
    path.write_bytes(b"0123456789")
    if not there:
        monkeypatch.delattr(os, "pread")
        monkeypatch.delattr(os, "pwrite")
    with path.open("r+b", buffering=0) as file:
        file.seek(7)
        system.write_at(file.fileno(), b"ab", 2)
        assert system.read_at(file.fileno(), 3, 1) == b"1ab"
        assert file.read() == b"789"


def test_a_path_belongs_to_one_process_and_its_lock_is_removed(tmp_path):
    path, lock = tmp_path / "run.nc.partial", tmp_path / "run.nc.partial.lock"
    with files.only_process(path):
        assert lock.exists()
        with pytest.raises(BlockingIOError), files.only_process(path):
            pass
        assert lock.exists()
    assert not lock.exists()


def test_a_file_that_is_no_lock_is_kept(tmp_path):
    lock = tmp_path / "run.nc.lock"
    lock.write_text("my notes")
    with pytest.raises(files.SceneError, match="is not a lock"), files.only_process(tmp_path / "run.nc"):
        pass
    assert lock.read_text() == "my notes"
