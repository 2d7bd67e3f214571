"""As many bodies as find room, or as large as they grow, at one point."""

from _job import job

with job(snakemake):
    from gaspart.kernels.numba_loading import load_numba

    load_numba(ours=True)
    from gaspart.experiments.jobs.pack import pack
    from gaspart.files import whole_file
    from gaspart.scene.scene import Scene

    recipe = snakemake.params.recipe
    seeds = [tuple(seed) for seed in recipe["seeds"]]
    dataset = pack(Scene.from_dict(recipe["scene"]), recipe["attempts"], seeds)
    with whole_file(snakemake.output[0]) as partial:
        dataset.to_netcdf(partial)
