"""Trajectory store for xarray that verifies checksums of frames before it returns values."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr
from xarray.backends import BackendArray, NetCDF4DataStore
from xarray.core import indexing

from gaspart.errors import MissingName, SceneError
from gaspart.trajectory.amber import CheckedFrames
from gaspart.trajectory.opening import damage

_EVEN = 1e-9
"""Relative deviation of a frame's time from a multiple of the interval, above which the frame is checked."""


_LARGE = 1000
"""Numbers per frame, above which a slice of frames with a step is read frame by frame; netCDF is many times
slower."""


class Trajectory(xr.Dataset):
    """Open trajectory: a Dataset whose error for an unknown name suggests the most similar name."""

    __slots__ = ()

    def __getattr__(self, name: str) -> Any:
        try:
            return super().__getattr__(name)
        except AttributeError:
            if name.startswith("_"):  # true also for an instance under construction
                raise
            raise MissingName("a trajectory", name, map(str, self.variables)) from None


class CheckedStore(NetCDF4DataStore):
    """Variables of a trajectory; checksums of frames are verified before use. At this moment, checksums are
    verified only for frames whose times are not multiples of `interval`, because verifying all frames would
    require reading the complete file.
    """

    def __init__(self, file: netCDF4.Dataset, path: Path, frames: CheckedFrames, interval: float) -> None:
        super().__init__(file)
        self._path, self._frames = path, frames
        time = np.asarray(file["time"][:].data, dtype=float)
        expected = interval * np.arange(len(time))
        right = np.abs(time - expected) <= _EVEN * (expected + interval)  # False for NaN
        self.require(np.flatnonzero(~right))

    def require(self, numbers: np.ndarray) -> None:
        """Raise SceneError if one of these frames is damaged."""
        damaged = self._frames.find_damage(numbers)
        if damaged is not None:
            raise SceneError("file", str(self._path), damage(damaged))

    def open_store_variable(self, name: str, var: netCDF4.Variable) -> xr.Variable:
        """Return a variable that is read on demand."""
        variable = super().open_store_variable(name, var)
        if variable.dims[:1] != ("frame",) or name == "time":
            return variable
        var.set_auto_maskandscale(False)
        data = indexing.LazilyIndexedArray(_CheckedArray(var, self))
        return xr.Variable(variable.dims, data, variable.attrs, variable.encoding)


class _CheckedArray(BackendArray):
    """Variable with one value per frame, of which any slice can be read."""

    def __init__(self, variable: netCDF4.Variable, store: CheckedStore) -> None:
        self._variable, self._store = variable, store
        self.shape, self.dtype = variable.shape, variable.dtype
        self._numbers = np.arange(self.shape[0])

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        support = indexing.IndexingSupport.OUTER
        return indexing.explicit_indexing_adapter(key, self.shape, support, self._part)

    def _part(self, key: tuple) -> np.ndarray:
        numbers = np.atleast_1d(self._numbers[key[0]])
        self._store.require(numbers)
        stepped = isinstance(key[0], slice) and key[0].step not in (None, 1)
        with self._store.lock:
            if stepped and len(numbers) and math.prod(self.shape[1:]) > _LARGE:
                return np.stack([self._variable[(n, *key[1:])] for n in numbers])
            return self._variable[key]
