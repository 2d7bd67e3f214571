"""A finished run reports the verdicts of its claims."""

import re
import subprocess

import pytest
from reproduction.claims.data import claim
from workspace import ROOT, copy_of_project, leave_one_figure

from gaspart.reproduction import claims

pytestmark = pytest.mark.workflow
COUNTS = ["3 claims", "tests: 1 agree, 1 disagree", "families: 1 disagree"]
NAMED = "disagrees: virial_discs: Z of a wrong gas"


@pytest.fixture
def judged(tmp_path):
    """A copy of the project with the claims of its only figure judged."""
    copy = copy_of_project(tmp_path)
    leave_one_figure(tmp_path, "virial_discs")
    wrong = claim(9.0, text="Z of a wrong gas")
    claims.write(tmp_path / "results/claims/virial_discs.csv", "virial_discs", [claim(), wrong])
    return copy


def test_snakemake_ends_with_the_verdicts(judged, monkeypatch):
    run = ("--cores", "1", "--quiet", "rules", "--allowed-rules", "claims", "--", "claims")
    monkeypatch.delenv("MAKELEVEL", raising=False)
    done = judged.snakemake(*run)
    assert done.returncode == 0, done.stdout
    lines = done.stdout.splitlines()
    at = lines.index(COUNTS[0])
    assert lines[at : at + 4] == [*COUNTS, NAMED]

    monkeypatch.setenv("MAKELEVEL", "1")  # make prints them itself
    assert COUNTS[1] not in judged.snakemake("--force", *run).stdout


def test_make_prints_the_verdicts_with_or_without_work(judged):
    table = judged.path / "results/tables/claims.csv"
    table.parent.mkdir()
    claims.collect([judged.path / "results/claims/virial_discs.csv"]).to_csv(table, index=False)
    (judged.path / "Makefile").write_text(
        (ROOT / "Makefile").read_text() + "\nverdicts:\n\t$(VERDICTS) results/tables/claims.csv\n"
    )
    (judged.path / ".venv").symlink_to(ROOT / ".venv")
    command = ["make", "--no-print-directory", "verdicts"]
    done = subprocess.run(command, cwd=judged.path, capture_output=True, text=True)
    assert done.stdout.splitlines()[:4] == [*COUNTS, NAMED], done.stderr
    recipes = re.findall(
        r"^(all|precise|smoke): setup\n((?:\t.*\n)+)", (ROOT / "Makefile").read_text(), re.MULTILINE
    )
    assert all("$(VERDICTS)" in recipe for _, recipe in recipes) and len(recipes) == 3
