#!/usr/bin/env bash
# In Snakemake, a parameter whose function takes threads (or input, output) is no reason to run a job again.
#
# Usual guess: with --rerun-triggers params, a job runs again when any of its parameters has changed.
#
# What happens: parameters that are made with input, output, resources or threads count as derived and are
# not compared. Whoever adds `threads` to a lambda loses the trigger, and keeps old results after a change
# of the config.
#
# Way out: functions of parameters take wildcards alone.
#
# Seen with snakemake 9.27.1: jobs to run after the number was changed from 1 to 2:
#
#     lambda wildcards: 1
#     lambda wildcards, threads: 0
set -euo pipefail

packages=(snakemake==9.27.1)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder"
"$folder/bin/python" -m pip --disable-pip-version-check install --quiet --no-compile "${packages[@]}"
cd "$folder"
PATH=$folder/bin:$PATH python - <<'PYTHON'
import subprocess
import sys

found = {}
for arguments in ("wildcards", "wildcards, threads"):
    with open("Snakefile", "w") as file:
        file.write("rule a:\n    output:\n        'a.txt',\n    params:\n")
        file.write(f"        n=lambda {arguments}: config['number'],\n")
        file.write("    shell:\n        'echo {params.n} > {output}'\n")
    snakemake = [sys.executable, "-m", "snakemake", "a.txt", "--cores", "1", "--rerun-triggers", "params"]
    made = {"capture_output": True, "text": True}
    subprocess.run([*snakemake, "--forceall", "--config", "number=1"], check=True, **made)
    plan = subprocess.run([*snakemake, "--dry-run", "--config", "number=2"], check=True, **made)
    found[arguments] = int("Nothing to be done" not in plan.stdout + plan.stderr)
    print(f"lambda {arguments}: {found[arguments]}")
assert found == {"wildcards": 1, "wildcards, threads": 0}, "the behaviour has changed"
PYTHON
