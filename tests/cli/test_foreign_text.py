"""Text and names that come from files: shown as text in every command, whatever a terminal makes of them."""

import io
import os
import re
import shutil

import netCDF4
import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart.cli import main
from gaspart.errors import SceneError, SimulationError, visible
from gaspart.interruption import describe_interruption, set_note
from gaspart.trajectory.opening import checkpoint_path

NASTY = [
    "\x1b[2J\x1b[H",
    "\x1b]0;title\x07",
    "\x9b2J",
    "\r",
    "\n",
    "\x0b",
    "\x0c",
    "\x08" * 20,
    "\x7f",
    "\x00",
]
NASTY += ["\u202e", "\u2066", "\u200f", "\u061c", "\u2028", "\u2029", "\x85", "\ufeff", "\u200b", "\udc9b"]
NASTY += ["\U000e0041", "\x00"]
FAKE = "".join(NASTY) + "\nok    overlaps: none\x1b[1A\x1b[8m"
SCENE = gas(2, 10, 0.1)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs")
    gp.run(SCENE, gp.EventDriven(), 1, 2.0, 0.5, folder / "run.nc")
    return folder


def printed(capsys, *words):
    """The exit code of a command, and what it prints, which nothing in it controls."""
    code = main([str(word) for word in words])
    said = capsys.readouterr()
    for line in (said.out + said.err).split("\n"):
        assert line.isprintable(), line
    assert "Traceback" not in said.err and said.err.count("\n") <= 1
    assert not re.search(r"^ok    overlaps: none", said.out, re.MULTILINE)
    return code, said.out, said.err


def test_visible_text_is_one_line_and_keeps_what_can_be_read():
    assert all(visible(text).isprintable() and visible(text).isascii() for text in NASTY)
    assert visible("η = 0.3, 日本語, a\tb\n\x1b[1m") == r"η = 0.3, 日本語, a\tb\n\x1b[1m"
    assert visible("a\udcff\udce9\udc9b", names=True) == "a\udcff\udce9\\udc9b"
    assert visible("abcdefghijkl" * 100, 20) == "abcdefghijkl...hijkl"
    assert len(visible("\x1b" * 100, 20)) <= 20 * len("\\x1b")


@pytest.mark.parametrize(
    "command", [["info"], ["info", "--scene"], ["check"], ["measure", "Z"], ["render"], ["export"]]
)
def test_attributes_of_a_forged_trajectory(runs, tmp_path, capsys, command):
    """A stranger can make the checksum of a header right."""
    for name in ("title", "scene", "engine", "program", "gaspart_version", "git_revision", "seed", "note"):
        path = shutil.copy(runs / "run.nc", tmp_path / "forged.nc")
        forge(path, name)
        words = [command[0], path, *command[1:]]
        outputs = {"render": "a.png", "export": "a.data"}
        if command[0] in outputs:
            words += ["-o", tmp_path / outputs[command[0]], "--force"]
        code, _, error = printed(capsys, *words)
        assert "checksum does not match" not in error
        assert code in (0, 2)


def forge(path, name):
    """Add FAKE to an attribute of a trajectory, with checksums that agree."""
    from gaspart.trajectory import recipe

    wanted = recipe.read_recipe(path)
    layout = wanted.layout
    attributes = {}
    with netCDF4.Dataset(path) as file:
        attributes = {key: file.getncattr(key) for key in file.ncattrs()}
        particles = {key: file[key][:].data for key in ("radius", "mass", "type")}
    for key in ("header_bytes", "header_crc32", "frame_bytes"):
        del attributes[key]
    old = str(attributes.get(name, ""))
    attributes[name] = old + FAKE.replace("\0", "").encode("utf-8", "replace").decode()
    header = layout.header(attributes, particles)
    from gaspart.trajectory.amber import Frames, frames_of
    from gaspart.trajectory.opening import open_verified

    with open_verified(path) as (source, before, count):
        parts = list(frames_of(source, before, count))
    with open(path, "r+b", buffering=0) as file:
        made = Frames(file, layout, header)
        for part in parts:
            made.append_bytes(part)


@pytest.mark.parametrize("text", [*NASTY, FAKE])
def test_scenes_and_configs_with_such_text(tmp_path, capsys, text):
    text = text.encode("utf-8", "replace").decode()
    quoted = '"' + "".join(f"\\U{ord(c):08x}" for c in text) + '"'
    path = tmp_path / "scene.yaml"
    for content in (
        f"container: {{lengths: [8, 8], boundary: {quoted}}}\n",
        f"{quoted}: 1\n",
        f"container: {text}: [\n",
        f"container: {{lengths: [8, 8]}}\nspecies: [{{count: 1, radius: 0.5, {quoted}: 1}}]\n",
        f"experiments: {{{quoted}: {{point: {{}}}}}}\nfigures: {{}}\n",
        f"title: {quoted}\nexperiments: {{}}\nfigures: {{mine: {{kind: {quoted}}}}}\n",
        f"- !{text}\n",
        f"a: *{text}\n",
    ):
        path.write_text(content, encoding="utf-8")
        for words in (["check", path], ["run", path, "-o", tmp_path / "new.nc", "--duration", "1"]):
            assert printed(capsys, *words)[0] == 2
        assert printed(capsys, "advise", path)[0] == 2


def test_comments_of_xyz_files(tmp_path, capsys):
    text = FAKE.replace("\n", "").encode("utf-8", "replace").decode()
    path = tmp_path / "a.xyz"
    for comment in (
        text,
        f'Properties="{text}"',
        f'Lattice="{text}"',
        f'pbc="{text}" Lattice="5 5 5"',
        f"Time={text}",
    ):
        path.write_text(f"2\n{comment}\nA 1 1 1\n{text} 3 3 3\n", encoding="utf-8")
        assert printed(capsys, "check", path, "--radius", "0.5")[0] in (1, 2)
    path.write_text(f"{text}\n{text}\n")
    assert printed(capsys, "check", path, "--radius", "0.5", "--lengths", "5,5,5")[0] == 2


def test_attributes_of_netcdf_files_of_others(tmp_path, capsys):
    path = tmp_path / "a.nc"
    for name in ("Conventions", "ConventionVersion", "program", "title"):
        with netCDF4.Dataset(path, "w", format="NETCDF3_64BIT_OFFSET") as file:
            file.Conventions, file.ConventionVersion = "AMBER", "1.0"
            file.setncattr(name, FAKE.replace("\0", "").encode("utf-8", "replace").decode())
            file.createDimension("frame", None)
            file.createDimension("spatial", 3)
            file.createDimension("atom", 2)
            places = file.createVariable("coordinates", "f4", ("frame", "atom", "spatial"))
            places[0] = np.arange(6).reshape(2, 3)
            places.units = "angstrom\x1b[2J"
        printed(capsys, "check", path, "--radius", "0.1", "--lengths", "9,9,9")
        assert printed(capsys, "info", path)[0] == 2


def test_types_of_gsd_files(tmp_path, capsys):
    hoomd = pytest.importorskip("gsd.hoomd")
    frame = hoomd.Frame()
    frame.particles.N, frame.particles.position = 2, [[0, 0, 0], [2, 0, 0]]
    frame.particles.types, frame.configuration.box = ["\x1b[2J\nok    x"], [9, 9, 9, 0, 0, 0]
    frame.particles.type_shapes = [{"type": "\x1b[2Jok", "diameter": 1.0}]
    with hoomd.open(tmp_path / "a.gsd", "w") as file:
        file.append(frame)
    assert printed(capsys, "check", tmp_path / "a.gsd")[0] == 2


@pytest.mark.parametrize("text", [one for one in NASTY if one not in ("\0", "\r", "\n")] + ["\n", "\r"])
def test_names_of_files(runs, tmp_path, monkeypatch, capsys, text):
    """Outputs too, and folders."""
    monkeypatch.chdir(tmp_path)
    name = os.fsdecode(os.fsencode(text.encode("utf-8", "surrogateescape")))
    folder = tmp_path / f"in{name}"
    folder.mkdir()
    trajectory = shutil.copy(runs / "run.nc", folder / f"{name}.nc")
    SCENE.to_file(folder / f"{name}.yaml")
    for words in (
        ["info", trajectory],
        ["check", trajectory],
        ["check", folder / f"{name}.yaml"],
        ["check", folder / f"{name}.gsd"],
        ["measure", trajectory, "Z", "-o", folder / f"{name}.csv"],
        ["render", trajectory, "-o", folder / f"{name}.png", "--size", "64x48"],
        ["export", trajectory, "-o", folder / f"{name}.data"],
        ["verify", folder],
        ["archive", folder, "-o", folder / f"{name}.zip"],
        ["resume", trajectory],
        ["run", folder / f"{name}.yaml", "-o", trajectory, "--duration", "1", "--sample-interval", "0.5"],
        ["new", folder / f"{name}.yaml"],
        ["view", folder / f"{name}.nc", "-o", folder / f"{name}.txt"],
        ["info", trajectory, f"--{name}"],
        ["nothing", name],
        [name],
    ):
        printed(capsys, *words)


@pytest.mark.interpreted
def test_a_failure_and_an_interruption_name_files_as_text(tmp_path, monkeypatch):
    set_note("`gaspart resume \x1b[2J` continues it")
    assert describe_interruption().isprintable()
    set_note("")

    def breaks(*_):
        raise SimulationError("an invariant")

    monkeypatch.setattr(gp.Simulation, "check_invariants", breaks)
    monkeypatch.setattr("sys.stderr", said := io.StringIO())
    SCENE.to_file(tmp_path / "scene.yaml")
    path = tmp_path / "\x1b[2J.nc"
    command = ["run", str(tmp_path / "scene.yaml"), "-o", str(path), "--duration", "1"]
    command += ["--sample-interval", "0.5"]
    assert main([*command, "--quiet"]) == 1
    assert said.getvalue()[:-1].isprintable()
    assert not checkpoint_path(path).exists()


def test_python_shows_an_error_as_text():
    with pytest.raises(SceneError) as error:
        gp.open_trajectory("\x1b[2J.nc")
    assert str(error.value).isprintable()
