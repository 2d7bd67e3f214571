"""One point of a grid whose result is one data set: costs, comparisons, echoes, insertions, packings."""

from _job import function, job

with job(snakemake):
    from gaspart.kernels.compile.loading import load_numba

    load_numba(ours=True)
    from gaspart.files import whole_file

    run = function(f"gaspart.reproduction.jobs.{snakemake.params.job}", "run")
    data = run(snakemake.params.parameters)
    with whole_file(snakemake.output[0]) as partial:
        data.write(partial)
