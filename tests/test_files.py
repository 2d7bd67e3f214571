"""The writer of all results: what it replaces, what it leaves behind, and how it fails; locks of paths."""

import errno
import os
import stat
import subprocess
import sys
import textwrap
from pathlib import Path
from types import SimpleNamespace

import pytest
from machine import WITHOUT_RIGHTS, why_not

import gaspart as gp
from gaspart import files
from gaspart.analysis.collisions import record_collisions
from gaspart.cli import main
from gaspart.files import FileKind, begins_with, writing
from gaspart.trajectory import run as trajectory

GAS = """\
container: {lengths: [12.0, 12.0], boundary: wall}
species:
- {count: 20, radius: 0.5, temperature: 1.0}
"""
TEXT = FileKind("a text of ours", begins_with(b"ours"))
OUTPUTS = {
    "met.nc": ["collisions", "scene.yaml", "--count", "20"],
    "state.gsd": ["export", "run.nc"],
    "state.data": ["export", "run.nc"],
    "a.png": ["render", "run.nc", "--size", "64x48"],
    "a.gif": ["render", "run.nc", "--size", "64x48", "--plain"],
    "a.mp4": ["render", "run.nc", "--size", "64x48", "--plain"],
    "again.nc": ["run", "scene.yaml", "--duration", "1", "--sample-interval", "0.5", "--seed", "2"],
}


@pytest.fixture(scope="module")
def scene():
    return gp.Scene(gp.Container((12.0, 12.0)), [gp.Species(20, 0.5, temperature=1.0)])


@pytest.fixture
def folder(tmp_path, monkeypatch, scene):
    """The working folder, with a scene and a trajectory of three frames."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.yaml").write_text(GAS)
    gp.run(scene, gp.EventDriven(), 1, 1.0, 0.5, tmp_path / "run.nc")
    return tmp_path


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def refused(capsys, *command):
    """The one line with which a command is refused."""
    capsys.readouterr()  # what commands before it have printed
    assert main([str(part) for part in command]) == 2
    line = capsys.readouterr().err
    assert line.startswith("gaspart: error: ") and line.count("\n") == 1
    return line


@pytest.mark.parametrize("output", OUTPUTS)
def test_a_result_is_replaced_with_force_only_and_another_file_never(folder, capsys, output):
    command = [*OUTPUTS[output], "-o", output]
    other = "no file of this kind, but important to its owner"
    (folder / output).write_text(other)
    before = contents(folder)
    for force in ([], ["--force"]):
        assert "exists and is not " in refused(capsys, *command, *force)
        assert contents(folder) == before
    (folder / output).unlink()
    assert main(command) == 0
    result = (folder / output).read_bytes()
    if output == "again.nc":
        command[command.index("--seed") + 1] = "3"
    before = contents(folder)
    assert "(--force)" in refused(capsys, *command)
    assert contents(folder) == before
    assert main([*command, "--force"]) == 0
    assert contents(folder).keys() == before.keys()
    assert ((folder / output).read_bytes() == result) == (output != "again.nc")
    assert stat.S_IMODE((folder / output).stat().st_mode) == stat.S_IMODE(
        (folder / "scene.yaml").stat().st_mode
    )


def test_inputs_and_trajectories_are_never_replaced(folder, capsys):
    (folder / "run.nc").rename(folder / "input.gsd")
    (folder / "run.nc.partial").write_bytes((folder / "input.gsd").read_bytes())
    before = contents(folder)
    for force in ([], ["--force"]):
        refused(capsys, "collisions", "scene.yaml", "--count", "20", "-o", "scene.yaml", *force)
        refused(capsys, "collisions", "scene.yaml", "--count", "20", "-o", "input.gsd", *force)
        refused(capsys, "export", "input.gsd", "-o", "input.gsd", *force)
        refused(capsys, *OUTPUTS["again.nc"], "-o", "scene.yaml", *force)
    assert main(["collisions", "scene.yaml", "--count", "20", "-o", "run.nc"]) == 0
    (folder / "run.nc").unlink()
    assert contents(folder) == before


@pytest.mark.parametrize("output", OUTPUTS)
def test_what_names_no_regular_file_is_refused(folder, capsys, output):
    suffix = Path(output).suffix
    (folder / f"folder{suffix}").mkdir()
    os.mkfifo(folder / f"pipe{suffix}")
    (folder / f"link{suffix}").symlink_to("scene.yaml")
    (folder / f"dangling{suffix}").symlink_to("nothing")
    (folder / f"null{suffix}").symlink_to("/dev/null")
    wrong = [
        f"{name}{suffix}" for name in ("folder", "pipe", "link", "dangling", "null", "a/b", "scene.yaml/b")
    ]
    for name in (*wrong, f"new{suffix}/", "", ".", "..", "/", "/dev/null", "x" * 300 + suffix):
        line = refused(capsys, *OUTPUTS[output], "--force", "-o", name)
        assert "must " in line or "cannot be written" in line
    left = {path.name for path in folder.iterdir()}
    assert left == {"scene.yaml", "run.nc", *wrong[:5]}
    assert (folder / "scene.yaml").read_text() == GAS
    assert stat.S_ISCHR(os.stat("/dev/null").st_mode)


def test_the_interface_of_python_replaces_with_overwrite_only(folder):
    for write, name in ((gp.export, "a.data"), (gp.film, "a.gif")):
        for overwrite in (False, True):
            write("run.nc", name, overwrite=overwrite)
            with pytest.raises(gp.SceneError, match="exists; move it away, or overwrite it"):
                write("run.nc", name)


@pytest.mark.parametrize("supported", [True, False], ids=["renameat2", "without renameat2"])
def test_a_file_that_appears_meanwhile_is_kept(tmp_path, monkeypatch, supported):
    if not supported:
        monkeypatch.setattr("ctypes.CDLL", lambda *_, **__: SimpleNamespace())
    path = tmp_path / "result"
    for theirs in ("ours, too", "theirs"):
        with pytest.raises(gp.SceneError, match="exists"), writing(path, TEXT) as scratch:
            scratch.write_text("ours")
            path.write_text(theirs)
        assert contents(tmp_path) == {"result": theirs.encode()}
        path.unlink()
    with writing(path, TEXT, overwrite=True) as scratch:
        scratch.write_text("ours, new")
        path.write_text("ours, old")
    assert contents(tmp_path) == {"result": b"ours, new"}
    path.unlink()
    with writing(path, TEXT) as scratch:
        scratch.write_text("ours")
    assert contents(tmp_path) == {"result": b"ours"}


def test_a_file_that_appears_between_the_last_check_and_the_renaming_is_kept(tmp_path, monkeypatch):
    path, rename = tmp_path / "result", files.rename_to_new

    def late(old, new):
        if not path.exists():
            path.write_text("theirs")
        rename(old, new)

    monkeypatch.setattr(files, "rename_to_new", late)
    with pytest.raises(gp.SceneError, match="exists"), writing(path) as scratch:
        scratch.write_text("ours")
    assert contents(tmp_path) == {"result": b"theirs"}


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt, SystemExit])
def test_a_failure_leaves_nothing(tmp_path, error):
    with pytest.raises(error), writing(tmp_path / "result") as scratch:
        scratch.write_text("half")
        raise error
    assert not contents(tmp_path)


def test_what_a_kill_leaves_goes_with_the_next_attempt(tmp_path):
    code = """
        import os, signal, sys
        from gaspart.files import writing
        with writing(sys.argv[1]) as scratch:
            scratch.write_text("half")
            os.kill(os.getpid(), signal.SIGKILL)
    """
    path = tmp_path / "result"
    with writing(path) as living:
        subprocess.run([sys.executable, "-c", textwrap.dedent(code), path], env=environment())
        assert len(contents(tmp_path)) == 2
        with writing(tmp_path / "other") as scratch:
            scratch.write_text("of another name")
        assert len(contents(tmp_path)) == 3
        with writing(path) as scratch:
            scratch.write_text("first")
        assert contents(tmp_path).keys() == {"result", "other", living.name}
        living.write_text("second")
        path.unlink()
    assert contents(tmp_path) == {"result": b"second", "other": b"of another name"}


def environment():
    return {
        **{key: value for key, value in os.environ.items() if not key.startswith("COVERAGE")},
        "PYTHONPATH": os.pathsep.join(sys.path),
    }


COMMANDS = """
    import json, resource, signal, sys
    from gaspart.cli import main

    limit, *commands = json.loads(sys.argv[1])
    if limit:
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    for command in commands:
        print(main(command))
"""


def in_a_process(commands, folder, limit=None, within=()):
    """Exit codes and stderr of commands, which must not write files of more than `limit` bytes."""
    import json

    code = [*within, sys.executable, "-c", textwrap.dedent(COMMANDS), json.dumps([limit, *commands])]
    done = subprocess.run(code, capture_output=True, text=True, cwd=folder, env=environment(), timeout=300)
    assert done.returncode == 0, done.stderr
    codes = [line for line in done.stdout.splitlines() if line in ("0", "1", "2")]
    return list(map(int, codes)), done.stderr.splitlines()


@pytest.mark.parametrize("limit", [10, 600])
def test_a_full_disk_costs_one_line_and_leaves_nothing(folder, limit):
    """A limit on the file's size fails a write where a full disk would."""
    commands = [[*command, "-o", name] for name, command in OUTPUTS.items() if name != "again.nc"]
    main([*OUTPUTS["met.nc"], "-o", "met.nc"])  # the kernels are in the cache now
    (folder / "met.nc").unlink()
    before = contents(folder)
    codes, lines = in_a_process(commands, folder, limit)
    assert codes == [2] * len(commands)
    assert len(lines) == len(commands)
    reasons = ["File too large" if ".mp4" not in line else "its writer has" for line in lines]
    assert all(f"cannot be written: {why}" in line for why, line in zip(reasons, lines, strict=True)), lines
    assert contents(folder) == before


@pytest.mark.skipif(why_not(WITHOUT_RIGHTS) is not None, reason=str(why_not(WITHOUT_RIGHTS)))
def test_a_folder_that_cannot_be_written_to_costs_one_line(folder):
    main([*OUTPUTS["met.nc"], "-o", "met.nc"])
    (folder / "met.nc").unlink()
    before = contents(folder)
    commands = [[*command, "-o", name] for name, command in OUTPUTS.items()]
    folder.chmod(0o555)
    try:
        codes, lines = in_a_process(commands, folder, within=WITHOUT_RIGHTS)
    finally:
        folder.chmod(0o755)
    assert codes == [2] * len(commands)
    lines = [line for line in lines if line.startswith("gaspart: error: ")]
    assert len(lines) == len(commands)
    assert all("Permission denied" in line or "can be written to" in line for line in lines), lines
    assert contents(folder) == before


@pytest.mark.parametrize("output", [name for name in OUTPUTS if name != "again.nc"])
def test_results_in_a_folder_that_is_not_utf_8_are_recognised(folder, output):
    (folder / "\udcff").mkdir()
    for force in ([], ["--force"]):
        assert main([*OUTPUTS[output], "-o", f"\udcff/{output}", *force]) == 0


def test_a_run_that_another_process_finished_meanwhile_is_not_replaced(folder, monkeypatch, scene):
    """Another run begins and ends during a slow set-up: of another seed, and of the same."""
    path, slow = folder / "late.nc", trajectory.Simulation

    def during(*arguments, **options):
        monkeypatch.setattr(trajectory, "Simulation", slow)
        gp.run(scene, gp.EventDriven(), 1, 1.0, 0.5, path)
        return slow(*arguments, **options)

    for seed in (1, 2):
        monkeypatch.setattr(trajectory, "Simulation", during)
        if seed == 1:
            gp.run(scene, gp.EventDriven(), seed, 1.0, 0.5, path)
        else:
            with pytest.raises(gp.SceneError, match=r"late\.nc.*of another run"):
                gp.run(scene, gp.EventDriven(), seed, 1.0, 0.5, path)
        assert path.read_bytes() == (folder / "run.nc").read_bytes()
        assert contents(folder).keys() == {"scene.yaml", "run.nc", "late.nc"}
        path.unlink()


def test_a_run_does_not_replace_a_data_set_of_collisions(folder, scene):
    """Both are NetCDF files and name gaspart."""
    path = folder / "met.nc"
    record_collisions(scene, path, 3)
    before = path.read_bytes()
    with pytest.raises(gp.SceneError, match="exists and is not a trajectory"):
        gp.run(scene, gp.EventDriven(), 1, 1.0, 0.5, path, overwrite=True)
    assert path.read_bytes() == before
    path.unlink()


def test_a_result_that_appears_during_a_run_is_kept(folder, monkeypatch, scene):
    path, place = folder / "late.nc", trajectory.place

    def late(*arguments):
        path.write_text("theirs")
        place(*arguments)

    monkeypatch.setattr(trajectory, "place", late)
    with pytest.raises(gp.SceneError, match="exists and is not a trajectory"):
        gp.run(scene, gp.EventDriven(), 1, 1.0, 0.5, path)
    assert path.read_text() == "theirs"
    path.unlink()
    monkeypatch.setattr(trajectory, "place", place)
    assert gp.resume(path).read_bytes() == (folder / "run.nc").read_bytes()


def test_a_path_belongs_to_one_process_and_its_lock_is_removed(tmp_path):
    path, lock = tmp_path / "run.nc.partial", tmp_path / "run.nc.partial.lock"
    with files.only_process(path):
        assert lock.exists()
        with pytest.raises(BlockingIOError), files.only_process(path):
            pass
        assert lock.exists()
    assert not lock.exists()


def test_a_lock_that_its_holder_removed_is_taken_anew(tmp_path, monkeypatch):
    lock, flock = tmp_path / "run.nc.lock", files.fcntl.flock
    descriptors = []

    def locked_too_late(descriptor, flags):
        if not descriptors:
            lock.unlink()
        descriptors.append(descriptor)
        flock(descriptor, flags)

    monkeypatch.setattr(files.fcntl, "flock", locked_too_late)
    with files.only_process(tmp_path / "run.nc"):
        assert len(descriptors) == 2 and lock.samefile(f"/proc/self/fd/{descriptors[1]}")


@pytest.mark.parametrize("code", [errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP])
def test_without_locks_a_run_is_written_with_a_warning(tmp_path, monkeypatch, code):
    def refuse(descriptor, flags):
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(files.fcntl, "flock", refuse)
    before = len(os.listdir("/proc/self/fd"))
    with (
        pytest.warns(UserWarning, match=r"^gaspart: .*run.nc: cannot be locked"),
        files.only_process(tmp_path / "run.nc"),
    ):
        (tmp_path / "run.nc").touch()
    assert os.listdir(tmp_path) == ["run.nc"] and len(os.listdir("/proc/self/fd")) == before


def test_a_file_that_is_no_lock_is_kept(tmp_path):
    lock = tmp_path / "run.nc.lock"
    lock.write_text("my notes")
    with pytest.raises(files.SceneError, match="is not a lock"), files.only_process(tmp_path / "run.nc"):
        pass
    assert lock.read_text() == "my notes"
