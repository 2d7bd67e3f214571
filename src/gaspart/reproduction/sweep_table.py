"""The table of a sweep: observables of all points, by what varies."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from gaspart.analysis.declaration import DIMENSIONS
from gaspart.analysis.measuring import measure
from gaspart.analysis.observable import ByFace, Observable, label_of
from gaspart.engines import Engine, engine_to_dict
from gaspart.errors import SceneError, unknown_word
from gaspart.reproduction.points.point import Point
from gaspart.scene.scene import Scene
from gaspart.trajectory.reading import open_trajectory
from gaspart.yaml_text import dump_yaml

if TYPE_CHECKING:
    from matplotlib.axes import Axes


# The table of a sweep, which plots its observables with their errors and theory.


class SweepTable(ByFace):
    """The Dataset of a sweep (see `gaspart.sweep`)."""

    __slots__ = ()

    @property
    def observables(self) -> list[str]:
        """Names of the measured observables."""
        return [str(name) for name in self.data_vars if f"{name}_error" in self]

    def plot(  # type: ignore[override]
        self, observable: str | None = None, along: str | None = None, axis: Axes | None = None
    ) -> Axes:
        """Draw an observable with bars of one standard deviation, and theory as lines.

        Each value of the other dimensions gives one curve.

        Parameters
        ----------
        observable : str, optional
            Name of the observable. Default: the first one.
        along : str, optional
            Dimension of the axis. Default: the dimension of a curve, else the first key with several values.
        axis : matplotlib Axes, optional
            Axes to draw in. Default: a new one.

        Returns
        -------
        matplotlib Axes
            The Axes.

        Raises
        ------
        SceneError
            For names that the table lacks.
        """
        import matplotlib.pyplot as plt

        name = _check_name("observable", observable, self.observables)
        values = self[name]
        along = _check_name("along", along, _order_dimensions(values))
        if axis is None:
            axis = plt.figure(layout="constrained").add_subplot()
        others = [str(dim) for dim in values.dims if dim != along]
        for index in product(*(range(self.sizes[dim]) for dim in others)):
            chosen = dict(zip(others, index, strict=True))
            _draw_curve(axis, self.isel(chosen), name, along, _label(self, chosen))
        axis.set(xlabel=label_of(self[along]) if along in self.coords else along, ylabel=label_of(values))
        if f"{name}_theory" in self:
            axis.plot([], [], color="black", label="theory")
        if axis.get_legend_handles_labels()[1]:
            axis.legend(frameon=False)
        return axis


def _check_name(key: str, name: str | None, names: list[str]) -> str:
    """Return a name of the table, by default the first; raise SceneError."""
    if not names:
        raise SceneError(key, name, "there is nothing to be drawn: the sweep has one point")
    if name is not None and name not in names:
        raise SceneError(key, name, unknown_word(name, names, "name"))
    return name or names[0]


def _order_dimensions(values: xr.DataArray) -> list[str]:
    """Return the dimensions of an observable, those first that make the best axis."""
    dims = [str(dim) for dim in values.dims]
    numbers = [dim for dim in dims if _is_number(values, dim)]
    curves = [dim for dim in numbers if dim.startswith(f"{values.name}_")]
    several = [dim for dim in numbers if values.sizes[dim] > 1]
    return list(dict.fromkeys([*curves, *several, *numbers, *dims]))


def _is_number(values: xr.DataArray, dim: str) -> bool:
    return dim not in values.coords or values[dim].dtype.kind in "fiu"


def _label(table: xr.Dataset, chosen: dict[str, int]) -> str:
    """Return the label of a curve: what distinguishes it from others."""
    words = []
    for dim, number in chosen.items():
        if table.sizes[dim] > 1:
            value = table[dim].values[number] if dim in table.coords else number
            words.append(f"{dim} = {value:g}" if isinstance(value, float) else f"{dim} = {value}")
    return ", ".join(words)


def _draw_curve(axis: Axes, curve: xr.Dataset, name: str, along: str, label: str) -> None:
    """Draw a curve, with theory as a line of its colour.

    If positions are words, it is drawn as crosses.
    """
    values, error = np.broadcast_arrays(curve[name].values, curve[f"{name}_error"].values)
    positions: Any = np.arange(values.size)
    for at in (f"{along}_places", along):
        if at in curve:
            positions = curve[at].values
            break
    words = positions.dtype.kind not in "fiu"
    x = np.arange(values.size) if words else positions
    bars = axis.errorbar(x, values, error, fmt="o", markersize=3, capsize=2, label=label or None)
    if words:
        axis.set_xticks(x, [str(text) for text in positions])
    if f"{name}_theory" in curve:
        order = np.argsort(x)
        theory = curve[f"{name}_theory"].values
        form: dict[str, Any] = {"marker": "x", "linestyle": ""} if words else {}
        axis.plot(x[order], theory[order], color=bars.lines[0].get_color(), **form)


_PARTS = ("", "_error", "_theory")


@dataclass(frozen=True)
class Measured:
    """Observables of one point, each of all its replicas, and the duration of each replica.

    An observable that was not measured is missing; `failure` is the reason, or "".
    """

    observables: dict[str, list[Observable]]
    durations: list[float]
    failure: str = ""


def measure_point(point: Point, names: Sequence[str], part: bool) -> tuple[Measured, dict[str, SceneError]]:
    """Measure observables of a point, by name, and return the error of each that fails.

    Frames count after the equilibration, or, with `part`, after the first quarter of each run.
    """
    start = None if part else point.schedule.equilibration
    observables: dict[str, list[Observable]] = {name: [] for name in names}
    durations: list[float] = []
    refused: dict[str, SceneError] = {}
    for path in point.replica_paths:
        try:
            with open_trajectory(path) as trajectory:
                durations.append(float(trajectory["time"][-1]))
                for name in names:
                    try:
                        observables[name].append(measure(trajectory, name, start))
                    except SceneError as error:
                        refused.setdefault(name, error.inside(f"{name} of {path}"))
        except SceneError as error:  # a damaged file
            refused |= {name: refused.get(name, error) for name in names}
    return Measured({name: observables[name] for name in names if name not in refused}, durations), refused


def table(
    rows: list[Measured], names: Sequence[str], axes: Mapping[str, list], run: Mapping[str, Any]
) -> SweepTable:
    """Return the Dataset of a sweep.

    rows : in the order of the product of the values of `axes`.
    run : scene, engine and seed, which its attributes state.
    """
    data = xr.Dataset(
        coords={key: [_coordinate(value) for value in values] for key, values in axes.items()},
        attrs=_attributes(**run),
    )
    failures = [row.failure for row in rows]
    for name in names:
        replicas = [row.observables.get(name) for row in rows]
        for number in _of_other_form(replicas):
            replicas[number] = None
            reasons = [failures[number], f"{name}: has other components than elsewhere"]
            failures[number] = "; ".join(filter(None, reasons))
        of_one = xr.Dataset(_variables(name, replicas, axes))
        data = xr.merge([data, of_one], join="outer", compat="no_conflicts", combine_attrs="override")
    durations = [float(np.mean(row.durations)) if row.durations else np.nan for row in rows]
    shape = [len(values) for values in axes.values()]
    data["duration"] = (tuple(axes), np.reshape(durations, shape), {"units": "time"})
    about = {"long_name": "why something is NaN"}
    data["failure"] = (tuple(axes), np.reshape(np.array(failures, dtype=object), shape), about)
    return SweepTable(data.data_vars, data.coords, data.attrs)


def _of_other_form(points: Sequence[list[Observable] | None]) -> list[int]:
    """Return the numbers of the points whose observable has other dimensions than the first one's."""
    available = [(number, replicas[0]) for number, replicas in enumerate(points) if replicas]
    return [
        number
        for number, observable in available
        if observable.estimate.dims != available[0][1].estimate.dims
    ]


def _attributes(scene: Scene, engine: Engine, seed: int) -> dict[str, Any]:
    return {"scene": dump_yaml(scene.to_dict()), "engine": json.dumps(engine_to_dict(engine)), "seed": seed}


def _coordinate(value: Any) -> Any:
    """Return a value as a coordinate: of a list, its text."""
    return value if isinstance(value, (int, float, str)) else str(value)


def _variables(
    name: str, points: Sequence[list[Observable] | None], axes: Mapping[str, list]
) -> dict[str, xr.DataArray]:
    """Return an observable of all points as arrays over `axes`, and its coordinates if they differ.

    An observable that is unknown at a point has the value None there.
    """
    available = [replicas for replicas in points if replicas]
    if not available:
        nothing = xr.DataArray(_stack(points, axes), dims=tuple(axes))
        return {name: nothing, f"{name}_error": nothing}
    first = available[0][0]
    along = [str(dim) for dim in first.estimate.dims]
    positions = [
        [replica.estimate[dim].values for dim in along] for replicas in available for replica in replicas
    ]
    common = all(np.array_equal(a, b) for row in positions for a, b in zip(row, positions[0], strict=True))
    inner = [dim if common and DIMENSIONS[dim].names else f"{name}_{dim}" for dim in along]
    dims = (*axes, *inner)
    variables = {}
    for part in _PARTS:
        each = [mean_of(replicas, part) if replicas else None for replicas in points]
        if part == "_theory" and all(value is None for value in each):
            continue
        about = dict(first.estimate.attrs)
        variables[name + part] = xr.DataArray(_stack(each, axes), dims=dims, attrs=about)
    for axis, dim in enumerate(along):
        about = dict(first[dim].attrs)
        if common:
            variables[inner[axis]] = xr.DataArray(positions[0][axis], dims=(inner[axis],), attrs=about)
        else:
            each = [replicas[0].estimate[dim].values if replicas else None for replicas in points]
            at = xr.DataArray(_stack(each, axes), dims=(*axes, f"{name}_{dim}"), attrs=about)
            variables[f"{name}_{dim}_places"] = at
    return variables


def mean_of(replicas: list[Observable], part: str) -> np.ndarray | None:
    """Average independent runs, or compute another part of the mean.

    The part is its standard uncertainty (_error), theory (_theory) or the uncertainty of theory
    (_theory_error), None without a theory. Runs that end when they are accurate may have curves of different
    lengths, of which the common part is taken.
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


def _stack(each: Sequence[Any], axes: Mapping[str, list]) -> np.ndarray:
    """Join the arrays of all points, some shorter or missing (None), to one.

    The rest is nan.
    """
    arrays = [np.asarray(value) for value in each if value is not None]
    inner = tuple(np.max([value.shape for value in arrays], axis=0).astype(int)) if arrays else ()
    numbers = all(value.dtype.kind in "fiu" for value in arrays)
    joined = np.full((len(each), *inner), np.nan if numbers else "", dtype=float if numbers else object)
    for row, value in enumerate(each):
        if value is not None:
            at: tuple[Any, ...] = (row, *(slice(size) for size in np.shape(value)))
            joined[at] = value
    return joined.reshape([len(values) for values in axes.values()] + list(inner))
