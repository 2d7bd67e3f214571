"""The workflow through a real Slurm: the same bits, though the node is lost in the middle of a job."""

import json
import subprocess
import threading
import time
from pathlib import Path

import pytest
from cluster import cluster, told, why_not
from digests import digests
from workspace import SMOKE

pytestmark = [
    pytest.mark.workflow,
    pytest.mark.thorough,
    pytest.mark.skipif(why_not() is not None, reason=str(why_not())),
]
EXPERIMENT = "virial_discs"
PROFILE = ["--workflow-profile", "profiles/slurm", "--slurm-init-seconds-before-status-checks", "3"]


def lose_the_node_once(node, lost, over):
    """When a simulation runs, take its node away, and bring it back."""
    while not over.is_set():
        for job in told("squeue", "--noheader", "--states=running", "--format=%i %k").splitlines():
            if "simulate" in job:
                told("scontrol", "update", f"nodename={node}", "state=down", "reason=test")
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
        done = fresh.snakemake(*PROFILE, *SMOKE, "--", f"results/figures/{EXPERIMENT}.png")
        over.set()
        thief.join()
    assert done.returncode == 0, done.stdout[-5000:]
    assert lost, "no simulation was seen running"
    known = json.loads((Path(__file__).parent / "digests.json").read_text())
    made = digests(fresh.path / "results/smoke/points")
    assert made and made == {name: known[name] for name in made}
    assert all(name.startswith(EXPERIMENT) for name in made)
