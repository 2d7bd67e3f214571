"""One figure's numbers against theory: its claims and their verdicts."""

from _job import function, job

with job(snakemake):
    import xarray as xr

    from gaspart.files import whole_file
    from gaspart.reproduction import claims

    dataset = xr.load_dataset(snakemake.input.dataset)
    figure = snakemake.wildcards.figure
    judged = function(f"gaspart.reproduction.families.{snakemake.params.family}.claims", figure)(dataset)
    with whole_file(snakemake.output[0]) as partial:
        claims.write(partial, figure, judged)
