"""The data of a job of a grid point, and their file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from gaspart.engines import engine_from_dict, engine_to_dict
from gaspart.keys import NOT_NEGATIVE, POSITIVE, describe, list_of
from gaspart.scene.scene import Scene
from gaspart.trajectory.until import Until

if TYPE_CHECKING:
    from gaspart.reproduction.points.point import Point


_NONE: Mapping = MappingProxyType({})


class PointData(NamedTuple):
    """Variables, coordinates and attributes, as xarray.Dataset takes them: `xr.Dataset(*data)`.

    variables, coordinates : by name, their dimensions (one name, or several), values (numbers or words), and
        attributes if there are any.

    Jobs neither make nor write data sets of xarray, which takes a quarter of a second to load: most of them
    are short timings, at the same time as which nothing may run.
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


# Common to jobs that run a scene: keys, and the division of a run into intervals.


SLACK = 1e-6
"""Part of a time step by which a run is longer, so that rounding of its duration loses no step."""
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
    """Return the arguments of a job that divides its run into `samples` intervals.

    The run follows the equilibration.
    """
    times = point.schedule
    return {
        "equilibration": times.equilibration,
        "interval": times.sample_interval,
        "samples": times.samples,
    }


# The arguments of a job's function in plain values, which decide whether the job runs again.
#
# A job sees its arguments only. So its result depends on nothing of a point that the plain values lack:
# neither on the point's name, nor on the modules that make a scene, an engine and a schedule of its
# settings.


_FORMS: dict[str, tuple[Callable[[Any], Any], Callable[[Any], Any]]] = {
    "scene": (Scene.to_dict, Scene.from_dict),
    "engine": (engine_to_dict, engine_from_dict),
    "engines": (
        lambda engines: [engine_to_dict(engine) for engine in engines],
        lambda values: [engine_from_dict(value) for value in values],
    ),
    "seed": (list, tuple),
    "seeds": (
        lambda seeds: [list(seed) for seed in seeds],
        lambda values: [tuple(value) for value in values],
    ),
    "until": (asdict, Until.from_dict),
    "rival": (lambda rival: to_plain(rival), lambda values: from_plain(values)),
}
"""Conversions to plain values, and back, by the name of an argument; other arguments are plain."""


def to_plain(arguments: dict[str, Any]) -> dict[str, Any]:
    """Convert scenes, engines, tuples and endings to numbers, text, lists and mappings."""
    return _convert(arguments, 0)


def from_plain(values: dict[str, Any]) -> dict[str, Any]:
    """Convert the result of `to_plain` back.

    Raises SceneError for a scene or an engine that another version made.
    """
    return _convert(values, 1)


def _convert(arguments: dict[str, Any], direction: int) -> dict[str, Any]:
    return {
        name: _FORMS[name][direction](value) if name in _FORMS and value is not None else value
        for name, value in arguments.items()
    }
