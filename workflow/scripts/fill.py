"""Random insertion at one point: failed attempts against bodies placed."""

from _job import job

with job(snakemake):
    from gaspart.kernels.numba_loading import load_numba

    load_numba(ours=True)
    from gaspart.experiments.jobs.fill import fill
    from gaspart.files import whole_file
    from gaspart.scene.scene import Scene

    recipe = snakemake.params.recipe
    seeds = [tuple(seed) for seed in recipe["seeds"]]
    dataset = fill(Scene.from_dict(recipe["scene"]), recipe["attempts"], seeds)
    with whole_file(snakemake.output[0]) as partial:
        dataset.to_netcdf(partial)
