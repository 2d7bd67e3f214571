"""Files and links with the names of scratch files: what gaspart did not write is neither changed nor lost."""

import os
import shutil
import socket

import pytest
from scenes import gas

import gaspart as gp
from gaspart.cli import main
from gaspart.errors import SceneError, SimulationError
from gaspart.files import writing
from gaspart.reproduction.jobs.replicas import write_replicas
from gaspart.simulation import Simulation
from gaspart.trajectory.opening import checkpoint_path, partial_path

SCENE = gas(2, 10, 0.1)
RECIPE = (SCENE, gp.EventDriven(), 1, 2.0, 0.5)
OFTEN = {"checkpoint_seconds": 0.0}
SCRATCH = ["run.nc.partial", "run.nc.checkpoint.npz"]
NOTES = b"notes of the user\n"


def state(folder):
    """What is in a folder: contents of files and targets of links."""
    return {
        path.name: os.readlink(path) if path.is_symlink() else path.read_bytes() if path.is_file() else None
        for path in folder.iterdir()
    }


@pytest.fixture(scope="module")
def complete(tmp_path_factory):
    """The bytes of the run and of the checkpoint of its end."""
    path = gp.run(*RECIPE, tmp_path_factory.mktemp("complete") / "run.nc", keep_checkpoint=True)
    return path.read_bytes(), checkpoint_path(path).read_bytes()


def strange(kind, path, complete):
    """Put something at `path` that gaspart did not write."""
    target = path.with_name("target")
    match kind:
        case "notes":
            path.write_bytes(NOTES)
        case "zeros":
            path.write_bytes(bytes(5000))
        case "sparse":
            with path.open("wb") as file:
                file.truncate(1 << 34)
        case "zip":
            path.write_bytes(b"PK\x03\x04" + NOTES * 100)
        case "link":
            target.write_bytes(NOTES)
            path.symlink_to(target)
        case "own link":  # to a file that gaspart wrote, which is the user's copy
            target.write_bytes(complete[path.suffix == ".npz"])
            path.symlink_to(target)
        case "dangling":
            path.symlink_to(target)
        case "pipe":
            os.mkfifo(path)
        case "socket":
            with socket.socket(socket.AF_UNIX) as made:
                made.bind(os.path.relpath(path))
        case "folder":
            path.mkdir()
            (path / "inner").write_bytes(NOTES)
        case "device":
            path.symlink_to("/dev/null")


STRANGE = ["notes", "zeros", "zip", "link", "own link", "dangling", "pipe", "socket", "folder", "device"]


@pytest.mark.parametrize("kind", STRANGE)
@pytest.mark.parametrize("name", SCRATCH)
def test_a_run_refuses_what_it_did_not_write(tmp_path, monkeypatch, capsys, complete, kind, name):
    monkeypatch.chdir(tmp_path)
    SCENE.to_file(tmp_path / "scene.yaml")
    strange(kind, tmp_path / name, complete)
    before = state(tmp_path)
    options = ["--duration", "2", "--sample-interval", "0.5", "--seed", "1", "--checkpoint-seconds", "0"]
    for force in ([], ["--force"]):
        assert main(["run", "scene.yaml", "-o", "run.nc", *options, *force]) == 2
        assert capsys.readouterr().err.count("\n") == 1
        assert state(tmp_path) == before


@pytest.mark.parametrize("kind", STRANGE)
def test_a_file_that_appears_during_a_run_is_kept(tmp_path, monkeypatch, complete, kind):
    """As the scratch name of the checkpoint that older versions had, and as the checkpoint itself."""
    monkeypatch.chdir(tmp_path)
    strange(kind, tmp_path / "run.nc.checkpoint.npz.new", complete)
    before = state(tmp_path)
    assert gp.run(*RECIPE, "run.nc", **OFTEN).read_bytes() == complete[0]
    assert state(tmp_path) == before | {"run.nc": complete[0]}
    shutil.move("run.nc.checkpoint.npz.new", "aside")
    (tmp_path / "run.nc").unlink()

    def appears(*_):
        if not os.path.lexists("run.nc.checkpoint.npz"):
            shutil.move("aside", "run.nc.checkpoint.npz")

    advance = Simulation.advance
    monkeypatch.setattr(Simulation, "advance", lambda *given, **more: (appears(), advance(*given, **more)))
    with pytest.raises(SceneError):
        gp.run(*RECIPE, "run.nc", **OFTEN)
    after = state(tmp_path)
    assert after["run.nc.checkpoint.npz"] == before["run.nc.checkpoint.npz.new"]
    assert after.get("target") == before.get("target")


def test_a_complete_run_leaves_a_file_with_the_name_of_its_checkpoint(tmp_path, complete):
    path = gp.run(*RECIPE, tmp_path / "run.nc")
    checkpoint_path(path).write_bytes(NOTES)
    assert gp.run(*RECIPE, path).read_bytes() == complete[0]
    assert checkpoint_path(path).read_bytes() == NOTES


def test_a_failed_run_replaces_no_file_of_another_kind(tmp_path, monkeypatch):
    failed = tmp_path / "run.nc.failed.npz"
    failed.write_bytes(NOTES)

    def breaks(*_):
        raise SimulationError("an invariant")

    monkeypatch.setattr(Simulation, "check_invariants", breaks)
    with pytest.raises(SimulationError, match=r"its state is not kept: .*failed\.npz exists and is not"):
        gp.run(*RECIPE, tmp_path / "run.nc")
    assert failed.read_bytes() == NOTES


def test_a_partial_file_with_a_second_name_is_not_written_to(tmp_path, complete):
    path, copy = tmp_path / "run.nc", tmp_path / "copy"
    copy.write_bytes(complete[0])
    os.link(copy, partial_path(path))
    for overwrite in (False, True):
        with pytest.raises(SceneError, match="second name"):
            gp.run(*RECIPE, path, overwrite=overwrite)
    with pytest.raises(SceneError, match="second name"):
        gp.resume(path)
    assert copy.read_bytes() == complete[0]


def test_a_checkpoint_with_a_second_name_keeps_that_one(tmp_path, complete):
    path, copy = tmp_path / "run.nc", tmp_path / "copy"
    copy.write_bytes(complete[1])
    os.link(copy, checkpoint_path(path))
    assert gp.run(*RECIPE, path, **OFTEN).read_bytes() == complete[0]
    assert state(tmp_path) == {"run.nc": complete[0], "copy": complete[1]}


def test_what_only_looks_like_a_scratch_file_is_not_removed(tmp_path):
    """Links, files with a second name, and names that differ from those of gaspart."""
    with writing(tmp_path / "result") as scratch:
        begun, _, random = scratch.name.rsplit("-", 2)
    dead = 2**22 + 1  # above the largest number of a process
    target = tmp_path / "target"
    target.write_bytes(NOTES)
    names = [f"{begun}-{dead}-{random}", f"{begun}-{dead}-12345678.partial", f"{begun}-{dead}-mine.partial"]
    (tmp_path / names[0]).symlink_to(target)
    os.link(target, tmp_path / names[1])
    (tmp_path / names[2]).write_bytes(NOTES)
    left = tmp_path / f"{begun}-{dead}-abcdef01.partial"
    left.write_bytes(b"half a result")
    before = state(tmp_path)
    with writing(tmp_path / "result", overwrite=True) as scratch:
        scratch.write_bytes(b"new")
    before.pop(left.name)
    assert state(tmp_path) == before | {"result": b"new"}


def test_the_folder_of_replicas_keeps_what_is_not_of_gaspart(tmp_path, complete):
    def record(recipe, path, overwrite):
        path.write_bytes(complete[0])

    partial, folder = tmp_path / "point.partial", tmp_path / "point"
    for kind in (*STRANGE[:2], *STRANGE[3:7], "folder"):
        partial.mkdir()
        strange(kind, partial / "notes.txt", complete)
        before = state(partial)
        with pytest.raises(SceneError):
            write_replicas(record, [None], folder)
        assert state(partial) == before and not folder.exists()
        shutil.rmtree(partial)
    (tmp_path / "elsewhere").mkdir()
    for target in ("elsewhere", "nowhere"):
        partial.symlink_to(tmp_path / target)
        with pytest.raises(SceneError):
            write_replicas(record, [None], folder)
        partial.unlink()
    assert state(tmp_path) == {"elsewhere": None}
    partial.mkdir()
    (partial / "replica-1.nc").write_bytes(complete[0])
    (partial / "replica-2.nc.partial").write_bytes(complete[0])
    (partial / "replica-2.nc.checkpoint.npz").write_bytes(complete[1])
    write_replicas(record, [None], folder)
    assert state(folder) == {"replica-0.nc": complete[0]} and not partial.exists()


SPELLINGS = ["run.nc", "./run.nc", "inner/../run.nc", "linked/run.nc", "link.nc", "hard.nc"]


@pytest.mark.parametrize("source", SPELLINGS)
@pytest.mark.parametrize("output", SPELLINGS[:4])
@pytest.mark.parametrize("force", [[], ["--force"]], ids=["", "force"])
def test_a_run_does_not_replace_the_one_it_starts_from(
    tmp_path, monkeypatch, capsys, complete, source, output, force
):
    monkeypatch.chdir(tmp_path)
    SCENE.to_file(tmp_path / "scene.yaml")
    (tmp_path / "run.nc").write_bytes(complete[0])
    (tmp_path / "run.nc.checkpoint.npz").write_bytes(complete[1])
    (tmp_path / "inner").mkdir()
    (tmp_path / "linked").symlink_to(tmp_path)
    (tmp_path / "link.nc").symlink_to("run.nc")
    os.link("run.nc", "hard.nc")
    before = state(tmp_path)
    command = f"run scene.yaml --from {source} -o {output} --duration 2 --sample-interval 1".split()
    assert main([*command, *force]) == 2
    line = capsys.readouterr().err
    assert "is the file that is to be written" in line and line.count("\n") == 1
    assert state(tmp_path) == before


def test_a_run_does_not_replace_the_unfinished_one_it_starts_from(tmp_path, complete):
    path = tmp_path / "run.nc"
    partial_path(path).write_bytes(complete[0])
    with pytest.raises(SceneError, match="is the file that is to be written"):
        gp.run(*RECIPE, path, initial=partial_path(path), overwrite=True)
    assert partial_path(path).read_bytes() == complete[0]


def damage(content):
    """A checkpoint with one bit changed, cut short at either end, of zeros, and of another kind."""
    middle = len(content) // 2
    changed = bytearray(content)
    changed[middle] ^= 1
    return [bytes(changed), content[:middle], content[1:], bytes(len(content)), NOTES, b"", content + b"\0"]


def test_a_damaged_checkpoint_is_named(tmp_path, complete):
    """Neither the rounded last frame nor the start stands for it without a word."""
    path = tmp_path / "run.nc"
    path.write_bytes(complete[0])
    other = gp.run(SCENE, gp.EventDriven(), 2, 2.0, 0.5, tmp_path / "other.nc", keep_checkpoint=True)
    for content in (*damage(complete[1]), checkpoint_path(other).read_bytes()):
        checkpoint_path(path).write_bytes(content)
        for use in (
            lambda: gp.last_state(path),
            lambda: gp.run(*RECIPE, tmp_path / "new.nc", initial=path),
            lambda: gp.resume(path, duration=3.0),
        ):
            with pytest.raises(SceneError, match=r"run\.nc\.checkpoint\.npz.*move it away"):
                use()
        assert checkpoint_path(path).read_bytes() == content and not (tmp_path / "new.nc").exists()
    checkpoint_path(path).unlink()
    os.mkfifo(checkpoint_path(path))
    with pytest.raises(SceneError, match="it is a pipe, not a regular file"):
        gp.last_state(path)
    checkpoint_path(path).unlink()
    assert gp.last_state(path).time == 2.0
