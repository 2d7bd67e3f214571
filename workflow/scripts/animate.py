"""One film of a scene, and the picture that stands for it until it is played."""

from pathlib import Path

from _job import job

with job(snakemake):
    from gaspart.rendering.films import film, poster
    from gaspart.reproduction.jobs.replicas import replica_paths

    output = snakemake.output
    (trajectory,) = replica_paths(Path(snakemake.input.trajectories), 1)
    film(trajectory, output.film, **snakemake.params.settings, overwrite=True)
    poster(output.film, output.poster)
