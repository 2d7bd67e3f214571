"""A disk that is really full, for a run and for the workflow: one clear line, and later the same bits."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from digests import digests, known
from machine import OWN_DISKS, why_not
from workspace import SMOKE, copy_of_project

pytestmark = [
    pytest.mark.workflow,
    pytest.mark.thorough,
    pytest.mark.skipif(why_not(OWN_DISKS) is not None, reason=str(why_not(OWN_DISKS))),
]
KNOWN = known()
TARGET = "results/smoke/figures/virial_discs.png"
# A small disk, full but for some kilobytes; then the same command again when there is room.
TWICE = """
set -e
disk=$1; free=$2; out=$3; shift 3
mount -t tmpfs -o size=64m none "$disk"
head -c "$((64 * 1024 - free))k" /dev/zero > "$disk/filler"
code=0; "$@" > "$out/full" 2>&1 < /dev/null || code=$?
echo "exit code $code" >> "$out/full"
cp -R "$disk" "$out/left"; rm "$out/left/filler" "$disk/filler"
code=0; "$@" > "$out/empty" 2>&1 < /dev/null || code=$?
echo "exit code $code" >> "$out/empty"
cp -R "$disk" "$out/made"
"""


def twice(disk, free, out, command, source):
    """What a command says on a disk with `free` kB of room, and then with more; files go to `out`."""
    disk.mkdir()
    out.mkdir()
    script = [*OWN_DISKS, "sh", "-c", TWICE, "sh", str(disk), str(free), str(out), *command]
    environment = {**os.environ, "PYTHONPATH": str(source)}
    subprocess.run(script, cwd=disk.parent, env=environment, check=True, timeout=600)
    return (out / "full").read_text(), (out / "empty").read_text()


def test_a_run_says_so_and_goes_on_to_the_same_bits(tmp_path):
    (tmp_path / "scene.yaml").write_text(
        "container: {lengths: [40.0, 40.0], boundary: periodic}\n"
        "species: [{count: 400, radius: 0.5, temperature: 1.0}]\n"
    )
    run = [sys.executable, "-m", "gaspart", "run", str(tmp_path / "scene.yaml")]
    run += ["--duration", "100", "--sample-interval", "1", "--seed", "1", "-o"]
    source = Path(__file__).parents[2] / "src"
    full, empty = twice(tmp_path / "disk", 256, tmp_path / "out", [*run, "disk/run.nc"], source)
    printed, code = full.splitlines()[-2:]
    assert code == "exit code 2"
    assert printed.startswith("gaspart: error: ") and "cannot be written: No space left on device" in printed
    assert "Traceback" not in full
    assert sorted(path.name for path in (tmp_path / "out/left").iterdir()) == ["run.nc.partial"]
    assert empty.endswith("exit code 0\n")
    reference = tmp_path / "reference.nc"
    subprocess.run([*run, str(reference)], env={**os.environ, "PYTHONPATH": str(source)}, check=True)
    assert (tmp_path / "out/made/run.nc").read_bytes() == reference.read_bytes()


def test_the_workflow_says_so_and_goes_on_to_the_same_bits(tmp_path):
    workspace = copy_of_project(tmp_path)
    command = [sys.executable, "-m", "snakemake", "--cores", "2", *SMOKE, "--", TARGET]
    full, empty = twice(tmp_path / "results", 150, tmp_path / "out", command, workspace.path / "src")
    assert "exit code 1" in full
    lines = [line for line in full.splitlines() if line.startswith("gaspart: simulate")]
    assert lines and all("No space left on device" in line for line in lines)
    assert "Traceback" not in full
    assert not (tmp_path / "out/left/smoke/figures").exists()
    assert empty.endswith("exit code 0\n"), empty[-5000:]
    made = digests(tmp_path / "out/made/smoke/points")
    assert made and made == {name: KNOWN[name] for name in made}
    assert not list((tmp_path / "out/made").rglob("*.partial"))
