"""The linters of the workflow."""

import subprocess
import sys

import pytest
from workspace import ROOT, SMOKE

pytestmark = pytest.mark.workflow


def test_snakemake_has_no_complaint(fresh):
    result = fresh.snakemake("--lint", *SMOKE)
    assert result.returncode == 0, result.stdout


def test_the_rules_are_formatted():
    command = [sys.executable, "-m", "snakefmt", "--check", "Snakefile", "workflow"]
    result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
