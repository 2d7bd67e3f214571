"""The workflow through a real Slurm: the same bits, though the node is lost in the middle of a job."""

import os
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from cluster import cluster, output_of, why_not
from digests import digests, known
from workspace import SMOKE, copy_of_project, leave_one_figure

pytestmark = [
    pytest.mark.workflow,
    pytest.mark.thorough,
    pytest.mark.skipif(why_not() is not None, reason=str(why_not())),
]
EXPERIMENT = "virial_discs"
KNOWN = known()
PROFILE = ["--workflow-profile", "profiles/slurm", "--slurm-init-seconds-before-status-checks", "3"]


def lose_the_node_once(node, lost, over):
    """When a simulation runs, take its node away, and bring it back."""
    while not over.is_set():
        for job in output_of("squeue", "--noheader", "--states=running", "--format=%i %k").splitlines():
            if "simulate" in job:
                output_of("scontrol", "update", f"nodename={node}", "state=down", "reason=test")
                lost.append(job)
                time.sleep(1.0)
                subprocess.run(["scontrol", "update", f"nodename={node}", "state=resume"], check=False)
                return  # it may have come back by itself
        time.sleep(0.1)


def test_a_grid_through_slurm_ends_in_the_same_bits_though_its_node_is_lost(fresh, tmp_path):
    lost, over = [], threading.Event()
    with cluster(tmp_path) as node:
        thief = threading.Thread(target=lose_the_node_once, args=(node, lost, over))
        thief.start()
        done = fresh.snakemake(*PROFILE, *SMOKE, "--", f"results/smoke/figures/{EXPERIMENT}.png")
        over.set()
        thief.join()
    assert done.returncode == 0, done.stdout[-5000:]
    assert lost, "no simulation was seen running"
    made = digests(fresh.path / "results/smoke/points")
    assert made and made == {name: KNOWN[name] for name in made}
    assert all(name.startswith(EXPERIMENT) for name in made)


def test_many_points_share_few_cluster_jobs_and_one_that_fails_harms_no_other(tmp_path):
    workspace = copy_of_project(tmp_path)
    leave_one_figure(tmp_path, EXPERIMENT, arrangement="random")
    grid = tmp_path / "grid.yaml"
    fractions = [0.05, 0.1, 0.15, 0.2, 0.25, 0.6]
    grid.write_text(f"experiments: {{{EXPERIMENT}: {{grid: {{packing_fraction: {fractions}}}}}}}")
    share = ["--configfile", str(grid)]
    assert workspace.snakemake("--cores", "2", "--until", "warm", *share, "--", "points").returncode == 0
    slurm = tmp_path / "slurm"
    slurm.mkdir()
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "PYTHONPATH": str(tmp_path / "src")}
    batch = ["sbatch", "--wait", "--array=1-2", "--cpus-per-task=1", "profiles/slurm/share.sh", *share]
    with cluster(slurm):
        assert subprocess.run(batch, cwd=tmp_path, env=environment).returncode != 0
    told_by = [file.read_text() for file in sorted(tmp_path.glob("slurm-*.out"))]
    assert len(told_by) == 2  # jobs of the cluster, for six points
    assert "results/logs/simulate/virial_discs/packing_fraction=0.6.log" in told_by[1][-3000:]
    assert "does not fit by random insertion" in told_by[1] and "Error" not in told_by[0]
    points = tmp_path / f"results/smoke/points/{EXPERIMENT}"
    assert {path.name for path in points.iterdir()} >= {f"packing_fraction={eta}" for eta in fractions[:-1]}
    assert workspace.plan(*share, "--", "points") == {"simulate": 1, "points": 1}
