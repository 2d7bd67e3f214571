"""One film of a scene."""

from _job import job

with job(snakemake):
    from gaspart.rendering.films import film

    film(
        snakemake.params.trajectory,
        snakemake.output[0],
        **snakemake.params.settings,
        overwrite=True,
    )
