"""The package of docs/adding-a-figure.md, installed: the workflow measures, judges and draws its figure."""

import csv
import os
import re
import subprocess
import sys

import pytest
import xarray as xr
from workspace import ROOT, copy_of_project

pytestmark = [pytest.mark.workflow, pytest.mark.thorough]

FILES = re.compile(r'^```\w+ title="(speed-moments/[^"]+)"\n(.*?)^```$', re.MULTILINE | re.DOTALL)
WHOLE = {"title": "moments", "seed": 1, "points": "results/points"}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A copy of the project that has run the page's config alone, and the variables that find the package."""
    copy = copy_of_project(tmp_path_factory.mktemp("installed"))
    page = (ROOT / "docs/adding-a-figure.md").read_text(encoding="utf-8")
    for path, text in FILES.findall(page):
        file = copy.path / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
    options = ["--no-deps", "--no-index", "--no-build-isolation", "--quiet", "--target", "site"]
    command = [sys.executable, "-m", "pip", "install", *options, "./speed-moments"]
    subprocess.run(command, cwd=copy.path, check=True, stdin=subprocess.DEVNULL)
    stated = "".join(f"{key}: {value}\n" for key, value in WHOLE.items())
    config = (copy.path / "speed-moments/moments.yaml").read_text(encoding="utf-8")
    (copy.path / "config/config.yaml").write_text(stated + config, encoding="utf-8")
    within = ["env", f"PYTHONPATH={os.pathsep.join(str(copy.path / name) for name in ('src', 'site'))}"]
    result = copy.snakemake("--cores", "2", "claims", "results/figures/fast_particles.png", within=within)
    assert result.returncode == 0, result.stdout[-20_000:]
    return copy, within


def test_its_figure_is_drawn_and_its_claims_agree(made):
    copy, _ = made
    assert (copy.path / "results/figures/fast_particles.png").read_bytes().startswith(b"\x89PNG")
    with (copy.path / "results/tables/claims.csv").open(newline="") as file:
        tests = [row for row in csv.DictReader(file) if row["kind"] != "family"]
    verdicts = {row["claim"]: row["verdict"] for row in tests}
    assert verdicts == {
        f"moment of order 6 of the speeds of {count} particles": "agrees" for count in (16, 36)
    }


def test_its_data_state_the_package(made):
    copy, _ = made
    with xr.open_dataset(copy.path / "results/measurements/fast_particles.nc") as dataset:
        assert dataset.attrs["package"] == "speed-moments 0.1"


def test_a_change_of_the_package_runs_its_figure_again(made):
    copy, within = made
    (copy.path / "site/speed_moments/figure.py").open("a").write("_CHANGED = 1\n")
    result = copy.snakemake("--dry-run", "--cores", "2", "claims", within=within)
    rows = re.findall(r"^(figure|simulate) +(\d+)$", result.stdout, re.MULTILINE)
    assert dict(rows) == {"figure": "1"}


def test_without_the_package_the_config_is_refused_in_one_line(made):
    copy, _ = made
    result = copy.snakemake("--dry-run", "--cores", "2", "claims")
    assert result.returncode == 2
    assert "figures.fast_particles.kind = 'speed_moment': must be one of ['observable']" in result.stdout
