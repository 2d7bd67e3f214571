"""The benchmarks' code, with a few particles: it runs, and makes table and figure. No timing is judged."""

import csv
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOME = "2d-10000-0.2-plain or start or insertion"  # their kernels are others' as well


@pytest.mark.thorough
def test_a_small_run_makes_the_table_and_the_figure(tmp_path):
    run, table, figure = (tmp_path / name for name in ("run.json", "performance.csv", "performance.png"))
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", "benchmarks"]
    command += ["--small", "-k", SOME, f"--benchmark-json={run}", "--no-header", "--override-ini=addopts="]
    alone = {key: value for key, value in os.environ.items() if not key.startswith("PYTEST_")}
    made = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, env=alone)
    assert made.returncode == 0, made.stdout + made.stderr
    subprocess.run([sys.executable, "benchmarks/table.py", run, table, figure], cwd=ROOT, check=True)
    with table.open() as file:
        rows = {row["engine"]: row for row in csv.DictReader(file)}
    assert set(rows) == {"event", "start of a job", "random insertion"}
    event = rows["event"]
    assert float(event["value"]) > 0.0
    assert 100.0 < float(event["bytes_per_particle"]) < 1e5
    assert float(event["tests_per_contact"]) > 1.0
    assert float(event["copy_bandwidth_GB_s"]) > 0.1
    assert figure.stat().st_size > 1000
