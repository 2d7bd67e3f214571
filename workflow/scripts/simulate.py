"""One point of a grid: a trajectory for each of its replicas."""

from pathlib import Path

from _job import function, job

with job(snakemake):
    from gaspart.kernels.compile.cache import load_numba

    load_numba(ours=True)
    # By its name: a simulation depends on what its arguments are, not on how they are written down.
    from_plain = function("gaspart.reproduction.jobs.arguments", "from_plain")
    simulate = function(f"gaspart.reproduction.jobs.{snakemake.params.job}", snakemake.params.job)
    simulate(Path(snakemake.output[0]), **from_plain(snakemake.params.parameters))
