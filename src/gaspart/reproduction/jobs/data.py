"""Data of the job of a point, and their file."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from gaspart.keys import NOT_NEGATIVE, POSITIVE, describe, list_of

if TYPE_CHECKING:
    from gaspart.reproduction.points.point import Point


_NONE: Mapping = MappingProxyType({})
MADE_BY = "made_by"
"""Attribute of a data set of a point: the digest of the arguments of its job."""


def kept_path(path: Path) -> Path:
    """Return where the output of a point is kept, for a job that makes it again or longer."""
    return path.parents[1] / ".kept" / path.parent.name / path.name


def digest_of(parameters: dict[str, Any]) -> str:
    """Return the digest of the arguments of a job, as plain values."""
    return hashlib.sha256(json.dumps(parameters, sort_keys=True).encode()).hexdigest()[:16]


def made_by(path: str | Path) -> str:
    """Return the digest of the arguments that made the data set of a point, or "". May raise OSError."""
    import netCDF4

    with netCDF4.Dataset(path) as file:
        return str(getattr(file, MADE_BY, ""))


class PointData(NamedTuple):
    """Variables, coordinates and attributes, as arguments for `xr.Dataset(*data)`.

    variables, coordinates : by name, dimensions (names), values (numbers or words), optional attributes.

    Jobs do not use xarray, because loading it takes 0.25 s. Most jobs are short timings, during which no
    other work may run.
    """

    variables: Mapping[str, tuple]
    coordinates: Mapping[str, tuple] = _NONE
    attributes: Mapping[str, Any] = _NONE

    def write(self, path: str | Path) -> None:
        """Write a netCDF file that xarray.load_dataset reads. May raise OSError."""
        import netCDF4
        import numpy as np

        with netCDF4.Dataset(path, "w") as file:
            for name, (over, values, *attributes) in {**self.variables, **self.coordinates}.items():
                array = np.asarray(values)
                dimensions = (over,) if isinstance(over, str) else over
                for dimension, size in zip(dimensions, array.shape, strict=True):
                    if dimension not in file.dimensions:
                        file.createDimension(dimension, size)
                words = array.dtype.kind == "U"
                variable = file.createVariable(name, str if words else array.dtype, dimensions)
                variable[:] = array.astype(object) if words else array
                for attribute in attributes:
                    variable.setncatts(attribute)
            file.setncatts(self.attributes)


# Common parts of jobs that run a scene: keys, and the division of a run into intervals.


SLACK = 1e-6
"""Fraction of a time step by which a run is longer, so that rounding of its duration loses no step."""
DIVIDED = "samples at effort 1"
"""Setting of a point of another effort: the number of intervals into which its length is divided."""
EQUILIBRATION_KEY = describe(
    NOT_NEGATIVE,
    "time before the length, in the same unit; rounded up to whole samples, which are not measured",
    default=0,
)
SCAN_TIME_STEPS = list_of(
    POSITIVE,
    "time steps that one job runs in turn; the length of the run is in multiples of `time_step`",
    default=None,
)


def intervals(point: Point) -> dict:
    """Return the arguments of a job that divides its run into `samples` intervals. The run follows the
    equilibration.
    """
    times = point.schedule
    return {
        "equilibration": times.equilibration,
        "interval": times.sample_interval,
        "samples": times.samples,
    }
