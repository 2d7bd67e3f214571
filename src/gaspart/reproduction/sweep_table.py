"""Table of a sweep: observables of all points, by the varied keys, with a plot method."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import product
from math import nan
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from gaspart.analysis.declaration import DIMENSIONS
from gaspart.analysis.observable import ByFace, Observable, label_of
from gaspart.errors import SceneError, unknown_word
from gaspart.reproduction.figures.own import mean_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class SweepTable(ByFace):
    """The Dataset of a sweep (see `gaspart.sweep`)."""

    __slots__ = ()

    @property
    def observables(self) -> list[str]:
        """Names of the measured observables."""
        names = (str(name) for name in self.data_vars if f"{name}_error" in self)
        return [name for name in names if not name.endswith("_theory")]

    def plot(  # type: ignore[override]
        self, observable: str | None = None, along: str | None = None, axis: Axes | None = None
    ) -> Axes:
        """Draw an observable with bars of one standard deviation, and theory as black lines. There is one
        curve for each value of the other dimensions. The theory is known at the points of the sweep, which
        lines join.
        """
        import matplotlib.pyplot as plt

        name = _check_name("observable", observable, self.observables)
        values = self[name]

        def rank(dim: str) -> tuple[bool, ...]:
            return values[dim].dtype.kind not in "fiu", not dim.startswith(f"{name}_"), values.sizes[dim] < 2

        along = _check_name("along", along, sorted(map(str, values.dims), key=rank))
        if axis is None:
            axis = plt.figure(layout="constrained").add_subplot()
        others = [str(dim) for dim in values.dims if dim != along]
        for index in product(*(range(values.sizes[dim]) for dim in others)):
            chosen = dict(zip(others, index, strict=True))
            several = {dim: values[dim].values[n] for dim, n in chosen.items() if values.sizes[dim] > 1}
            label = ", ".join(
                f"{dim} = {value:g}" if isinstance(value, float) else f"{dim} = {value}"
                for dim, value in several.items()
            )
            _draw_curve(axis, self.isel(chosen), name, along, label)
        axis.set(xlabel=label_of(values[along]), ylabel=label_of(values))
        if f"{name}_theory" in self:
            axis.plot([], [], color="black", label="theory")
        if axis.get_legend_handles_labels()[1]:
            axis.legend(frameon=False)
        return axis


def _check_name(key: str, name: str | None, names: list[str]) -> str:
    """Return a name of the table, by default the first."""
    if not names:
        raise SceneError(key, name, "there is nothing to be drawn: the sweep has one point")
    if name is not None and name not in names:
        raise SceneError(key, name, unknown_word(name, names, "name"))
    return name or names[0]


def _draw_curve(axis: Axes, curve: xr.Dataset, name: str, along: str, label: str) -> None:
    """Draw a curve, with theory as a line; if positions are words, theory is drawn as crosses."""
    x = curve.get(f"{along}_places", curve[name][along]).values
    value, error = np.broadcast_arrays(curve[name].values, curve[f"{name}_error"].values)
    axis.errorbar(x, value, error, fmt="o", markersize=3, capsize=2, label=label or None)
    if f"{name}_theory" in curve:
        order = np.argsort(x)
        form = "-" if x.dtype.kind in "fiu" else "x"
        axis.plot(x[order], curve[f"{name}_theory"].values[order], form, color="black", linewidth=1.0)


def columns(name: str, replicas: list[Observable]) -> Iterable[tuple[str, xr.DataArray]]:
    """Yield the variables of an observable of a point. All observables share dimensions whose coordinates are
    names. Other dimensions belong to one observable; their positions are a variable, because they may differ
    from point to point.
    """
    first, quantity = replicas[0].estimate, replicas[0].attrs["quantity"]
    own = {dim: f"{name}_{dim}" for dim in first.dims if not DIMENSIONS[str(dim)].names}
    coordinates = {dim: first[dim] for dim in first.dims if dim not in own}
    for part in ("", "_error", "_theory", "_theory_error"):
        values = mean_of(replicas, part)
        if values is not None:
            sizes = zip(first.dims, values.shape, strict=True)
            numbered = {own[dim]: np.arange(size) for dim, size in sizes if dim in own}
            dims = [own.get(dim, dim) for dim in first.dims]
            about = replicas[0][quantity + part].attrs
            yield name + part, xr.DataArray(values, {**coordinates, **numbered}, dims, attrs=about)
    for dim, new in own.items():
        positions = first[dim]
        yield (
            f"{new}_places",
            xr.DataArray(positions.values, {new: np.arange(positions.size)}, new, attrs=positions.attrs),
        )


def table(rows: list[xr.Dataset], names: Sequence[str], axes: Mapping[str, list]) -> SweepTable:
    """Join the results of the points, in the order of the product of the axes."""
    for name in names:
        forms = [row[name].dims for row in rows if name in row]
        for n, row in enumerate(rows):
            if name in row and row[name].dims != forms[0]:
                reason = f"{name}: has other components than elsewhere"
                failure = "; ".join(filter(None, [row.failure.item(), reason]))
                own = [key for key in row if key == name or str(key).startswith(f"{name}_")]
                rows[n] = row.drop_vars(own).assign(failure=failure)
    data = xr.concat(rows, "point", data_vars="all", join="outer", compat="equals", combine_attrs="override")
    shape = [len(values) for values in axes.values()]
    columns: dict[str, Any] = {}
    for name in names:
        columns |= dict.fromkeys((name, f"{name}_error"), (tuple(axes), np.full(shape, nan)))
    for key, column in data.data_vars.items():
        available = column.dropna("point", how="all")
        if str(key).endswith("_places") and (available == available[0]).all():
            columns[str(key).removesuffix("_places")] = (column.dims[1:], available[0].values, column.attrs)
            continue
        values = column.values.reshape([*shape, *column.shape[1:]])
        columns[str(key)] = ((*axes, *column.dims[1:]), values, column.attrs)
    columns["duration"][2]["units"] = "time"
    for key, meaning in {"failure": "why something is NaN", "drift": "what is not steady"}.items():
        over, reasons, attributes = columns[key]
        columns[key] = (over, reasons.astype(object), attributes | {"long_name": meaning})
    columns |= {str(dim): data[dim] for dim in data.dims if dim in DIMENSIONS}
    labels = {key: [coordinate(value) for value in values] for key, values in axes.items()}
    return SweepTable(columns, labels)


def coordinate(value: Any) -> Any:
    """Convert a value to a coordinate; a list is converted to text."""
    return value if isinstance(value, (int, float, str)) else str(value)
