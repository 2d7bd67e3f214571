"""Replicas: an observable of several independent runs of one scene, with the scatter of the runs."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.measuring import measure
from gaspart.analysis.observable import Observable
from gaspart.analysis.run import Source
from gaspart.analysis.statistics import means_of
from gaspart.errors import SceneError
from gaspart.simulation import Simulation
from gaspart.trajectory.reading import open_trajectory
from gaspart.yaml_text import dump_yaml


def replicas(
    name: str, sources: Sequence[Source], start: float | None = None, **selection: Any
) -> Observable:
    """An observable, by its name as of `gaspart measure`, as the mean over independent runs of one scene.

    sources: at least two trajectories, by their paths or open, or simulations, with different seeds; start
    and `selection` as of the observable's function. The uncertainty is that of the mean by the scatter of the
    runs, which needs no assumption about correlations within a run, with one degree of freedom less than
    there are runs (`freedom`). The variable with the suffix _replicas has the value of each (replica, ...).
    Theory is the mean of theirs.

    Raises SceneError for fewer than two runs, runs of different scenes or engines, two of the same seed,
    curves at different places, and as the observable's function does.
    """
    if isinstance(sources, str | Path | Simulation | xr.Dataset) or len(sources) < 2:
        raise SceneError("sources", sources, "must be a list of two runs or more")
    found, seeds, scenes = [], [], set()
    for source in sources:
        with open_trajectory(source) if isinstance(source, str | Path) else nullcontext(source) as run:
            scene, seed = _recipe(run)
            scenes.add(scene)
            seeds.append(seed)
            found.append(measure(name, run, start, **selection))
    if len(scenes) > 1:
        raise SceneError("sources", len(scenes), "different scenes or engines: replicas differ in their seed")
    for seed in seeds:
        if seeds.count(seed) > 1:
            raise SceneError("seed", seed, "is that of two runs, which are the same and have no scatter")
    return _mean(found)


def _recipe(run: Any) -> tuple[str, str]:
    """Scene with engine, and seed, of an open trajectory or a simulation, as texts."""
    if isinstance(run, Simulation):
        return f"{dump_yaml(run.scene.to_dict())}{run.engine}", str(run.seed)
    if not isinstance(run, xr.Dataset) or not {"scene", "engine", "seed"} <= set(run.attrs):
        raise SceneError("sources", type(run).__name__, "must be trajectories, their paths or simulations")
    return f"{run.attrs['scene']}{run.attrs['engine']}", str(run.attrs["seed"])


def _mean(found: list[Observable]) -> Observable:
    """The mean of independent measurements of one observable."""
    first, quantity = found[0], str(found[0].attrs["quantity"])
    dims = first.estimate.dims
    for one in found[1:]:
        same = one.estimate.shape == first.estimate.shape
        if not same or any(not np.array_equal(one[dim], first[dim]) for dim in dims if dim in first.coords):
            rule = "have their values at different places: let all have one sample_interval and duration"
            raise SceneError("sources", quantity, rule)
    each = np.array([one.estimate.values for one in found])
    values, errors = means_of(each)
    parts = {"": values, "_error": errors}
    if all(one.theory is not None for one in found):
        for part in ("_theory", "_theory_error"):
            parts[part] = np.mean([one[quantity + part].values for one in found], axis=0)
    coords = {dim: first.coords[dim] for dim in dims if dim in first.coords}
    data = {key: (dims, part, first[quantity + key].attrs) for key, part in parts.items()}
    attrs = {key: text for key, text in first.attrs.items() if key in ("quantity", "source")}
    result = Observable({quantity + key: value for key, value in data.items()}, coords, attrs)
    result[f"{quantity}_replicas"] = (("replica", *dims), each, first.estimate.attrs)
    result.attrs["freedom"] = len(found) - 1
    if not dims:  # what a plot of a scalar shows
        about = {"long_name": "replica", "units": "1"}
        result = result.assign_coords(time=("time", np.arange(len(found)), about))
        result["stretches"] = ("time", each, {**first.estimate.attrs, "long_name": "replicas"})
    return result
