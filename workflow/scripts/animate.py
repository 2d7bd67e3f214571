"""One film of a scene, and the picture that stands for it until it is played."""

from _job import job

with job(snakemake):
    from gaspart.rendering.films import film, poster

    output = snakemake.output
    film(snakemake.params.trajectory, output.film, **snakemake.params.settings, overwrite=True)
    poster(output.film, output.poster)
