"""One figure, as PNG and SVG."""

from _job import function, job

with job(snakemake):
    import xarray as xr

    from gaspart.rendering import style

    dataset = xr.load_dataset(snakemake.input.dataset)
    with style.applied():
        picture = function(
            f"gaspart.experiments.{snakemake.params.family}.figure", snakemake.wildcards.figure
        )(dataset)
        for path in snakemake.output:
            style.save(picture, path)
