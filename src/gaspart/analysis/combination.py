"""Replicas: an observable averaged over independent runs of a scene, with an error from their scatter."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from gaspart import analysis
from gaspart.analysis.drift import Trend, describe, trends
from gaspart.analysis.observable import Observable
from gaspart.analysis.observables import OBSERVABLES, observable_name
from gaspart.analysis.run import Source, measure_single, until_time
from gaspart.analysis.statistics import means_of
from gaspart.engines import engine_from_dict, engine_to_dict
from gaspart.errors import SceneError, short_repr
from gaspart.scene.scene import Scene
from gaspart.simulation import Simulation
from gaspart.state.optional_tallies import OptionalTally
from gaspart.state.state import by_number
from gaspart.trajectory.reading import open_trajectory
from gaspart.trajectory.run_options import tallies_from_json
from gaspart.yaml_text import parse_yaml

_ROUNDING = 1e-12
"""Relative scatter that rounding causes if the same values are computed in a different order."""


def replicas(
    name: str,
    sources: Sequence[Source],
    start: float | None = None,
    end: float | None = None,
    **selection: Any,
) -> Observable:
    """Measure a named observable as the mean over independent runs of one scene.

    The uncertainty is the standard error of the mean, computed from the scatter between runs. It requires no
    assumption about correlations within a run. Its number of degrees of freedom (`freedom`) is the number of
    runs minus one.

    Parameters
    ----------
    name : str
        Name of the observable as in `gaspart measure`.
    sources : sequence of str, Path, Dataset or Simulation
        At least two runs of different seeds or initial states: paths of trajectories, open trajectories, or
        simulations.
    start : float, [time], optional
        Frames before this time are discarded; the default is defined by the observable's function.
    end : float, [time], optional
        Frames after this time are discarded. Default: none.
    **selection
        Selections of the observable's function.

    Returns
    -------
    Observable
        The mean with its uncertainty. The variable with the suffix _replicas contains the value of each run,
        shape (replica, ...). The theory is the mean over the theories of the runs.

    Raises
    ------
    SceneError
        If there are fewer than two runs; if scenes or engines differ (the message names the first
        difference); if two runs are identical (same initial state and same seed, or same initial state in a
        scene without random numbers); or if curves have different coordinates, such as densities in different
        bins. Also under the conditions of the observable's function.

    Examples
    --------
    >>> import gaspart as gp
    >>> box = gp.Container((10.0, 10.0), boundary="periodic")
    >>> scene = gp.Scene(box, [gp.Species(32, 0.5, temperature=1.0)])
    >>> runs = [gp.Simulation(scene, seed=seed) for seed in (1, 2)]
    >>> for run in runs:
    ...     run.advance(10.0)
    >>> gp.analysis.replicas("Z", runs)["compressibility_factor_replicas"].sizes["replica"]
    2
    """
    if isinstance(sources, str | Path | Simulation | xr.Dataset) or len(sources) < 2:
        raise SceneError("sources", sources, "must be a list of two runs or more")
    name = observable_name(name)
    results: list[Observable] = []
    recipes: list[_Recipe] = []
    drifts: list[dict[str, Trend]] = []
    for number, source in enumerate(sources, 1):
        with _open_source(source) as run:
            recipe = _recipe(run, str(source) if isinstance(source, str | Path) else f"run {number}")
            _check_replica(recipe, recipes)
            recipes.append(recipe)
            results.append(measure_single(run, name, start, end, **selection))
            with until_time(run, end) as part:
                drifts.append(trends(part, start))
    if OBSERVABLES[name].ends:
        results = _in_joint_bins(name, sources, results, start, end)
    mean, drift = _mean(results, recipes), describe(drifts)
    mean.attrs |= {"drift": drift} if drift else {}
    return mean


def _open_source(source: Source) -> AbstractContextManager[xr.Dataset | Simulation]:
    """Return a context manager that yields an open trajectory or a simulation."""
    return open_trajectory(source) if isinstance(source, str | Path) else nullcontext(source)


def _in_joint_bins(
    name: str, sources: Sequence[Source], results: list[Observable], start: float | None, end: float | None
) -> list[Observable]:
    """Measure an observable again for all runs, in the widest bins among the runs."""
    declared = OBSERVABLES[name]
    middles = [result[declared.along[-1]].values for result in results]
    widest = max(float(middle[-1] + 0.5 * (middle[1] - middle[0])) for middle in middles)
    function, again = getattr(analysis, declared.function), []
    for source in sources:
        with _open_source(source) as run, until_time(run, end) as part:
            again.append(function(part, start=start, **declared.arguments, **{declared.ends: widest}))
    return again


@dataclass(frozen=True)
class _Recipe:
    """Description of a run, to detect equal or incompatible replicas.

    name : name of the run in messages.
    settings : the scene and the engine of the run.
    seed : seed of the run.
    draws : True if the run draws random numbers after its initial state.
    times : times at which states are known. If `every` is True, states are known at all times up to the last
        of these times.
    state : function that returns the state at a given time, as the bytes that a file would contain.
    tallies : names of the optional tallies that the run stored, with their options as text.
    """

    name: str
    settings: dict[str, Any]
    seed: str
    draws: bool
    times: np.ndarray
    every: bool
    state: Callable[[float], bytes]
    tallies: dict[str, str]


def _recipe(run: Any, name: str) -> _Recipe:
    """Return the `_Recipe` of an open trajectory or a simulation."""
    if isinstance(run, Simulation):
        settings = {"scene": run.scene.to_dict(), "engine": engine_to_dict(run.engine)}
        times = np.array([0.0, run.time])
        draws, state = run.engine.draws(run.scene), partial(_state_at, run)
        return _Recipe(name, settings, str(run.seed), draws, times, True, state, _texts(run.tallies))
    if not isinstance(run, xr.Dataset) or not {"scene", "engine", "seed"} <= set(run.attrs):
        raise SceneError("sources", type(run).__name__, "must be trajectories, their paths or simulations")
    settings = {"scene": parse_yaml(run.attrs["scene"]), "engine": json.loads(run.attrs["engine"])}
    draws = engine_from_dict(settings["engine"]).draws(Scene.from_dict(settings["scene"]))
    frames = {key: run[key].values for key in ("time", "coordinates", "velocities") if key in run}
    stored = partial(_state_in_frame, frames)
    seed, tallies = str(run.attrs["seed"]), _texts(tallies_from_json(run.attrs.get("tallies", "[]")))
    return _Recipe(name, settings, seed, draws, frames["time"], False, stored, tallies)


def _texts(tallies: Iterable[OptionalTally]) -> dict[str, str]:
    """Return the options of tallies as text, by the name of the tally."""
    return {tally.name: tally.to_text() for tally in tallies if tally.form}


def _state_in_frame(frames: dict[str, np.ndarray], time: float) -> bytes:
    """Return the state in the frame of a trajectory at this time."""
    number = int(np.searchsorted(frames["time"], time))
    return _bits(*(frames[name][number] for name in ("coordinates", "velocities") if name in frames))


def _state_at(simulation: Simulation, time: float) -> bytes:
    """Return the state of a simulation now, or at an earlier time, for which it is run again."""
    if time < simulation.time:
        simulation = simulation.again()
        simulation.advance(until=time)
    state, capacity = simulation.state, simulation.scene.capacity
    return _bits(*(by_number(state, values, capacity) for values in (state.positions, state.velocities)))


def _bits(*vectors: np.ndarray) -> bytes:
    """Return the bytes of positions and velocities (N, d), in single precision."""
    return np.stack(vectors).astype(np.float32).tobytes()


def _check_replica(recipe: _Recipe, others: list[_Recipe]) -> None:
    """Raise SceneError unless runs differ only in the seed or in the initial state."""
    for other in others:
        if difference := _difference(recipe.settings, other.settings):
            key, value, second = difference
            differs = f"is {short_repr(second)} in {other.name}"
            rule = f"{differs}: replicas differ in nothing but seed and first state"
            raise SceneError(key, value, rule, recipe.name)
        time = _last_common(recipe, other)
        if time is None or recipe.state(0.0) != other.state(0.0):
            continue
        drawn = recipe.draws and recipe.seed != other.seed  # used if the runs have no later time in common
        if not drawn if time == 0.0 else recipe.state(time) == other.state(time):
            rule = f"and the first state give the same run, bit for bit, as {other.name}: no scatter"
            raise SceneError("seed", recipe.seed, rule, recipe.name)


def _last_common(recipe: _Recipe, other: _Recipe) -> float | None:
    """Return the last time at which both runs have a state, or None."""
    if recipe.every and other.every:
        return float(min(recipe.times[-1], other.times[-1]))
    if recipe.every or other.every:
        stored, end = (other, recipe.times[-1]) if recipe.every else (recipe, other.times[-1])
        common = stored.times[stored.times <= end]
    else:
        common = np.intersect1d(recipe.times, other.times)
    return float(common[-1]) if common.size and common[0] == 0.0 else None


def _difference(first: Any, second: Any, key: str = "") -> tuple[str, Any, Any] | None:
    """Find the first difference between nested dictionaries: its dotted key and both values; None if
    equal.
    """
    if isinstance(first, dict) and isinstance(second, dict):
        pairs = {str(name): (first.get(name), second.get(name)) for name in {**first, **second}}
        form = f"{key}.{{}}" if key else "{}"
    elif isinstance(first, list | tuple) and isinstance(second, list | tuple) and len(first) == len(second):
        pairs = {str(n): pair for n, pair in enumerate(zip(first, second, strict=True))}
        form = f"{key}[{{}}]"
    else:
        return None if first == second else (key, first, second)
    differences = (_difference(*pair, form.format(name)) for name, pair in pairs.items())
    return next((difference for difference in differences if difference), None)


def _other_coordinate(result: Observable, other: Observable, name: str, other_name: str) -> SceneError:
    """Return an error that names the coordinate in which two results of one observable differ."""
    for dim in map(str, result.estimate.dims):
        first, second = result[dim].values, other[dim].values
        if not np.array_equal(first, second):
            rule = (
                f"{_describe_coordinate(first)} in {name}: all runs need the same values of it, as with one "
                "sample_interval and duration (--start, --end)"
            )
            return SceneError(dim, _describe_coordinate(second), rule, other_name)
    raise AssertionError("equal coordinates")


def _describe_coordinate(values: np.ndarray) -> str:
    """Describe a coordinate as text."""
    if values.dtype.kind in "US" or not values.size:
        return ", ".join(map(str, values)) or "none"
    return f"{values.size} values from {values[0]:.6g} to {values[-1]:.6g}"


def _mean(measurements: list[Observable], recipes: list[_Recipe]) -> Observable:
    """Average the measurements of one observable from independent runs, which `recipes` describe."""
    first, quantity = measurements[0], str(measurements[0].attrs["quantity"])
    dims = first.estimate.dims
    for measurement, recipe in zip(measurements[1:], recipes[1:], strict=True):
        same = measurement.estimate.shape == first.estimate.shape
        if not same or any(
            not np.array_equal(measurement[dim], first[dim]) for dim in dims if dim in first.coords
        ):
            for key in {**recipes[0].tallies, **recipe.tallies}:
                usual, own = (each.tallies.get(key, "none") for each in (recipes[0], recipe))
                if usual != own:
                    rule = f"are {usual} in {recipes[0].name}: {quantity} is in the bins of these"
                    raise SceneError(key, own, rule, recipe.name)
            raise _other_coordinate(first, measurement, recipes[0].name, recipe.name)
    each = np.array([measurement.estimate.values for measurement in measurements])
    values, errors = means_of(each)
    single = np.array([measurement.error.values for measurement in measurements])
    rounding = _ROUNDING * np.abs(values)
    exact = (single <= rounding).all(axis=0)  # this value has no scatter within a run either
    errors = np.where((errors <= rounding) & ~exact, np.nan, errors)  # counts that are equal by chance
    parts = {"": values, "_error": errors}
    if all(measurement.theory is not None for measurement in measurements):
        for part in ("_theory", "_theory_error"):
            parts[part] = np.mean(
                [measurement[quantity + part].values for measurement in measurements], axis=0
            )
    coords = {dim: first.coords[dim] for dim in dims if dim in first.coords}
    data = {key: (dims, part, first[quantity + key].attrs) for key, part in parts.items()}
    attrs = {key: text for key, text in first.attrs.items() if key in ("quantity", "source")}
    result = Observable({quantity + key: value for key, value in data.items()}, coords, attrs)
    result[f"{quantity}_replicas"] = (("replica", *dims), each, first.estimate.attrs)
    result.attrs["freedom"] = len(measurements) - 1
    if not dims:  # series for the plot of a scalar
        about = {"long_name": "replica", "units": "1"}
        result = result.assign_coords(time=("time", np.arange(len(measurements)), about))
        result["stretches"] = ("time", each, {**first.estimate.attrs, "long_name": "replicas"})
    return result
