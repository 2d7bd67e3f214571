"""The cost of each feature of a scene relative to the plain scene, and that of absent features."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.experiments.price.stripped import instructions
from gaspart.experiments.shared.timings import per_event
from gaspart.planning import grid
from gaspart.scene.scene import Scene

PLAIN = "plain"
WORK = ("pair_tests", "box_visits", "crossings")


def price_of_features(points: list[grid.Point], settings: dict) -> xr.Dataset:
    """Costs per event (a collision or a hit at a wall), and over those of the same engine's plain scene.

    settings: `count_instructions`, whether to compare those of compiled kernels with those of kernels whose
    source lacks the features.

    Over point: engine, feature (which the plain scene lacks), seconds per event with
    seconds_error, `ratio` over the plain one's and its error, counted `pair_tests`, `box_visits` and
    `crossings` per event. Over kernel, if counted: engine's name, `instructions`, and `stripped`.

    Raises ValueError if an engine has no plain point.
    """
    rows = [_row(point) for point in points]
    plain = {row["engine"]: row for row in rows if row["feature"] == PLAIN}
    for row in rows:
        if row["engine"] not in plain:
            raise ValueError(f"no plain scene with engine {row['engine']}")
        own, other = row, plain[row["engine"]]
        row["ratio"] = own["seconds"] / other["seconds"]
        relative = [one["seconds_error"] / one["seconds"] for one in (own, other)]
        row["ratio_error"] = 0.0 if own is other else row["ratio"] * float(np.hypot(*relative))
    dataset = xr.Dataset({name: ("point", [row[name] for row in rows]) for name in rows[0]})
    if settings["count_instructions"]:
        counted = instructions()
        dataset = dataset.assign_coords(kernel=list(counted)).assign(
            instructions=("kernel", [own for own, _ in counted.values()]),
            stripped=("kernel", [bare for _, bare in counted.values()]),
        )
    return dataset


def _row(point: grid.Point) -> dict:
    with xr.open_dataset(point.path) as run:
        costs = per_event(run).isel(partition=0)
        engine, recorded = run.attrs["engine"], bool(run.attrs["recorded"])
    named = ("seconds", "seconds_error", *WORK)
    return {
        "engine": engine,
        "feature": _feature(grid.scene(point), recorded),
        **{name: float(costs[name]) for name in named},
    }


def _feature(scene: Scene, recorded: bool) -> str:
    """The feature of a scene that a plain periodic gas of equal spheres lacks."""
    has = {
        "recording": recorded,
        "gravity": scene.gravity is not None,
        "walls": "wall" in scene.container.boundary,
        "spin": scene.rough,
        "two masses": len({kind.mass for kind in scene.species}) > 1,
    }
    return next((name for name, there in has.items() if there), PLAIN)
