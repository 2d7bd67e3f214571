"""Command lines at random: whatever the options are, one line, a known exit code, and no file that was there
changes."""

import io
import os
import shutil
from contextlib import redirect_stderr, redirect_stdout
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from malformed import within

from gaspart.cli import main

GAS = (
    "container: {lengths: [9.0, 9.0], boundary: periodic}\nspecies: [{count: 12, radius: 0.5, speed: 1.0}]\n"
)
BALLS = GAS.replace("[9.0, 9.0]", "[6.0, 6.0, 6.0]").replace("12", "8")
CONFIG = """\
title: a small config
seed: 1
points: results/points
figures:
  radius_grid: {experiments: [gas]}
experiments:
  gas:
    point:
      {dimension: 3, count: 64, packing_fraction: 0.1, radius: 0.5, boundary: periodic, temperature: 1.0,
       engine: auto, accuracy: 0.01, collisions_per_particle: 10, equilibration: 2, samples: 4, replicas: 2}
  steps:
    point:
      {dimension: 2, count: 50, packing_fraction: 0.1, radius: 0.5, boundary: wall, speed: 1.0,
       engine: step, time_step: 0.01, steps: 100, samples: 4, replicas: 1}
    grid: {radius: [0.5, 1.0]}
"""
SCENES = {"scene.yaml": GAS, "balls.yaml": BALLS, "config.yaml": CONFIG}
SCENES["empty.yaml"] = "container: {lengths: [9.0, 9.0]}\n"
RUN = "--duration 1 --sample-interval 0.5"
STEP = "--engine step --time-step 0.125"
LINES = f"""
run scene.yaml -o new.nc {RUN} --seed 1,2 --follow 3 --displacements
run scene.yaml -o run.nc {RUN} --search direct --checkpoint-seconds 30 --quiet
run balls.yaml -o new.nc {RUN} {STEP} --precision float32 --no-rewind
run scene.yaml -o new.nc {RUN} {STEP} --passes 4 --skin 0.2 --threads 1
resume run.nc --checkpoint-seconds 1 --quiet
resume half.nc --checkpoint-seconds 1
info run.nc --scene
info half.nc
render run.nc -o new.png --size 64x48 --frame 1 --colour species
render run.nc -o new.gif --size 64x48 --plain --frames-per-second 5 --trail 0
render run.nc -o new.mp4 --size 64x48 --plain --frames-per-second 5
collisions scene.yaml -o new.nc --count 30 --equilibration 0.5 --seed 3
collisions balls.yaml -o met.nc --count 30
export run.nc -o new.gsd --frame 0
export run.nc -o state.data --frame -1
theory Z --eta 0.1,0.2 --dimension 2
theory viscosity --eta 0.3 --diameter 2 --temperature 0.5 --mass 3
advise scene.yaml --observable Z --accuracy 0.01 --budget 60s --pilot 0.1
advise --config config.yaml
check run.nc --radius 0.5 --lengths 9,9 --boundary periodic --tolerance 1e-6
check scene.yaml --tolerance 1e-6
check config.yaml
"""
LINES = tuple(line.split() for line in LINES.strip().splitlines())
USED = sorted({word for line in LINES for word in line})
NUMBERS = ("0", "-0.0", "1", "-1", "3", "0.5", "1e-300", "1e308", "1e400", "nan", "-inf", "inf", "1e20")
NUMBERS += (str(10**20), "9" * 5000, "0x10", "1_0", "\u0967", "1,2", "1,,2", ",", "20x20", "64x")
WORDS = ("", " ", "-", "--", "\x01", "\u00e9\n", "\udcff", "speed", "periodic", "event", "{}", "%s", "@a")
FILES = ["scene.yaml", "run.nc", "state.data", "new.gsd", "new.nc", "new.png", "new.mp4/", "link.nc"]
FILES += ["half.nc", "empty.yaml", "folder", ".", "/", "none/x", "/dev/null", "x" * 300]
NEW = ("--force", "--help", "--version", "--frame", "--sed", "-x", "-o", "", "\udcff", "scene.yaml", "run")
UNFINISHED = Path("half.nc.partial")
ENDLESS = {"--duration": 10.0, "--equilibration": 10.0, "--sample-interval": 10.0, "--count": 1e5}


@st.composite
def command_lines(draw):
    """A good command line of which up to three words are replaced, left out, repeated or added."""
    line = list(draw(st.sampled_from(LINES)))
    for _ in range(draw(st.sampled_from((0, 1, 1, 1, 2, 2, 3)))):
        change = draw(st.sampled_from((*["value"] * 6, "leave out", "repeat", "add", "misspell")))
        at = draw(st.integers(0, len(line)))
        if change == "value":
            values = [n for n, word in enumerate(line) if n and not word.startswith("--")]
            at = draw(st.sampled_from(values or [at]))
        if change == "add" or at == len(line):
            line.insert(at, draw(st.sampled_from(NEW)))
        elif change == "value":
            known = st.sampled_from((*NUMBERS, *WORDS, *FILES)) | st.sampled_from(USED)
            line[at] = draw(known | st.floats().map(repr) | st.text(max_size=5).map(without_folder))
        elif change == "misspell":
            line[at] += draw(st.sampled_from(("x", "=", "=nan", " ", "\u0301")))
        elif change == "leave out":
            del line[at]
        else:
            line.insert(at, line[at])
    return line


def without_folder(text):
    """A word that can be an argument, and names no file elsewhere."""
    return text.replace("\0", "").replace("/", "")


def is_endless(line):
    """Whether a command line asks for more work than a test should do: that would be no mistake."""
    for key, value in pairwise(line):
        key, _, inside = key.partition("=")
        try:
            if float(inside or value) > ENDLESS.get(key, float("inf")):
                return True
        except ValueError:
            continue
    return False


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with inputs and results of every kind, one of them unfinished; the kernels are compiled."""
    folder = tmp_path_factory.mktemp("lines")
    before = Path.cwd()
    os.chdir(folder)
    for name, text in SCENES.items():
        Path(name).write_text(text)
    assert main(LINES[1]) == 0
    UNFINISHED.write_bytes(shortened(Path("run.nc").read_bytes()))
    Path("folder").mkdir()
    Path("link.nc").symlink_to("run.nc")
    for line in LINES:  # compiles what they need, so that nothing below waits for a compiler
        assert main(line) == (2 if line[:2] == ["resume", "run.nc"] else 0), line
        for path in folder.glob("new*"):
            path.unlink()
        restore_unfinished(folder)
    yield folder
    os.chdir(before)


def shortened(trajectory):
    """The bytes of a trajectory with two frames counted in its header (of NetCDF-3)."""
    return trajectory[:4] + (2).to_bytes(4, "big") + trajectory[8:]


def restore_unfinished(folder):
    """Undo what `resume half.nc` does."""
    complete = folder / "half.nc"
    if complete.exists():
        (folder / UNFINISHED).write_bytes(shortened(complete.read_bytes()))
        complete.unlink()


def snapshot(folder):
    """All files and links, with their content."""
    return {
        path.relative_to(folder): os.readlink(path) if path.is_symlink() else path.read_bytes()
        for path in folder.rglob("*")
        if path.is_symlink() or path.is_file()
    }


def carried_out(line, encoding="utf-8", errors="strict"):
    """Exit code, output and stderr of a command line, to streams that encode as those of a terminal do."""
    out = io.TextIOWrapper(io.BytesIO(), encoding=encoding, errors=errors)
    err = io.TextIOWrapper(io.BytesIO(), encoding=encoding, errors="backslashreplace")
    with redirect_stdout(out), redirect_stderr(err):
        try:
            code = main(line)
        except SystemExit as leaving:  # --help, --version
            code = leaving.code
    for stream in (out, err):
        stream.flush()
    return code, out.buffer.getvalue(), err.buffer.getvalue().decode()


@settings(max_examples=settings.default.max_examples // 2)
@example([])
@given(command_lines())
def test_a_command_line_ends_with_a_known_code_and_changes_no_file(folder, line):
    if is_endless(line):
        line = ["theory", *line[1:]]
    before = snapshot(folder)
    with within(20.0):
        code, _, printed = carried_out(line)
    if line[:1] == ["resume"]:
        restore_unfinished(folder)
    after = snapshot(folder)
    for path in after.keys() - before.keys():
        (folder / path).unlink()
    assert code in (0, 1, 2), printed
    assert code == 0 or line[:1] == ["check"] or printed.count("\n") == 1, printed
    if "--force" in line:
        for path in before:
            if isinstance(before[path], bytes):
                (folder / path).write_bytes(before[path])
    else:
        assert {path: after.get(path) for path in before} == before
    assert not list(folder.glob(".gaspart-*"))


@pytest.mark.parametrize(
    ("encoding", "errors", "shown"),
    [
        ("utf-8", "surrogateescape", b"\xff\xe9"),
        ("utf-8", "strict", b"\\udcff"),
        ("latin-1", "strict", b"\\udcff"),
    ],
)
def test_every_command_takes_names_that_are_not_utf_8(folder, tmp_path, encoding, errors, shown):
    """As the names of folders and files; the first row is how `gaspart` sets up a terminal of today."""
    strange = tmp_path / "\udcfe"
    strange.mkdir()
    for name in (*SCENES, "run.nc", UNFINISHED):
        shutil.copy(folder / name, strange / f"\udcff\udce9{name}")
    for line in LINES:
        words = [str(strange / f"\udcff\udce9{word}") if is_file_name(word) else word for word in line]
        code, printed, complaint = carried_out(words, encoding, errors)
        assert code == (2 if line[:2] == ["resume", "run.nc"] else 0), complaint
        assert shown in printed or line[0] in ("info", "theory", "advise", "check") or code, line
        for path in strange.glob("*new.nc"):
            path.unlink()


def is_file_name(word):
    return word.endswith((".yaml", ".nc", ".png", ".gif", ".mp4", ".gsd", ".data"))
