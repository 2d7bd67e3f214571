"""Points whose runs are made in a test, by the job of the workflow."""

from pathlib import Path

from gaspart.reproduction.jobs.simulate import arguments, simulate
from gaspart.reproduction.points.point import Point


def simulated(point):
    """The point, with its runs."""
    simulate(Path(point.path), **arguments(point))
    return point


def made(tmp_path, name, scene, **settings):
    """A point of a scene file, with its runs."""
    scene.to_file(tmp_path / f"{name}.yaml")
    settings = {"scene": str(tmp_path / f"{name}.yaml"), "replicas": 4} | settings
    return simulated(Point(name, "single", "simulate", settings, str(tmp_path), 1))
