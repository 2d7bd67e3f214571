"""`make` on a fresh machine: by an ordinary user, in a path with a space, offline once set up, and twice."""

import os
import shutil
import subprocess

import pytest
from digests import digests, known
from machine import OFFLINE, folder_of_user, give, ordinary_user, why_not
from workspace import ROOT, copy_of_project, leave_one_figure

pytestmark = [pytest.mark.workflow, pytest.mark.thorough]
KNOWN = known()
FIGURE = "virial_discs"


@pytest.fixture
def clone():
    """What a clone holds, with a config of one figure, in a folder of the ordinary user."""
    with folder_of_user() as home:
        copy = home / "a fresh clone"
        copy.mkdir()
        copy_of_project(copy)
        locks = "environment.txt", "environment-dev.txt"
        for name in ("Makefile", "pyproject.toml", *locks, "README.md", "LICENSE"):
            shutil.copy2(ROOT / name, copy)
        leave_one_figure(copy, FIGURE)
        give(home)
        yield copy


def make(clone, *arguments, isolated=()):
    """What `make` prints, with nothing in its environment but a path and how to reach a package index."""
    home = {"HOME": str(clone.parent), "PATH": os.environ["PATH"]}
    index = {name: value for name, value in os.environ.items() if name.startswith(("PIP_", "SSL_"))}
    proxies = {name: value for name, value in os.environ.items() if name.lower().endswith("_proxy")}
    done = subprocess.run(
        [*isolated, "make", *arguments], cwd=clone, env=home | index | proxies, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **ordinary_user(),
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-10_000:]
    return done.stdout


def times(clone):
    """When each file was written, Snakemake's own log apart."""
    files = [*(clone / "results").rglob("*"), *(clone / ".venv").glob("*")]
    return {path: path.stat().st_mtime_ns for path in files}


@pytest.mark.skipif(why_not(OFFLINE) is not None, reason=str(why_not(OFFLINE)))
def test_make_twice_offline_by_an_ordinary_user_in_a_path_with_a_space(clone):
    make(clone, "setup")
    make(clone, isolated=OFFLINE)
    assert (clone / f"results/figures/{FIGURE}.png").read_bytes().startswith(b"\x89PNG")
    assert f'id="{FIGURE}"' in (clone / "results/report.html").read_text(encoding="utf-8")
    made = digests(clone / "results/smoke/points")
    assert made and made == {name: KNOWN[name] for name in made}
    before = times(clone)
    assert "Nothing to be done" in make(clone, isolated=OFFLINE)
    assert times(clone) == before
