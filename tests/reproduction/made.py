"""Points whose runs are made in a test."""

import gaspart as gp
from gaspart.reproduction.points.point import Point


def made(tmp_path, name, scene, **settings):
    """A point of a scene file, with its runs."""
    scene.to_file(tmp_path / f"{name}.yaml")
    settings = {"scene": str(tmp_path / f"{name}.yaml"), "replicas": 4} | settings
    point = Point(name, "single", "simulate", settings, str(tmp_path), 1)
    recipe = point.parameters
    (tmp_path / name / "single").mkdir(parents=True)
    for seed, path in zip(recipe["seeds"], point.replica_paths, strict=True):
        gp.run(
            point.scene,
            point.engine,
            seed=tuple(seed),
            duration=recipe["duration"],
            sample_interval=recipe["sample_interval"],
            path=path,
        )
    return point
