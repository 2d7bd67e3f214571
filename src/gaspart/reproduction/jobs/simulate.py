"""Trajectories, one for each replica of a point.

Planning reads this module, so slow imports are made inside functions.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from gaspart.engines import engine_from_dict, engine_to_dict
from gaspart.kinds import Kind, count, flag
from gaspart.reproduction.jobs.replicas import write_replicas
from gaspart.reproduction.jobs.stretches import EQUILIBRATION

if TYPE_CHECKING:
    from gaspart.engines import Engine
    from gaspart.reproduction.points.point import Point
    from gaspart.trajectory.recipe import Recipe

RESULT = "trajectories"
KEYS: dict[str, Kind] = {
    "equilibration": EQUILIBRATION,
    "samples": count(
        "number of intervals into which the length is divided, with a frame at the end of each", default=1
    ),
    "frames": count(
        "with `lags`: keep the frames at the ends of so many equal parts of the length too, which the "
        "uncertainties of transport coefficients need; a divisor of `samples`",
        default=None,
    ),
    "displacements": flag("keep displacements in float64, for mean-squared displacements", default=False),
    "lags": count(
        "accumulate time correlations of all samples up to so many intervals apart, but at most half the "
        "length, and keep the first and the last frame only, or `frames` of them, of a sheared gas all; with "
        "`displacements` of these too",
        default=None,
    ),
    "stress": flag(
        "with `lags`: correlate the stress tensor and the heat flux instead of velocities", default=False
    ),
    "pairs": flag("count the collisions of each pair of species", default=False),
    "follow": count(
        "keep only the first so many particles (single `particles` come first, then `species`); counters and "
        "energies are those of all",
        default=None,
    ),
}


def engines(point: Point) -> list[Engine]:
    """The engine of the trajectories."""
    return [point.engine]


def parameters(point: Point) -> dict:
    """The arguments of `gaspart.run`, in plain values. Raises SceneError."""
    times, follow = point.schedule, point.settings.get("follow")
    if follow is not None and follow > point.extents.particles:
        raise point.refused("follow", f"there are {point.extents.particles} particles")
    correlations = None
    if "lags" in point.settings:
        lags = min(point.settings["lags"], (times.samples + 1) // 2)
        correlations = {"interval": times.sample_interval, "lags": lags, "start": times.equilibration}
        correlations |= {"stress": True} if point.settings.get("stress") else {}
    return {
        "engine": engine_to_dict(point.engine),
        "duration": times.duration,
        "sample_interval": _frame_interval(point),
        "displacements": point.settings.get("displacements", False),
        "follow": follow,
        "correlations": correlations,
        **({"pairs": True} if point.settings.get("pairs") else {}),
    }


def _frame_interval(point: Point) -> float:
    """The time between two frames that are kept. Raises SceneError."""
    times, settings = point.schedule, point.settings
    if "frames" in settings:
        if "lags" not in settings:
            raise point.refused("frames", "has a meaning with lags only; without them there are samples")
        return times.sample_interval * times.samples_per_frame
    only_ends = "lags" in settings and point.scene.shear_rate is None
    return times.duration if only_ends else times.sample_interval


def run(parameters: dict, folder: Path) -> None:
    """Write a trajectory for each seed; see `write_replicas`."""
    write_replicas(record, parameters, folder, print)


def record(parameters: dict, seed: tuple[int, ...], path: Path, overwrite: bool) -> None:
    """Make one trajectory, or continue it, or find it complete."""
    from gaspart.trajectory import run as trajectory

    trajectory.record(recipe(parameters, seed), path, trajectory.Manner(overwrite=overwrite))


def recipe(parameters: dict, seed: tuple[int, ...]) -> Recipe:
    """The recipe of one trajectory. Raises SceneError for what cannot be run."""
    from gaspart.scene.scene import Scene
    from gaspart.trajectory.correlator import Correlations
    from gaspart.trajectory.recipe import Recipe

    return Recipe(
        Scene.from_dict(parameters["scene"]),
        engine_from_dict(parameters["engine"]),
        seed=seed,
        duration=parameters["duration"],
        sample_interval=parameters["sample_interval"],
        displacements=parameters["displacements"],
        follow=parameters["follow"],
        correlations=parameters["correlations"] and Correlations(**parameters["correlations"]),
        pairs=parameters.get("pairs", False),
    )
