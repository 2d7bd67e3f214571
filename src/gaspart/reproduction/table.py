"""Table of a figure's numbers, with a row for each point and named columns.

Columns are numbers, words or estimates.

`table` makes the data set of a measurement from the columns of each point. `Table` reads this data set, for
claims and pictures. `each` makes one claim about every row.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence, ValuesView
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.claims import Claim

Inner = tuple[str, ...] | Mapping[str, tuple[str, ...]]
MADE_OF = "_made_of"
"""Suffix of the variable that states from which points each row is made."""
_NESTED = (list, tuple, ValuesView)


class _Columns:
    """Variables, coordinates and attributes of a data set, as Python attributes; see `Table`."""

    dataset: xr.Dataset

    def __getattr__(self, name: str) -> Any:
        if name == "dataset" or name.startswith("_"):
            raise AttributeError(name)  # during the copy of an object
        if name not in self.dataset.variables:
            if name in self.dataset.attrs:
                return _plain(self.dataset.attrs[name])
            raise AttributeError(
                f"{name}: no such column (columns: {', '.join(map(str, self.dataset.variables))})"
            )
        column = self.dataset[name]
        error = self.dataset.variables.get(f"{name}_error")
        if error is not None and error.dims == column.dims:
            return Estimate.of(self.dataset, name)
        values = column.values
        return values if values.ndim else values.item()


class Row(_Columns):
    """Row of a table. Columns are single numbers or words, single estimates, or arrays over the inner
    dimensions. Arrays have no entries for replicas that only other rows have. Use a row to format a text, as
    `"{count:.0f} discs".format_map(row)`.
    """

    def __init__(self, dataset: xr.Dataset) -> None:
        for over in [name for name in dataset.dims if str(name).endswith("replica")]:
            names = [name for name, column in dataset.data_vars.items() if over in column.dims]
            own = dataset.dropna(over, how="all", subset=names) if names else dataset
            dataset = own if own.sizes[over] else dataset
        self.dataset = dataset

    def __getitem__(self, name: str) -> Any:
        return getattr(self, name)


class Table(_Columns):
    """Rows of a data set along its dimension `over`; empty if it has no such dimension. A column is an
    attribute: `table.Z` is an Estimate of all rows if there is a variable Z_error, otherwise an array (rows,
    ...). Other variables and attributes are as in the data set. `table[condition]` contains the rows for
    which the condition (rows,) is true. A slice, or a list of indices, selects rows too. `table[0]` is a Row,
    and iteration yields Rows. A table without rows is false. Raises AttributeError for a name that is no
    column.
    """

    def __init__(self, dataset: xr.Dataset, over: str) -> None:
        self.dataset, self._over = dataset.transpose(over, ..., missing_dims="ignore"), over

    @classmethod
    def from_prefixed(cls, dataset: xr.Dataset, over: str) -> Table:
        """Return the rows along `over`, from the variables that begin with its name. See the function
        `merge_with_prefixes`.
        """
        start = f"{over}_"
        names = {name: str(name).removeprefix(start) for name in dataset if str(name).startswith(start)}
        return cls(dataset[list(names)].rename(names), over)

    def __len__(self) -> int:
        return int(self.dataset.sizes.get(self._over, 0))

    def __getitem__(self, rows: Any) -> Any:
        chosen = np.arange(len(self))[rows]
        part = self.dataset.isel({self._over: chosen}) if len(self) else self.dataset
        return Table(part, self._over) if chosen.ndim else Row(part)

    def __iter__(self) -> Iterator[Row]:
        return (self[n] for n in range(len(self)))

    def by(self, *keys: str | np.ndarray) -> Iterator[tuple[Any, ...]]:
        """Yield the values of the keys, and the rows with these values, in ascending order. Keys are names of
        columns, or arrays (rows,).
        """
        if not self:
            return
        columns = [np.asarray(getattr(self, key) if isinstance(key, str) else key) for key in keys]
        for values in sorted(set(zip(*(column.tolist() for column in columns), strict=True))):
            same = [column == value for column, value in zip(columns, values, strict=True)]
            yield *values, self[np.all(same, axis=0)]

    def sorted_by(self, *names: str) -> Table:
        """Sort the rows by ascending values of these columns; equal values keep their order."""
        part = self.dataset.sortby(list(names)) if self else self.dataset
        return Table(part, self._over)

    def assign(self, **columns: Any) -> Table:
        """Return the table with further columns. A column is an array (rows,), or a value for all rows."""
        filled = {
            name: (self._over, values if np.ndim(values) else [values] * len(self))
            for name, values in _spread(columns).items()
        }
        return Table(self.dataset.assign(filled), self._over)


def table(
    over: str,
    points: Sequence[Any],
    row: Callable[..., Mapping[str, Any]],
    *rest: Any,
    inner: Inner = (),
    units: Mapping[str, str] | None = None,
    of: Sequence[Any] | None = None,
) -> xr.Dataset:
    """Return a data set with a row for each point; row(point, *rest) returns the columns. An Estimate `name`
    becomes the variables `name`, `name`_error and `name`_freedom. A pair of value and error becomes the first
    two. `inner` and `units`: see `from_rows`. `of`: points of each row, if `points` do not determine them. If
    rows are made from points of a grid (see `made_of`), the variable `over`_made_of has their experiments and
    names, a line for each.
    """
    rows = [_spread(row(point, *rest)) for point in points]
    named = ["\n".join(made_of(item)) for item in (points if of is None else of)]
    data = from_rows(over, rows, inner, units)
    return data.assign({f"{over}{MADE_OF}": (over, named)}) if named and all(named) else data


def made_of(value: Any) -> list[str]:
    """Return a text `experiment/name` for each point that a value contains. The value is a point of a grid,
    or lists and mappings of such points.
    """
    if hasattr(value, "experiment") and hasattr(value, "name"):
        return [f"{value.experiment}/{value.name}"]
    inner = value.values() if isinstance(value, Mapping) else value
    return [name for item in inner for name in made_of(item)] if isinstance(inner, _NESTED) else []


def each(rows: Table, claim: str, form: Callable[..., Claim] = Claim, **stated: Any) -> list[Claim]:
    """Return a claim about each row. `form`: function that makes the claim, such as `Claim.at_most`.
    `stated`: arguments of this function. Texts may name columns, as in "Z at {packing_fraction:.2g}". Lists,
    arrays and estimates of arrays must have one element for each row. Otherwise ValueError is raised.
    """
    claims = []
    for n, row in enumerate(rows):
        fields = {name: _of_row(name, value, n, len(rows), row) for name, value in stated.items()}
        claims.append(form(claim=claim.format_map(row), **fields))
    return claims


def _of_row(name: str, value: Any, n: int, count: int, row: Row) -> Any:
    if isinstance(value, str):
        return value.format_map(row)
    many = value.value if isinstance(value, Estimate) else value
    if not isinstance(many, (list, np.ndarray)):
        return value
    if len(many) != count:
        raise ValueError(f"{name}: {len(many)} values for {count} rows")
    return _plain(value[n])


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value


def _spread(row: Mapping[str, Any]) -> dict[str, Any]:
    """Return the variables of a row; see `table`."""
    spread: dict[str, Any] = {}
    for name, value in row.items():
        spread |= entries({name: value}) if isinstance(value, (Estimate, tuple)) else {name: value}
    return spread


def merge_with_prefixes(**tables: xr.Dataset) -> xr.Dataset:
    """Merge tables with different rows to one data set; add their dimensions as prefixes. The column `volume`
    along `path` becomes the variable `path_volume`.
    """
    renamed = (part.rename({name: f"{over}_{name}" for name in part}) for over, part in tables.items())
    return xr.merge(renamed, join="outer", compat="no_conflicts")


def from_rows(
    over: str,
    rows: Sequence[Mapping[str, Any]],
    inner: Inner = (),
    units: Mapping[str, str] | None = None,
) -> xr.Dataset:
    """Return a variable over the dimension `over` for each key of the rows. `inner`: further dimensions of
    arrays, either the same for all, or by key. `units`: units by key; "1" for other keys. By default no units
    are stated. Shorter arrays are padded with NaN. Missing entries of a row are NaN. A key with the suffix
    _error has the dimensions and the unit of the key without the suffix. A key with the suffix _freedom has
    the same dimensions.
    """
    columns = {}
    for name in dict.fromkeys(name for row in rows for name in row):
        key = name.removesuffix("_error")
        values = _stack([np.asarray(row.get(name, np.nan)) for row in rows])
        dims = inner if isinstance(inner, tuple) else inner.get(key.removesuffix("_freedom"), ())
        dims = dims[: values.ndim - 1]  # a single number of degrees of freedom may belong to an array
        attributes = {} if units is None or values.dtype.kind in "OSU" else {"units": units.get(key, "1")}
        columns[name] = (over, *dims), values, attributes
    return xr.Dataset(columns)


def entries(numbers: Mapping[str, Estimate | tuple[Any, Any]], freedom: int | None = None) -> dict[str, Any]:
    """Return the entries of a row for numbers with uncertainties. The entries are `name`, `name`_error, and
    `name`_freedom. `numbers`: by name, an Estimate, or a value and its error; numbers or arrays. `freedom`:
    degrees of freedom for values with errors; without it they have no such entry.
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


def _stack(arrays: list[np.ndarray]) -> np.ndarray:
    """Join arrays of the same number of dimensions along a new first axis. An empty array is replaced by a
    single NaN.
    """
    shape = max((array.shape for array in arrays), key=len)
    if all(array.shape == shape for array in arrays):
        return np.stack(arrays)
    arrays = [array if array.ndim == len(shape) else np.empty((0,) * len(shape)) for array in arrays]
    stacked = np.full((len(arrays), *np.max([array.shape for array in arrays], axis=0)), np.nan)
    for row, array in zip(stacked, arrays, strict=True):
        row[tuple(map(slice, array.shape))] = array
    return stacked
