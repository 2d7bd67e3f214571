"""Archives that somebody else has packed: all damage is found, and nothing outside of them is read."""

import hashlib
import io
import json
import shutil
import zipfile
from pathlib import Path

import netCDF4
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gaspart.cli import main
from gaspart.errors import SceneError
from gaspart.reproduction.archive import tables
from gaspart.reproduction.archive.stored import verify
from gaspart.reproduction.archive.writing import MANIFEST

RUN = {"title": "t", "results": "results", "gaspart": "1", "revision": "a", "archived": "2026-01-01T00:00:00"}
MEASUREMENT, POINT, CLAIMS = (
    "results/measurements/gas.nc",
    "results/points/gas/a.nc",
    "results/tables/claims.csv",
)


def sha256(content):
    return hashlib.sha256(content).hexdigest()


def measurement(points=POINT):
    """The content of a measurement that is made of these points."""
    file = netCDF4.Dataset("made", "w", format="NETCDF3_CLASSIC", memory=1)
    file.points = points
    return bytes(file.close())


def contents():
    """The files of a valid archive of one claim, without its manifest."""
    made, point = measurement(), b"a point"
    joint = sha256(f"{sha256(point)}  {POINT}\n".encode())
    row = ("gas", "a", "fill", "", POINT, str(len(point)), sha256(point), "", "")
    claim = ("gas", "c", "agrees", MEASUREMENT, sha256(made), joint)
    return {
        "README.md": b"hi",
        POINT: point,
        MEASUREMENT: made,
        CLAIMS: b"figure,claim,verdict\ngas,c,agrees\n",
        tables.CONFIG: b"title: t\n",
        tables.RUN: json.dumps(RUN).encode(),
        tables.POINTS: tables.text_of([row], tables.PointFile._fields).encode(),
        tables.CLAIMS: tables.text_of([claim], tables.ClaimData._fields).encode(),
    }


def stated(files):
    """Files, and a manifest that agrees with them."""
    lines = (f"{sha256(content)}  {name}\n" for name, content in files.items())
    return files | {MANIFEST: "".join(lines).encode()}


def packed(files):
    """A zip file."""
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as file:
        for name, content in files.items():
            file.writestr(name, content)
    return target.getvalue()


def folder(path, files):
    """Unpack files into a folder."""
    for name, content in files.items():
        target = Path(path, name)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content)
    return path


def outcome(capsys, path, *options):
    """The exit code of `gaspart verify`, its lines, and its error; every line is printable."""
    code = main(["verify", str(path), *options])
    said = capsys.readouterr()
    assert all(line.isprintable() for text in (said.out, said.err) for line in text.split("\n"))
    assert said.err.count("\n") == (code == 2)
    return code, said.out.splitlines(), said.err


def test_a_valid_one_is_verified_as_a_file_and_as_a_folder(tmp_path, capsys):
    files = stated(contents())
    (tmp_path / "a.zip").write_bytes(packed(files))
    path = folder(tmp_path / "a", files)
    again = shutil.make_archive(str(tmp_path / "b"), "zip", path)  # with entries for folders
    for place in (tmp_path / "a.zip", path, again):
        code, lines, _ = outcome(capsys, place)
        assert code == 0 and [line[:5] for line in lines] == ["ok   "] * 4


@pytest.mark.parametrize("name", ["../up", "a/../../up", "/etc/passwd", "a\\..\\b"])
def test_a_name_that_leads_out_is_refused(tmp_path, capsys, name):
    (tmp_path / "a.zip").write_bytes(packed(stated(contents() | {name: b"x"})))
    assert "has a name that leads out of it" in outcome(capsys, tmp_path / "a.zip")[2]


TABLES = [
    *((tables.RUN, text) for text in (b"[1]", b"1", b"", b"{", b"\xff", b"[" * 100_000, b"{}")),
    *((tables.RUN, json.dumps(RUN | {"results": place}).encode()) for place in (None, "/etc", "..", "\0")),
    *((tables.POINTS, text) for text in (b"a,b\n1,2\n", b'"never closed', b"\xff\xfe")),
    (CLAIMS, b"figure\ngas\n"),
    *((MEASUREMENT, text) for text in (b"", b"CDF\x01" + bytes(30), measurement("/etc/passwd\n\x1b[2J"))),
]


@pytest.mark.parametrize(("name", "content"), TABLES)
def test_a_table_that_cannot_be_used_is_refused(tmp_path, capsys, name, content):
    """The digests agree: whoever made it has written the manifest too."""
    code, lines, error = outcome(capsys, folder(tmp_path / "a", stated(contents() | {name: content})))
    assert code == 2 or any(line.startswith("WRONG") for line in lines), (lines, error)


def test_a_link_in_a_folder_is_not_followed(tmp_path, capsys):
    path = folder(tmp_path / "a", stated(contents()))
    shutil.move(path / "README.md", tmp_path / "secret")
    (path / "README.md").symlink_to(tmp_path / "secret")
    assert outcome(capsys, path)[1] == ["WRONG files: changed or damaged: README.md"]


@pytest.mark.parametrize(
    ("content", "rule"),
    [
        (None, "cannot be read: No such file or directory"),
        (b"no archive", "is no zip file, or one that is cut short"),
        (packed(stated(contents()))[:-30], "is no zip file, or one that is cut short"),
        (packed({"README.md": b"something else"}), f"is no archive of gaspart: it has no {MANIFEST}"),
        (packed({MANIFEST: b"no digest\n"}), f"has a {MANIFEST} that cannot be read"),
        (packed({MANIFEST: b"\xff\xfe"}), f"has a damaged {MANIFEST}"),
        (packed(stated({"provenance/run.json": b"{}"})), "has tables that cannot be read, though they have"),
    ],
)
def test_what_is_no_archive_is_refused(tmp_path, capsys, content, rule):
    if content is not None:
        (tmp_path / "a.zip").write_bytes(content)
    assert rule in outcome(capsys, tmp_path / "a.zip")[2]


def test_a_folder_without_a_manifest_is_not_searched(capsys):
    assert "it has no manifest" in outcome(capsys, "/")[2]


@pytest.mark.parametrize("scene", ["/etc/hostname", "../outside.yaml", "missing.yaml"])
@pytest.mark.parametrize("in_grid", [False, True])
def test_a_rerun_reads_no_scene_of_this_machine(tmp_path, capsys, scene, in_grid):
    (tmp_path / "outside.yaml").write_text("secret: value\n")
    block = f"grid: [{{scene: ['{scene}']}}]" if in_grid else f"point: {{scene: '{scene}'}}"
    config = f"title: t\nseed: 1\npoints: results/points\nfigures: {{}}\nexperiments: {{gas: {{{block}}}}}\n"
    path = folder(tmp_path / "a", stated(contents() | {tables.CONFIG: config.encode()}))
    code, _, error = outcome(capsys, path, "--rerun", "1")
    assert code == 2
    assert "has a config with a scene that is not in the archive" in error and "secret" not in error


def test_a_title_does_not_control_the_terminal(tmp_path, capsys):
    title = "\x1b[2J\x1b[Hok    claims: 5, made of 5 measurements\r\n\u202e\x9b1m\x07"
    run = json.dumps(RUN | {"title": title}).encode()
    code, lines, _ = outcome(capsys, folder(tmp_path / "a", stated(contents() | {tables.RUN: run})))
    assert code == 0 and sum(line.startswith("ok    claims") for line in lines) == 1


WHOLE = packed(stated(contents()))


@settings(max_examples=150)
@given(data=st.data())
def test_any_damage_to_a_zip_file_is_found(tmp_path_factory, data):
    """Bytes changed, removed or doubled anywhere, the lists of entries among them."""
    content = bytearray(WHOLE)
    for _ in range(data.draw(st.integers(1, 4))):
        tail = data.draw(st.booleans())  # where the entries are listed
        at = data.draw(st.integers(len(content) // 2 if tail else 0, max(0, len(content) - 1)))
        length = data.draw(st.integers(1, 40))
        part = bytes(content[at : at + length])
        content[at : at + length] = data.draw(st.sampled_from([bytes([255]) * length, b"", part * 2])) or (
            data.draw(st.binary(max_size=8))
        )
    path = tmp_path_factory.mktemp("archive") / "a.zip"
    path.write_bytes(content)
    try:
        checks = list(verify(path))
    except SceneError as error:
        assert str(error).isprintable()
        return
    if all(check.passed for check in checks):
        with zipfile.ZipFile(path) as file:  # what another program finds
            assert {name: file.read(name) for name in file.namelist()} == stated(contents())


def refused(capsys, *words):
    assert main([str(word) for word in words]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    return line


def test_an_archive_replaces_no_other_file(tmp_path, capsys):
    other = tmp_path / "other.zip"
    other.write_bytes(packed({"thesis.txt": b"unique"}))
    line = refused(capsys, "archive", tmp_path, "-o", other, "--force")
    assert "exists and is not an archive of a run; move it away" in line
    assert "must end in .zip" in refused(capsys, "archive", tmp_path, "-o", tmp_path / "archive.tar")


@pytest.mark.parametrize("name", ["results", "results/tables", "results/smoke"])
def test_folders_that_hold_no_results_are_refused(tmp_path, capsys, name):
    (tmp_path / name).mkdir(parents=True)
    line = refused(capsys, "archive", tmp_path / name, "-o", tmp_path / "archive.zip")
    assert "holds no results of a finished run: tables/claims.csv is missing" in line
    (tmp_path / name / "tables").mkdir()
    (tmp_path / name / "tables/claims.csv").touch()
    line = refused(capsys, "archive", tmp_path / name, "-o", tmp_path / "archive.zip")
    assert "must be the folder results of a project, or that of a run in it" in line
    assert not (tmp_path / "archive.zip").exists()
