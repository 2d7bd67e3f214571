#!/usr/bin/env bash
# Snakemake's benchmark samples the processor time of a job, later only every half minute, and never at its end.
#
# Usual guess: cpu_time of a benchmark file is the processor time that the job used.
#
# What happens: it is the time at the last sample. Samples are dense at first and 30 s apart later, so that a
# job of a minute or two lacks up to half a minute, and costs added up over a workflow are too low, unevenly.
#
# Way out: let each job record its own resource.getrusage, of itself and its children.
#
# Seen with Snakemake 9.27.1, a job that computes for 75 s:
#
#     used 75.0 s, benchmark 69.0 s
set -euo pipefail

packages=(snakemake==9.27.1)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder"
"$folder/bin/python" -m pip --disable-pip-version-check install --quiet --no-compile "${packages[@]}"
cd "$folder"
PATH=$folder/bin:$PATH python - <<'PYTHON'
import csv
import subprocess
import sys

RULE = """
rule work:
    output: "used.txt"
    benchmark: "work.tsv"
    shell: "{python} work.py > {{output}}"
"""
WORK = """
import time
while time.process_time() < 75.0:
    sum(range(10000))
print(time.process_time())
"""
with open("Snakefile", "w") as file:
    file.write(RULE.format(python=sys.executable))
with open("work.py", "w") as file:
    file.write(WORK)
command = [sys.executable, "-m", "snakemake", "--cores", "1", "--quiet", "all"]
subprocess.run(command, check=True, capture_output=True)
with open("used.txt") as file:
    used = float(file.read())
with open("work.tsv") as file:
    (row,) = csv.DictReader(file, delimiter="\t")
print(f"used {used:.1f} s, benchmark {float(row['cpu_time']):.1f} s")
assert float(row["cpu_time"]) < used - 3.0, "the behaviour has changed"
PYTHON
