"""From the numbers of each point of a figure, one mapping a point, to a data set of all points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.estimate import Estimate


def from_rows(
    over: str,
    rows: Sequence[Mapping[str, Any]],
    inner: tuple[str, ...] | Mapping[str, tuple[str, ...]] = (),
    units: Mapping[str, str] | None = None,
) -> xr.Dataset:
    """One variable over the dimension `over` for each key of the rows.

    inner: the further dimensions of arrays, the same for all of them, or by key. Arrays that are shorter than
    the longest are filled up with NaN, and so is what a row does not have. units: by key, "1" for others; by
    default none are stated. A key with the suffix _error has the dimensions and the unit of the one without.
    """
    columns = {}
    for name in dict.fromkeys(name for row in rows for name in row):
        key = name.removesuffix("_error")
        values = _stacked([np.asarray(row.get(name, np.nan)) for row in rows])
        dims = inner.get(key, ()) if isinstance(inner, Mapping) else inner[: values.ndim - 1]
        attributes = {} if units is None or values.dtype.kind in "OSU" else {"units": units.get(key, "1")}
        columns[name] = (over, *dims), values, attributes
    return xr.Dataset(columns)


def entries(numbers: Mapping[str, Estimate | tuple[Any, Any]], freedom: int | None = None) -> dict[str, Any]:
    """The entries of a row for numbers with uncertainties: `name`, `name`_error, and `name`_freedom.

    numbers: by name, each an Estimate, or a value and its error, numbers or arrays. freedom: the degrees of
    freedom of the latter; without it they have no such entry.
    """
    row: dict[str, Any] = {}
    for name, number in numbers.items():
        if isinstance(number, Estimate):
            row |= {name: number.value, f"{name}_error": number.error, f"{name}_freedom": number.freedom}
        else:
            row[name], row[f"{name}_error"] = number
            if freedom is not None:
                row[f"{name}_freedom"] = freedom
    return row


def estimates(dataset: xr.Dataset, name: str) -> np.ndarray:
    """(2, ...) the values of a variable and their errors; of one number `Estimate.of` makes an Estimate."""
    return np.stack([dataset[name].values, dataset[f"{name}_error"].values])


def _stacked(arrays: list[np.ndarray]) -> np.ndarray:
    """Arrays of one number of dimensions along a new first one; NaN alone stands for an empty array."""
    shape = max((array.shape for array in arrays), key=len)
    if all(array.shape == shape for array in arrays):
        return np.stack(arrays)
    arrays = [array if array.ndim == len(shape) else np.empty((0,) * len(shape)) for array in arrays]
    stacked = np.full((len(arrays), *np.max([array.shape for array in arrays], axis=0)), np.nan)
    for row, array in zip(stacked, arrays, strict=True):
        row[tuple(map(slice, array.shape))] = array
    return stacked
