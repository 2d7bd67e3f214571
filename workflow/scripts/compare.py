"""What time stepping gets wrong at one point, beside exact runs from the same states."""

from _job import job

with job(snakemake):
    from gaspart.kernels.numba_loading import load_numba

    load_numba(ours=True)
    from gaspart.engines import engine_from_dict
    from gaspart.experiments.jobs.compare import compare
    from gaspart.files import whole_file
    from gaspart.scene.scene import Scene

    recipe = snakemake.params.recipe
    dataset = compare(
        Scene.from_dict(recipe["scene"]),
        [engine_from_dict(engine) for engine in recipe["engines"]],
        seed=tuple(recipe["seeds"][0]),
        equilibration=recipe["equilibration"],
        stretch=recipe["stretch"],
        snapshots=recipe["repeats"],
    )
    with whole_file(snakemake.output[0]) as partial:
        dataset.to_netcdf(partial)
