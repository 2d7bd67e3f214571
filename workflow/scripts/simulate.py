"""One point of a grid: a trajectory for each of its replicas."""

from pathlib import Path

from _job import job

with job(snakemake):
    from gaspart.kernels.compile.loading import load_numba

    load_numba(ours=True)
    from gaspart.engines import engine_from_dict
    from gaspart.scene.scene import Scene
    from gaspart.trajectory.correlator import Correlations
    from gaspart.trajectory.run import run

    recipe = snakemake.params.recipe
    # Beside the declared output, which Snakemake deletes before a rerun: an interrupted run resumes here.
    partial = Path(f"{snakemake.output[0]}.partial")
    partial.mkdir(parents=True, exist_ok=True)
    paths = [partial / f"replica-{replica}.nc" for replica in range(len(recipe["seeds"]))]
    for path, seed in zip(paths, recipe["seeds"], strict=True):
        print(f"{path}: seed {seed}, {recipe['duration']:g} units of time")
        run(
            Scene.from_dict(recipe["scene"]),
            engine_from_dict(recipe["engine"]),
            seed=tuple(seed),
            duration=recipe["duration"],
            sample_interval=recipe["sample_interval"],
            path=path,
            displacements=recipe["displacements"],
            follow=recipe["follow"],
            correlations=recipe["correlations"] and Correlations(**recipe["correlations"]),
            overwrite=True,  # the remainder of another recipe
        )
    for leftover in set(partial.iterdir()) - set(paths):
        leftover.unlink()
    partial.rename(snakemake.output[0])
