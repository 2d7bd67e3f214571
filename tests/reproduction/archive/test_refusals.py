"""What is no archive, and what cannot be one, is refused in one line."""

import hashlib
import zipfile

import pytest

from gaspart.cli import main
from gaspart.reproduction.archive.writing import MANIFEST


def refused(capsys, *words):
    assert main([str(word) for word in words]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    return line


def test_what_is_no_archive_is_refused(tmp_path, capsys):
    missing, text, other = (tmp_path / name for name in ("missing.zip", "text.zip", "other.zip"))
    text.write_text("no archive")
    with zipfile.ZipFile(other, "w") as file:
        file.writestr("README.md", "something else")
    assert "missing.zip': cannot be read: No such file or directory" in refused(capsys, "verify", missing)
    assert "text.zip': is no zip file, or one that is cut short" in refused(capsys, "verify", text)
    for path in (other, tmp_path):
        assert f"is no archive of gaspart: it has no {MANIFEST}" in refused(capsys, "verify", path)


def test_a_manifest_that_cannot_be_read_is_refused(tmp_path, capsys):
    (tmp_path / MANIFEST).write_text("no digest\n")
    assert f"has a {MANIFEST} that cannot be read" in refused(capsys, "verify", tmp_path)
    (tmp_path / MANIFEST).write_bytes(b"\xff\xfe")
    assert f"has a damaged {MANIFEST}" in refused(capsys, "verify", tmp_path)


def test_tables_that_are_missing_or_have_other_columns_are_refused(tmp_path, capsys):
    (tmp_path / MANIFEST).write_text("")
    assert "has tables that cannot be read, though they have" in refused(capsys, "verify", tmp_path)
    (tmp_path / "provenance").mkdir()
    (tmp_path / "provenance/run.json").write_text("{}")
    digest = hashlib.sha256(b"{}").hexdigest()
    (tmp_path / MANIFEST).write_text(f"{digest}  provenance/run.json\n")
    assert "has tables that cannot be read, though they have" in refused(capsys, "verify", tmp_path)


def test_an_encrypted_archive_is_damaged(tmp_path, capsys):
    path = tmp_path / "encrypted.zip"
    with zipfile.ZipFile(path, "w") as file:
        file.writestr(MANIFEST, "")
    data = bytearray(path.read_bytes())
    for signature, flags in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        data[data.index(signature) + flags] |= 1
    path.write_bytes(data)
    assert f"has a damaged {MANIFEST}" in refused(capsys, "verify", path)


def test_an_archive_replaces_no_other_file(tmp_path, capsys):
    other = tmp_path / "other.zip"
    with zipfile.ZipFile(other, "w") as file:
        file.writestr("thesis.txt", "unique")
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
