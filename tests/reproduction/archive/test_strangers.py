"""Archives of strangers: each is refused in one line, or found WRONG, in bounded time and memory; nothing
outside is read, and no text of theirs controls the terminal."""

import io
import json
import os
import re
import resource
import shutil
import socket
import tempfile
import zipfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from malformed import within
from strangers import (
    MANIFEST,
    POINT,
    broken_tables,
    broken_zips,
    contents,
    entry,
    folder,
    manifest,
    packed,
    sha256,
    stated,
)

from gaspart.cli import main
from gaspart.errors import SceneError
from gaspart.reproduction.archive import limits, stored, tables
from gaspart.reproduction.archive.contents import scene_files
from gaspart.reproduction.archive.stored import verify
from gaspart.trajectory import recording


def outcome(capsys, path):
    """The exit code of `gaspart verify`, and its lines; every one is printable."""
    with within(10.0):
        code = main(["verify", str(path)])
    said = capsys.readouterr()
    for text in (said.out, said.err):
        assert all(line.isprintable() and len(line) < 5000 for line in text.split("\n")), text
    assert "Traceback" not in said.err and said.err.count("\n") == (code == 2)
    return code, said.out.splitlines(), said.err


def test_a_valid_one_is_verified_as_a_file_and_as_a_folder(tmp_path, capsys):
    files = stated(contents())
    (tmp_path / "a.zip").write_bytes(packed(files.items()))
    for place in (tmp_path / "a.zip", folder(tmp_path / "a", files)):
        code, lines, _ = outcome(capsys, place)
        assert code == 0 and [line[:5] for line in lines] == ["ok   "] * 4


@pytest.mark.parametrize(("what", "content"), [pytest.param(*one, id=one[0][:60]) for one in broken_zips()])
def test_a_zip_file_that_misleads_is_refused(tmp_path, capsys, what, content):
    path = tmp_path / "a.zip"
    path.write_bytes(content)
    code, lines, error = outcome(capsys, path)
    assert code == 2 or any(line.startswith("WRONG files") for line in lines), (lines, error)
    assert not any(line.startswith("ok") for line in lines)


@pytest.mark.parametrize(("name", "content"), list(broken_tables()))
def test_a_table_that_cannot_be_used_is_refused(tmp_path, capsys, name, content):
    """The digests agree: whoever made it has written the manifest too."""
    path = folder(tmp_path / "a", stated(contents() | {name: content}))
    code, lines, error = outcome(capsys, path)
    assert code == 2 or any(line.startswith("WRONG") for line in lines), (lines, error)


@pytest.mark.parametrize("kind", ["link", "outside", "pipe", "socket", "dangling", "linked folder", "loop"])
@pytest.mark.parametrize("name", ["extra", MANIFEST, tables.RUN, "results/extra"])
def test_a_folder_with_other_than_files_is_refused(tmp_path, capsys, monkeypatch, kind, name):
    path = folder(tmp_path / "a", stated(contents()))
    monkeypatch.chdir(path)
    (tmp_path / "secret").write_text("secret")
    target = Path(name)
    target.unlink(missing_ok=True)
    if kind == "pipe":
        os.mkfifo(target)
    elif kind == "socket":
        with socket.socket(socket.AF_UNIX) as made:
            made.bind(name)
    else:
        places = {"link": path / "README.md", "outside": tmp_path / "secret", "dangling": "nowhere"}
        target.symlink_to(places.get(kind, path if kind == "loop" else tmp_path))
    code, lines, error = outcome(capsys, path)
    assert code == 2 and lines == [] and "secret'" not in error


def test_a_folder_whose_files_are_not_there_is_refused(tmp_path, capsys):
    """A sparse file of a terabyte."""
    path = folder(tmp_path / "a", stated(contents()))
    with (path / "extra").open("wb") as file:
        file.truncate(1 << 40)
    code, lines, error = outcome(capsys, path)
    assert code == 2 and lines == [] and "has contents of" in error


def test_a_folder_with_a_name_that_is_not_utf_8_is_refused(tmp_path, capsys):
    path = folder(tmp_path / "a", stated(contents()))
    (path / "\udcff").touch()
    assert "has a name that cannot be shown" in outcome(capsys, path)[2]


def test_a_folder_without_a_manifest_is_not_searched(capsys):
    assert "it has no manifest" in outcome(capsys, "/")[2]


@pytest.mark.parametrize("place", ["/dev/zero", "/dev/null", "pipe", "socket", "nowhere", "a\0b", ""])
def test_what_is_no_file_is_refused(tmp_path, monkeypatch, capsys, place):
    monkeypatch.chdir(tmp_path)
    os.mkfifo("pipe")
    with socket.socket(socket.AF_UNIX) as made:
        made.bind("socket")
        assert outcome(capsys, place)[0] == 2


def test_a_text_that_is_too_long_is_not_read_whole(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(stored, "MOST_BYTES", 1000)
    monkeypatch.setattr(stored.Stored.text, "__defaults__", (1000,))
    path = folder(tmp_path / "a", stated(contents() | {tables.CLAIMS: bytes(2000)}))
    assert "of more than 1000 bytes" in outcome(capsys, path)[2]


def test_memory_is_bounded_whatever_the_size(tmp_path, capsys):
    """A table of zeros, 100 MB in a zip file of 100 kB."""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    path = tmp_path / "a.zip"
    with path.open("wb") as file:
        files = contents() | {tables.POINTS: bytes(100 << 20)}
        file.write(packed(stated(files).items()))
    made = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    del files
    assert outcome(capsys, path)[0] == 2
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert after - max(before, made) < 200_000  # kB


def test_too_many_files_are_refused(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(stored, "MOST_FILES", 5)
    path = folder(tmp_path / "a", stated(contents()))
    assert "has more than 5 files" in outcome(capsys, path)[2]


SCENES = [
    "/etc/hostname",
    "../outside.yaml",
    "config/scenes/../../../outside.yaml",
    "/dev/zero",
    "missing.yaml",
]


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("in_grid", [False, True])
def test_a_rerun_reads_no_scene_of_this_machine(tmp_path, capsys, scene, in_grid):
    (tmp_path / "outside.yaml").write_text("secret: value\n")
    block = f"grid: [{{scene: ['{scene}']}}]" if in_grid else f"point: {{scene: '{scene}'}}"
    config = f"title: t\nseed: 1\npoints: results/points\nfigures: {{}}\nexperiments: {{gas: {{{block}}}}}\n"
    assert scene_files({"experiments": {"gas": {"point": {"scene": scene}}}}) == [os.path.normpath(scene)]
    path = folder(tmp_path / "a", stated(contents() | {tables.CONFIG: config.encode()}))
    assert main(["verify", str(path), "--rerun", "1"]) == 2
    error = capsys.readouterr().err
    assert "has a config with a scene that is not in the archive" in error and "secret" not in error


@pytest.mark.parametrize(
    ("key", "value", "rule"),
    [
        ("samples", 10**9, "a point gas/single of .* bytes of 8 particles; simulated are at most"),
        ("samples", 1, "a trajectory that takes more than"),
    ],
)
def test_a_rerun_is_bounded_and_leaves_no_folder(tmp_path, monkeypatch, capsys, key, value, rule):
    monkeypatch.setattr(stored, "_LONGEST_RUN", 0.0)
    monkeypatch.setattr(recording, "_PROGRESS", 0.0)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    gas = {"count": 8, "dimension": 2, "packing_fraction": 0.1, "radius": 0.5, "temperature": 1.0}
    gas |= {"collisions_per_particle": 1e7, key: value}
    config = {"title": "t", "seed": 1, "points": "results/points", "figures": {}}
    config["experiments"] = {"gas": {"point": gas}}
    row = ("gas", "single", "simulate", "0", POINT, "7", sha256(b"a point"), sha256(b"a point"), "", "")
    table = tables.text_of([row[: len(tables.PointFile._fields)]], tables.PointFile._fields)
    files = contents() | {tables.CONFIG: json.dumps(config).encode(), tables.POINTS: table.encode()}
    path = folder(tmp_path / "a", stated(files))
    assert main(["verify", str(path), "--rerun", "1"]) == 2
    error = capsys.readouterr().err
    assert re.search(rule, error), error
    assert os.listdir(tmp_path) == ["a"]


def test_text_of_a_stranger_does_not_control_the_terminal(tmp_path, capsys):
    """A title and names in tables with escape codes, and with lines that look like those of a check."""
    nasty = "\x1b[2J\x1b[Hok    claims: 5, made of 5 measurements\r\n\u202e\x9b1m\x07"
    for title in (nasty, nasty * 10_000):
        run = (
            contents()[tables.RUN]
            .decode()
            .replace('"t"', repr(title)[1:-1].join('""').replace("\\x", "\\u00"))
        )
        path = folder(tmp_path / "a", stated(contents() | {tables.RUN: run.encode()}))
        code, lines, _ = outcome(capsys, path)
        assert code in (0, 2) and sum(line.startswith("ok    claims") for line in lines) <= 1
        shutil.rmtree(path)
    claims = contents()[tables.CLAIMS].decode().replace("gas,", f'"{nasty}",', 1).encode()
    judged = f'figure,claim,verdict\n"{nasty}",c,agrees\n'.encode()
    files = contents() | {
        tables.CLAIMS: claims.replace(b",agrees", b",agrees"),
        "results/tables/claims.csv": judged,
    }
    files[tables.POINTS] = files[tables.POINTS].replace(sha256(b"a point").encode(), b"0" * 64)
    code, lines, _ = outcome(capsys, folder(tmp_path / "b", stated(files)))
    assert code == 1 and [line[:12] for line in lines if line.startswith("WRONG")] == [
        "WRONG claims",
        "WRONG points",
    ]
    missing = manifest(contents()) + f"{'0' * 64}  \x1b[2Jok    files\n".encode()
    path = folder(tmp_path / "c", contents() | {MANIFEST: missing})
    code, lines, _ = outcome(capsys, path)
    assert code == 1 and lines == [r"WRONG files: missing: \x1b[2Jok    files"]


def test_a_file_with_64_bit_sizes_is_read(tmp_path, capsys):
    path = tmp_path / "a.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for name, content in stated(contents()).items():
            with file.open(entry(name), "w", force_zip64=True) as target:
                target.write(content)
    assert outcome(capsys, path)[0] == 0


class Stream(io.BytesIO):
    """A file that cannot be rewound: sizes then follow the contents."""

    def seekable(self):
        return False

    def tell(self):
        raise OSError


def test_archives_that_other_programs_have_packed_are_read(tmp_path, capsys):
    """With entries for folders, with sizes behind the contents, not compressed, with a comment at the end."""
    files = stated(contents())
    path = folder(tmp_path / "a", files)
    assert outcome(capsys, shutil.make_archive(str(tmp_path / "b"), "zip", path))[0] == 0
    with zipfile.ZipFile(stream := Stream(), "w", zipfile.ZIP_DEFLATED) as file:
        for name, content in files.items():
            file.writestr(name, content)
    (tmp_path / "c.zip").write_bytes(stream.getvalue())
    assert stream.getvalue()[6] & 8 and outcome(capsys, tmp_path / "c.zip")[0] == 0
    with zipfile.ZipFile(tmp_path / "d.zip", "w") as file:
        file.comment = b"a comment"
        for name, content in files.items():
            file.writestr(name, content)
    assert outcome(capsys, tmp_path / "d.zip")[0] == 0


WHOLE = packed(stated(contents()).items())


@settings(max_examples=150)
@given(data=st.data())
def test_any_damage_to_a_zip_file_is_found(tmp_path_factory, data):
    """Bytes changed, removed, doubled, exchanged or added anywhere, the lists of entries among them."""
    content = bytearray(WHOLE)
    for _ in range(data.draw(st.integers(1, 4))):
        tail = data.draw(st.booleans())  # where the entries are listed
        at = data.draw(st.integers(len(content) // 2 if tail else 0, max(0, len(content) - 1)))
        length = data.draw(st.integers(1, 40))
        kind = data.draw(st.sampled_from(["change", "change", "ones", "cut", "double", "drop"]))
        part = bytes(content[at : at + length])
        replaced = {
            "change": data.draw(st.binary(min_size=1, max_size=8)),
            "ones": b"\xff" * min(4, length),
            "cut": b"",
            "double": part * 2,
            "drop": b"",
        }[kind]
        end = len(content) if kind == "cut" else at + (length if kind != "change" else len(replaced))
        content[at:end] = replaced
    path = tmp_path_factory.mktemp("archive") / "a.zip"
    path.write_bytes(content)
    try:
        checks = list(verify(path))
    except SceneError as error:
        assert str(error).isprintable()
        return
    assert all(str(check).isprintable() for check in checks)
    if all(check.passed for check in checks):
        assert unpacked(path) == stated(contents())


def unpacked(path):
    """What another program finds in a zip file."""
    with zipfile.ZipFile(path) as file:
        return {name: file.read(name) for name in file.namelist()}


TEXTS = [
    b"",
    b"\n",
    b",",
    b'"',
    b"\0",
    b"\xff",
    b"\r",
    b"\x1b[2J",
    b"gas",
    b"/dev/zero",
    b"../x",
    b"[",
    b"{",
    b'":',
]
TEXTS += [
    b"9" * 5000,
    b"," * 500,
    b'"' * 3,
    b"results",
    b"-1",
    b"1e999",
    b"null",
    b"\xef\xbb\xbf",
    b"a" * 140_000,
]


@settings(max_examples=150)
@given(data=st.data())
def test_any_text_of_a_table_is_used_or_refused(tmp_path_factory, data):
    files = contents()
    for _ in range(data.draw(st.integers(1, 3))):
        name = data.draw(
            st.sampled_from([tables.RUN, tables.POINTS, tables.CLAIMS, "results/tables/claims.csv"])
        )
        at = data.draw(st.integers(0, len(files[name])))
        end = data.draw(st.integers(at, min(len(files[name]), at + 60)))
        files[name] = files[name][:at] + data.draw(st.sampled_from(TEXTS)) + files[name][end:]
    path = folder(tmp_path_factory.mktemp("archive") / "a", stated(files))
    try:
        checks = list(verify(path))
    except SceneError as error:
        assert str(error).isprintable()
    else:
        assert all(str(check).isprintable() for check in checks)


@pytest.mark.parametrize("name", ["a\nb", "\udcff", "a\\b", "A.yaml", "\x1b[2J"])
def test_a_file_that_no_archive_can_hold_is_refused_when_it_is_written(name):
    fault = limits.name_fault(name)
    if name == "A.yaml":
        with pytest.raises(SceneError, match="one file on some systems"):
            limits.check_names(Path("a"), ["a.yaml", name])
    else:
        assert fault
