"""One point of a grid: a trajectory for each of its replicas."""

from pathlib import Path

from _job import job

with job(snakemake):
    from gaspart.kernels.compile.loading import load_numba

    load_numba(ours=True)
    from gaspart.reproduction.jobs import simulate

    simulate.run(snakemake.params.parameters, Path(snakemake.output[0]))
