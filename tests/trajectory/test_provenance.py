"""The revision of the program: of a commit, of an edited checkout, and outside of one."""

import os
import subprocess

import pytest

from gaspart.trajectory import provenance


@pytest.fixture
def checkout(tmp_path, monkeypatch):
    """A repository with one tracked file, in the place of this package's folder."""
    for name in [name for name in os.environ if name.startswith("GIT_")]:
        monkeypatch.delenv(name)
    monkeypatch.setattr(provenance, "__file__", str(tmp_path / "provenance.py"))
    (tmp_path / "__init__.py").write_text("a = 1\n")
    git(tmp_path, "init", "--quiet")
    git(tmp_path, "add", "__init__.py")
    git(tmp_path, "-c", "user.name=a", "-c", "user.email=a@b", "commit", "--quiet", "--message=first")
    return tmp_path


def git(folder, *arguments):
    done = subprocess.run(["git", "-C", folder, *arguments], check=True, capture_output=True, text=True)
    return done.stdout.strip()


def revision():
    return provenance.git_revision.__wrapped__()  # without the cache of this process


def test_the_revision_is_the_commit_and_states_edits(checkout):
    commit = git(checkout, "rev-parse", "HEAD")
    (checkout / "untracked").touch()
    assert len(commit) == 40 and revision() == commit
    (checkout / "__init__.py").write_text("a = 2\n")
    assert revision() == f"{commit}-modified"


def test_a_package_that_is_not_tracked_has_no_revision(checkout):
    git(checkout, "rm", "--quiet", "--cached", "__init__.py")
    assert revision() == ""


def test_the_index_is_neither_locked_nor_written(checkout):
    """Times that differ from those in the index are a reason for git to write it anew."""
    commit, index = git(checkout, "rev-parse", "HEAD"), checkout / ".git/index"
    os.utime(checkout / "__init__.py", (1e9, 1e9))
    os.utime(index, (1.5e9, 1.5e9))
    before = index.stat()
    assert revision() == commit
    after = index.stat()
    assert (after.st_ino, after.st_mtime_ns) == (before.st_ino, before.st_mtime_ns)
    (checkout / ".git/index.lock").touch()
    assert revision() == commit
