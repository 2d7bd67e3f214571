"""One figure's numbers against theory: its claims and their verdicts."""

from _job import job

with job(snakemake):
    import xarray as xr

    from gaspart.files import whole_file
    from gaspart.reproduction import claims
    from gaspart.reproduction.families.registry import function

    dataset = xr.load_dataset(snakemake.input.dataset)
    figure = snakemake.wildcards.figure
    # What the config states, of a figure that has its claims there.
    judged = function(snakemake.params.module, snakemake.params.function, "claims")(
        dataset, *snakemake.params.stated
    )
    with whole_file(snakemake.output[0]) as partial:
        claims.write(partial, figure, judged)
