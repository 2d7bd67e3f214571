"""Trajectories, one for each replica of a point.

The planning of a workflow imports this module, so slow imports are made inside functions.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaspart.errors import SceneError
from gaspart.keys import Kind, count, describe, flag, positive
from gaspart.reproduction.jobs.data import DIVIDED, EQUILIBRATION_KEY, kept_path
from gaspart.reproduction.jobs.replicas import write_replicas
from gaspart.trajectory.run_options import OPTIONS, contents_of, recipe_fields

if TYPE_CHECKING:
    from gaspart.engines import Engine
    from gaspart.reproduction.points.point import Point
    from gaspart.trajectory.recipe import Recipe
    from gaspart.trajectory.recording import Progress

RESULT = "trajectories"
KEYS: dict[str, Kind] = {
    "equilibration": EQUILIBRATION_KEY,
    "samples": count(
        "number of intervals into which the length is divided, with a frame at the end of each; with `until` "
        "by default one for each collision of a particle",
        default=1,
    ),
    "until": describe(
        {
            "type": "object",
            "minProperties": 1,
            "additionalProperties": positive("", exclusiveMaximum=1),
        },
        "end the run when these observables have this relative standard error, such as `{Z: 1e-3}` or "
        "`{'pressure:x low': 0.01}`; the length is then the largest, and the equilibration by default a "
        "quarter of the run",
        default=None,
    ),
    "frames": count(
        "with `lags`: keep the frames at the ends of so many equal parts of the length too, which the "
        "uncertainties of transport coefficients need; a divisor of `samples`",
        default=None,
    ),
    "lags": count(
        "accumulate time correlations of all samples up to so many intervals apart, but at most half the "
        "length, and keep the first and the last frame only, or `frames` of them, of a sheared gas all; with "
        "`displacements` of these too",
        default=None,
    ),
    "stress": flag(
        "with `lags`: correlate the stress tensor and the heat flux instead of velocities", default=False
    ),
    **OPTIONS,
}
_NOT_WITH_UNTIL = ("lags", "frames", "stress")
EXAMINER = "gaspart.accuracy.reached"
"""Module that decides when a run with `until` ends."""


def engines(point: Point) -> list[Engine]:
    """Return the engine of the trajectories."""
    return [point.engine]


def modules(point: Point) -> list[str]:
    """Return the modules that this module imports by name. Only runs with `until` depend on the analysis."""
    return [EXAMINER] if "until" in point.settings else []


def arguments(point: Point) -> dict:
    """Return the arguments of `simulate`."""
    times, settings = point.schedule, point.settings
    common = {"scene": point.scene, "engine": point.engine, "seeds": point.seeds}
    options = {key: settings[key] for key in OPTIONS if settings.get(key)}
    try:
        contents_of(options).check_scene(point.scene, "until" in settings)
    except SceneError as error:
        raise error.inside(f"experiments.{point.experiment}") from None
    if "until" in settings:
        for key in _NOT_WITH_UNTIL:
            if settings.get(key):
                raise point.make_error(key, "has no meaning with until")
        return {**common, **options, **point.ending}
    correlations = None
    if "lags" in settings:
        whole = settings.get(DIVIDED, times.samples)
        lags = min(settings["lags"], (whole + 1) // 2)
        correlations = {"interval": times.sample_interval, "lags": lags, "start": times.equilibration}
        correlations |= {"stress": True} if settings.get("stress") else {}
    return {
        **common,
        "duration": times.duration,
        "sample_interval": _frame_interval(point),
        "displacements": False,
        "follow": None,
        "correlations": correlations,
        **options,
    }


def _frame_interval(point: Point) -> float:
    """Compute the time between two stored frames."""
    times, settings = point.schedule, point.settings
    if "frames" in settings:
        if "lags" not in settings:
            raise point.make_error("frames", "has a meaning with lags only; without them there are samples")
        return times.sample_interval * times.samples_per_frame
    only_ends = "lags" in settings and point.scene.shear_rate is None
    return times.duration if only_ends else times.sample_interval


def simulate(folder: Path, **arguments: Any) -> None:
    """Write a trajectory for each seed; see `write_replicas`. The other arguments are passed to `recipes`."""
    write_replicas(record, recipes(**arguments), folder, print, kept=kept_path(folder))


def record(recipe: Recipe, path: Path, overwrite: bool, progress: Progress | None = None) -> None:
    """Make, continue, or verify a trajectory. A complete trajectory is left unchanged. The final state is
    stored, from which a longer run continues.
    """
    from gaspart.trajectory import run as trajectory

    examiner = import_module(EXAMINER).Examiner() if recipe.until else None
    options = trajectory.WriteOptions(
        progress=progress, overwrite=overwrite, examiner=examiner, keep_checkpoint=True
    )
    trajectory.record(recipe, path, options)


def recipes(seeds: Sequence[tuple[int, ...]], **settings: Any) -> list[Recipe]:
    """Return the recipe of each replica. The settings are arguments of `recipe_fields`. Raises SceneError for
    settings that cannot be run.
    """
    from gaspart.trajectory.recipe import Recipe

    return [Recipe(seed=seed, **recipe_fields(settings)) for seed in seeds]
