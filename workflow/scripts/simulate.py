"""One point of a grid: a trajectory for each of its replicas."""

from pathlib import Path

from _job import function, job

with job(snakemake):
    from gaspart.kernels.compile.loading import load_numba

    load_numba(ours=True)
    run = function(f"gaspart.reproduction.jobs.{snakemake.params.job}", "run")
    run(snakemake.params.parameters, Path(snakemake.output[0]))
