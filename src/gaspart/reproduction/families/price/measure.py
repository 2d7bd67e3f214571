"""Relative cost of each feature of a scene, and of absent features.

Each job times a scene and the scene without the feature alternately, A B B A, so that disturbances of the
machine affect both. Several jobs of one feature differ in their equilibration: their scatter is the
uncertainty.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.reproduction.families.shared.timings import log_ratios, per_event, ratio_of_jobs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table
from gaspart.scene.scene import Scene

PLAIN = "plain"
FEATURES = {"gravity": "gravity", "roughness": "spin"}
"""Features of `scene.features` that are timed, and their names in the figure."""
WORK = ("pair_tests", "box_visits", "crossings")


def price_of_features(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure costs per event (a collision or a hit at a wall), absolute and relative.

    They are relative to the scene without the feature, timed in the same job.

    Over point (a feature with an engine) are engine, feature (which the other scene lacks), seconds per
    event, `ratio` over the other one's in the same jobs with its error, which is the jobs' scatter, and the
    degrees of freedom of that; counted `pair_tests`, `box_visits` and `crossings` per event. The plain scene
    compared with itself has the ratio 1. Over kernel, if a point counts them: engine's name, `instructions`,
    and `stripped`, the instructions of a kernel whose source lacks the features.
    """
    groups: dict[tuple, list[dict]] = {}
    for job in (_job(point) for point in points if point.job == "measure_cost"):
        groups.setdefault((job["engine"], job["feature"]), []).append(job)
    dataset = table("point", list(groups.values()), _row)
    for point in points:
        if point.job == "count_instructions":
            dataset = dataset.merge(
                xr.load_dataset(point.path).rename(engine="kernel"), join="outer", compat="no_conflicts"
            )
    return dataset


def _row(jobs: list[dict]) -> dict:
    """Return the row of several jobs of one feature; NaN errors for a single one."""
    return {
        "engine": jobs[0]["engine"],
        "feature": jobs[0]["feature"],
        **{name: float(np.mean([job[name] for job in jobs])) for name in ("seconds", *WORK)},
        "ratio": ratio_of_jobs([job["log_ratio"] for job in jobs]),
    }


def _job(point: Point) -> dict:
    """Return the costs per event of one job, and its log ratio of times.

    The ratio is the mean over its repeats of ln of the time per event relative to the scene without the
    feature, timed next to it.
    """
    with xr.open_dataset(point.path) as run:
        costs = per_event(run)
        engine, extras = run.attrs["engine"], run.attrs["extras"].split()
        log_ratio = float(log_ratios(run, costs["events"].values)[0])
    own = costs.isel(partition=0)
    return {
        "engine": engine,
        "feature": _feature(point.scene, extras),
        "log_ratio": log_ratio,
        **{name: float(own[name]) for name in ("seconds", *WORK)},
    }


def _feature(scene: Scene, extras: list[str]) -> str:
    """Return the feature of a scene that a plain periodic gas of equal spheres lacks."""
    has = {
        "recording": "record_events" in extras,
        "stress": "stress" in extras,
        **{name: feature in scene.features for feature, name in FEATURES.items()},
        "walls": bool(scene.container.walls),
        "two masses": len({kind.mass for kind in scene.species}) > 1,
    }
    return next((name for name, present in has.items() if present), PLAIN)
