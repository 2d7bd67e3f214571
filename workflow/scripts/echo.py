"""Loschmidt's echoes at one point."""

from _job import job

with job(snakemake):
    from gaspart.kernels.numba_loading import load_numba

    load_numba(ours=True)
    from gaspart.engines import engine_from_dict
    from gaspart.experiments.jobs.echo import echo
    from gaspart.files import whole_file
    from gaspart.scene.scene import Scene

    recipe = snakemake.params.recipe
    dataset = echo(
        Scene.from_dict(recipe["scene"]),
        engine_from_dict(recipe["engine"]),
        seeds=[tuple(seed) for seed in recipe["seeds"]],
        equilibration=recipe["equilibration"],
        interval=recipe["interval"],
        samples=recipe["samples"],
    )
    with whole_file(snakemake.output[0]) as partial:
        dataset.to_netcdf(partial)
