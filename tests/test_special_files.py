"""Pipes, folders, sockets, devices and links wherever a file is expected: one line, at once."""

import os
import shutil
import signal
import socket
from contextlib import contextmanager
from itertools import product

import pytest
from malformed import within
from scenes import gas

import gaspart as gp
from gaspart.cli import main
from gaspart.errors import SceneError
from gaspart.files import is_same_file, open_regular
from gaspart.reproduction.archive.metadata import read_citation
from gaspart.reproduction.config import open_config
from gaspart.yaml_text import write_yaml

SCENE = gas(2, 10, 0.1)
KINDS = ["pipe", "folder", "socket", "zero", "null", "dangling", "loop", "below a file", "linked pipe"]
LENGTH = ["--duration", "1", "--sample-interval", "0.5"]
COMMANDS = [
    ["run", "X.yaml", "-o", "new.nc", *LENGTH],
    ["run", "scene.yaml", "-o", "new.nc", "--from", "X.nc", *LENGTH],
    ["resume", "X.nc"],
    ["resume", "X.nc", "--duration", "9"],
    ["info", "X.nc"],
    ["measure", "X.nc", "Z"],
    ["measure", "run.nc", "X.nc", "Z"],
    ["render", "X.nc", "-o", "new.png"],
    ["render", "X.nc", "-o", "new.gif"],
    ["view", "X.nc", "-o", "new.html"],
    ["export", "X.nc", "-o", "new.data"],
    ["collisions", "X.yaml", "-o", "new.nc", "--count", "5"],
    ["advise", "X.yaml"],
    ["advise", "--config", "X.yaml"],
    *(["check", f"X{suffix}"] for suffix in (".yaml", ".yml", ".nc", ".partial", ".gsd", ".xyz", ".extxyz")),
    ["verify", "X.zip"],
    ["archive", "X", "-o", "new.zip"],
    ["archive", "results", "-o", "new.zip", "--config", "X.yaml"],
]


def special(kind, path):
    """Make what is no file."""
    match kind:
        case "pipe":
            os.mkfifo(path)
        case "linked pipe":
            os.mkfifo("pipe")
            path.symlink_to("pipe")
        case "folder":
            path.mkdir()
        case "socket":
            with socket.socket(socket.AF_UNIX) as made:
                made.bind(path.name)
        case "zero":
            path.symlink_to("/dev/zero")
        case "null":
            path.symlink_to("/dev/null")
        case "dangling":
            path.symlink_to("nothing")
        case "loop":
            path.symlink_to(path)
        case "below a file":
            return f"scene.yaml/{path.name}"
    return path.name


@contextmanager
def at_once():
    """Fail where something waits for ever, and where it takes processor time."""

    def fail(*_):
        raise AssertionError("it waits")

    before = signal.signal(signal.SIGALRM, fail)
    signal.alarm(30)
    try:
        with within(5.0):
            yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    SCENE.to_file(tmp_path / "scene.yaml")
    return tmp_path


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return gp.run(SCENE, gp.EventDriven(), 1, 1.0, 0.5, tmp_path_factory.mktemp("run") / "run.nc")


def pairs():
    """Each command with each kind of file; `make test` has each command once and each kind twice or more."""
    return [
        pytest.param(
            command,
            kind,
            id=f"{' '.join(command)}-{kind}",
            marks=() if n % len(KINDS) == m else pytest.mark.thorough,
        )
        for (n, command), (m, kind) in product(enumerate(COMMANDS), enumerate(KINDS))
    ]


@pytest.mark.parametrize(("command", "kind"), pairs())
def test_as_an_input_of_a_command(folder, run, capsys, command, kind):
    shutil.copy(run, folder)
    (folder / "results/tables").mkdir(parents=True)
    (folder / "results/tables/claims.csv").touch()
    (folder / "Snakefile").touch()
    given = next(word for word in command if word.startswith("X"))
    name = special(kind, folder / given)
    before = sorted(folder.rglob("*"))
    with at_once():
        assert main([name if word == given else word for word in command]) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.count("\n") == 1 and "Traceback" not in said.err, said
    assert sorted(folder.rglob("*")) == before


@pytest.mark.parametrize("suffix", [".yaml", ".nc", ".partial", ".gsd", ".xyz"])
def test_a_file_that_is_larger_than_any_memory(folder, capsys, suffix):
    """A sparse one, of 4 TB."""
    path = folder / f"X{suffix}"
    with path.open("wb") as file:
        file.truncate(1 << 42)
    with at_once():
        assert main(["check", str(path)]) == 2
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize("kind", KINDS[:-2])
def test_as_a_file_that_another_one_names(folder, kind):
    """A scene of a config, the citation of an archive."""
    name = special(kind, folder / "X.yaml")
    point = {"scene": name, "duration": 1.0}
    config = {
        "title": "t",
        "seed": 1,
        "points": "points",
        "experiments": {"gas": {"point": point}},
        "figures": {},
    }
    write_yaml(folder / "config.yaml", config)
    with at_once(), pytest.raises(SceneError), open_config(folder / "config.yaml"):
        pass
    with at_once(), pytest.raises(SceneError):
        read_citation(folder / name)


@pytest.mark.parametrize("kind", KINDS)
def test_the_one_function_that_opens_input(folder, kind):
    name = special(kind, folder / "X")
    with at_once(), pytest.raises(OSError):
        open_regular(name)
    link = folder / "link"
    link.symlink_to("scene.yaml")
    with open_regular(link) as file:
        assert file.read(9) == b"container"
    with pytest.raises(OSError, match="a link, not a regular file"):
        open_regular(link, follow=False)
    assert is_same_file(link, "scene.yaml") and not is_same_file(name, "scene.yaml")
