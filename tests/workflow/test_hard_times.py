"""What takes a minute: a workflow that is killed, and points that fail."""

import os
import re
import signal
import subprocess
import sys
import time

import pytest
from digests import digests, known
from workspace import SMOKE, copy_of_project

pytestmark = [pytest.mark.workflow, pytest.mark.thorough]
KNOWN = known()
TARGET = "results/smoke/figures/virial_discs.png"


def test_a_workflow_that_is_killed_goes_on_to_the_same_bits(tmp_path):
    workspace = copy_of_project(tmp_path)
    command = [sys.executable, "-m", "snakemake", "--cores", "2", *SMOKE, "--", TARGET]
    environment = {**os.environ, "PYTHONPATH": str(workspace.path / "src")}
    process = subprocess.Popen(
        command, cwd=workspace.path, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        start_new_session=True,
    )  # fmt: skip
    deadline = time.monotonic() + 300
    points = workspace.path / "results/smoke/points/virial_discs"
    while not list(points.glob("*")) and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.02)
    assert process.poll() is None
    os.killpg(process.pid, signal.SIGKILL)  # Snakemake and its jobs, as when a machine stops
    process.wait()
    assert not (workspace.path / TARGET).exists()
    assert workspace.snakemake("--unlock", *SMOKE).returncode == 0
    done = workspace.snakemake("--cores", "2", *SMOKE, "--", TARGET)
    assert done.returncode == 0, done.stdout[-5000:]
    made = digests(workspace.path / "results/smoke/points")
    assert made and made == {name: KNOWN[name] for name in made}
    assert not list(workspace.path.rglob("*.partial"))


def test_a_point_that_fails_is_named_at_the_end_with_its_log_and_the_rest_is_finished(tmp_path):
    workspace = copy_of_project(tmp_path)
    bad = tmp_path / "bad.yaml"
    bad.write_text(
        "experiments: {virial_discs: {point: {arrangement: random}, grid: {packing_fraction: [0.1, 0.6]}}}"
    )
    done = workspace.snakemake("--cores", "2", *SMOKE, str(bad), "--", TARGET)
    assert done.returncode != 0
    end = done.stdout[-3000:]
    assert re.search(r"virial_discs/packing_fraction=0\.6", end)
    assert "results/smoke/logs/simulate/virial_discs/packing_fraction=0.6.log" in end
    assert "does not fit by random insertion" in done.stdout
    points = workspace.path / "results/smoke/points/virial_discs"
    whole = [path.name for path in points.iterdir() if path.suffix != ".partial"]
    assert whole == ["packing_fraction=0.1"]
