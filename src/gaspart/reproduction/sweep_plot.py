"""The table of a sweep, which plots its observables with their errors and theory."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from gaspart.analysis.observable import ByFace, label_of
from gaspart.errors import SceneError, unknown_word

if TYPE_CHECKING:
    from matplotlib.axes import Axes


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
        """Draw an observable with bars of one standard deviation, and theory as lines where it is known.

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

        name = _known("observable", observable, self.observables)
        values = self[name]
        along = _known("along", along, _preferred(values))
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


def _known(key: str, given: str | None, known: list[str]) -> str:
    """A name of the table, by default the first. Raises SceneError."""
    if not known:
        raise SceneError(key, given, "there is nothing to be drawn: the sweep has one point")
    if given is not None and given not in known:
        raise SceneError(key, given, unknown_word(given, known, "name"))
    return given or known[0]


def _preferred(values: xr.DataArray) -> list[str]:
    """The dimensions of an observable, those first that make the best axis."""
    dims = [str(dim) for dim in values.dims]
    numbers = [dim for dim in dims if _is_number(values, dim)]
    curves = [dim for dim in numbers if dim.startswith(f"{values.name}_")]
    several = [dim for dim in numbers if values.sizes[dim] > 1]
    return list(dict.fromkeys([*curves, *several, *numbers, *dims]))


def _is_number(values: xr.DataArray, dim: str) -> bool:
    return dim not in values.coords or values[dim].dtype.kind in "fiu"


def _label(table: xr.Dataset, chosen: dict[str, int]) -> str:
    """The label of a curve: what distinguishes it from others."""
    words = []
    for dim, number in chosen.items():
        if table.sizes[dim] > 1:
            value = table[dim].values[number] if dim in table.coords else number
            words.append(f"{dim} = {value:g}" if isinstance(value, float) else f"{dim} = {value}")
    return ", ".join(words)


def _draw_curve(axis: Axes, curve: xr.Dataset, name: str, along: str, label: str) -> None:
    """One curve, with theory as a line of its colour; of places that are words, as crosses."""
    values, error = np.broadcast_arrays(curve[name].values, curve[f"{name}_error"].values)
    places: Any = np.arange(values.size)
    for at in (f"{along}_places", along):
        if at in curve:
            places = curve[at].values
            break
    words = places.dtype.kind not in "fiu"
    x = np.arange(values.size) if words else places
    bars = axis.errorbar(x, values, error, fmt="o", markersize=3, capsize=2, label=label or None)
    if words:
        axis.set_xticks(x, [str(text) for text in places])
    if f"{name}_theory" in curve:
        order = np.argsort(x)
        theory = curve[f"{name}_theory"].values
        form: dict[str, Any] = {"marker": "x", "linestyle": ""} if words else {}
        axis.plot(x[order], theory[order], color=bars.lines[0].get_color(), **form)
