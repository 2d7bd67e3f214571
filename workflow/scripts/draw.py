"""One figure in one layout, in the format of each output; the log states what cannot be read in it."""

from _job import function, job

with job(snakemake):
    import xarray as xr

    from gaspart.rendering import style
    from gaspart.rendering.legibility import flaws

    figure, params = snakemake.wildcards.figure, snakemake.params
    dataset = xr.load_dataset(snakemake.input.dataset)
    with style.applied(params.layout):
        picture = function(f"gaspart.experiments.{params.family}.figure", figure)(dataset)
        for path in snakemake.output:
            style.save(picture, path)
    for flaw in flaws(picture):
        print(f"not legible: {figure}, {params.layout}: {flaw}")
