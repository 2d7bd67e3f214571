"""Measurement of an observable at each point of some experiments, as named in a config."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.frames import measure_single
from gaspart.analysis.observable import Observable
from gaspart.analysis.observables import OBSERVABLES
from gaspart.analysis.statistics import average
from gaspart.errors import SceneError
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import from_rows
from gaspart.trajectory.reading import open_trajectory

_PARTS = {"value": "", "value_error": "_error", "theory": "_theory", "theory_error": "_theory_error"}


def observable(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure an observable of each point, averaged over its replicas.

    The settings are:

    observable : name of the observable
    against : key of the points on the horizontal axis
    place : for a curve, the position at which its value is taken; see `families.own`

    The dimension is point, ordered by `series` and `against`.

    against : value of the key
    series : other varying settings, as text
    value, theory : value and theory (or NaN), in the units of the observable; both have an `_error`
    value_freedom : degrees of freedom of the error

    Some observables have several named values, such as one for each face; then each name is a series. For a
    curve, all these variables also have the dimension `along`, and `along_places` contains the positions.
    Raises SceneError for an observable that cannot be measured.
    """
    name = settings["observable"]
    rows, source = [], ""
    for point in points:
        results, _, refused = measure_point(point, [name], part=False)
        if refused:
            raise refused[name]
        replicas = results[name]
        if settings.get("place") is not None:
            (dim,) = replicas[0].estimate.dims
            replicas = [replica.sel({dim: settings["place"]}, method="nearest") for replica in replicas]
        source = source or replicas[0].attrs.get("source", "")
        shared = {"against": float(point.settings[settings["against"]])}
        for label, parts in _by_name(replicas).items():
            series = ", ".join(filter(None, (_other(point, points, settings["against"]), label)))
            rows.append({**shared, "series": series, **_numbers(parts)})
    rows.sort(key=lambda row: (row["series"], row["against"]))
    first = replicas[0].estimate
    dataset = from_rows("point", rows, inner=("along",))
    for key in ("value", "value_error", "theory", "theory_error"):
        dataset[key].attrs["units"] = first.attrs.get("units", "1")
    dataset["value"].attrs["long_name"] = first.attrs.get("long_name", OBSERVABLES[name].definition)
    if "along_places" in dataset:
        dataset["along_places"].attrs.update(replicas[0][first.dims[0]].attrs)
    return dataset.assign_attrs(against=settings["against"], observable=name, source=source)


def _by_name(replicas: list[Observable]) -> dict[str, list[Observable]]:
    """Split an observable with named values, such as faces, into its values.

    Another observable is returned unchanged.
    """
    first = replicas[0].estimate
    if not first.dims or first[first.dims[0]].dtype.kind not in "UO":
        return {"": replicas}
    (dim,) = first.dims
    return {str(text): [replica.sel({dim: text}) for replica in replicas] for text in first[dim].values}


def _other(point: Point, points: list[Point], against: str) -> str:
    """Return a text that distinguishes a point from others at the same value of `against`.

    The text contains the other values of its grid, and the experiment if there are several.
    """
    several = len({other.experiment for other in points}) > 1
    varied = [part for part in point.name.split(",") if not part.startswith(f"{against}=")]
    return ", ".join([point.experiment] * several + [part for part in varied if part != "single"])


def _numbers(replicas: list[Observable]) -> dict[str, Any]:
    """Return the entries of a row for the mean of independent runs."""
    row: dict[str, Any] = {}
    for name, part in _PARTS.items():
        values = mean_of(replicas, part)
        row[name] = np.full_like(row["value"], np.nan) if values is None else values
    if row["value"].ndim:
        (dim,) = replicas[0].estimate.dims
        shortest = min((replica[dim].values for replica in replicas), key=len)
        return {**row, "along_places": shortest, "value_freedom": np.inf}
    estimates = [
        Estimate(replica.estimate, replica.error, replica.attrs.get("freedom", np.inf))
        for replica in replicas
    ]
    return {**row, "value_freedom": average(estimates).freedom}


def measure_point(
    point: Point, names: Sequence[str], part: bool
) -> tuple[dict[str, list[Observable]], float, dict[str, SceneError]]:
    """Measure observables of all replicas of a point.

    Returns the observables by name, the mean duration of a replica, and error messages by name of observables
    that cannot be measured. Frames after the equilibration are used. With `part`, the first quarter of each
    run is left out instead.
    """
    start = None if part else point.schedule.equilibration
    results: dict[str, list[Observable]] = {name: [] for name in names}
    durations: list[float] = []
    refused: dict[str, SceneError] = {}
    for path in point.replica_paths:
        try:
            with open_trajectory(path) as trajectory:
                durations.append(float(trajectory["time"][-1]))
                for name in names:
                    try:
                        results[name].append(measure_single(trajectory, name, start))
                    except SceneError as error:
                        refused.setdefault(name, error.inside(f"{name} of {path}"))
        except SceneError as error:  # a damaged file
            refused |= {name: refused.get(name, error) for name in names}
    duration = float(np.mean(durations)) if durations else np.nan
    return {name: results[name] for name in names if name not in refused}, duration, refused


def mean_of(replicas: list[Observable], part: str) -> np.ndarray | None:
    """Average independent runs, or compute another property of the mean.

    The property `part` is the standard uncertainty (_error), theory (_theory), or the uncertainty of theory
    (_theory_error). Without a theory, None is returned. Runs that stop at a required accuracy may have curves
    of different lengths. Then only the common range is used.
    """
    quantity = replicas[0].attrs["quantity"]
    if part.startswith("_theory") and any(replica.theory is None for replica in replicas):
        return None
    values = [replica[quantity + part].values for replica in replicas]
    shape = np.min([value.shape for value in values], axis=0).astype(int)
    values = [value[tuple(slice(size) for size in shape)] for value in values]
    if part == "_error":
        return np.sqrt(np.sum(np.square(values), axis=0)) / len(values)
    return np.mean(values, axis=0)
