#!/usr/bin/env bash
# Ten thousand short points in few cluster jobs: each takes its share of them, and runs as many at a time as it has
# cores. From the folder of the project, with .venv active and the same arguments for Snakemake each time:
#
#   snakemake --cores all --until warm -- points                                             compile the kernels, once
#   sbatch --array=1-20 --cpus-per-task=16 --mem=16G --time=4:00:00 profiles/slurm/share.sh  simulate, in 20 jobs
#   snakemake --cores all                                                                    measure, judge and draw
#
# A point that fails is named at the end of its job's output, and the rest is finished. After a kill, the same again.
# (Snakemake's own groups, --group-components, start Snakemake anew for each point, and end at the first that fails.)
set -euo pipefail
export GASPART_SHARE="$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT"
python -m snakemake --nolock --cores "$SLURM_CPUS_PER_TASK" "$@" -- points
