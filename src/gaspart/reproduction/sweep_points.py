"""Making the points of a sweep: in this process, or in several.

A point that cannot be made costs no other one: the reason is kept in place of its trajectories. What concerns
the files of all, such as a full disk or a trajectory of another sweep, ends the sweep instead.
"""

from __future__ import annotations

import numbers
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence, Set
from contextlib import suppress
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from gaspart.analysis.observables import observable_name
from gaspart.errors import SceneError, SimulationError
from gaspart.files import only_process
from gaspart.kernels.compile.cache import load_numba
from gaspart.reproduction.config import check_values
from gaspart.reproduction.jobs.replicas import replica_paths, write_replicas
from gaspart.reproduction.jobs.simulate import recipes, record
from gaspart.reproduction.points.point import Point, compile_kernels, compile_task, variant
from gaspart.reproduction.points.points import MOST_POINTS
from gaspart.workers import in_processes, require_processes


def make_all(
    points: Sequence[Point], workers: int, overwrite: bool, report: Callable[[Point, str], None]
) -> None:
    """Make the trajectories of all points, and call report(point, reason) for each.

    The reason states why it could not be made, or is "". Points whose trajectories exist come first: a
    conflict is then found before anything is run. Raises SceneError for files that cannot be written or are
    of another sweep.
    """
    ordered = sorted(points, key=lambda point: not Path(point.path).exists())
    if workers == 1:
        for point in ordered:
            report(point, make(point, overwrite))
        return
    require_processes("workers", workers)
    for representative in {
        variant(point): point for point in ordered
    }.values():  # or each process would compile them
        with suppress(SceneError, SimulationError):  # of its own point alone
            compile_kernels(compile_task(representative))
    calls = [(point.to_dict(), point.path, overwrite) for point in ordered]
    in_processes(_make_in_process, calls, workers, lambda n, reason: report(ordered[n], str(reason)))


def make(point: Point, overwrite: bool) -> str:
    """Make the trajectories of a point, or check those in its folder.

    Returns the reason why it could not be done, or "". Raises SceneError for files; see `make_all`.
    """
    folder = Path(point.path)
    try:
        all_recipes = recipes(**point.arguments)
        with only_process(folder, wait=True):
            if not folder.exists():
                write_replicas(record, all_recipes, folder, None, overwrite)
                return ""
            for path, recipe in zip(replica_paths(folder, len(all_recipes)), all_recipes, strict=True):
                record(recipe, path, overwrite)
    except OSError as error:
        rule = f"cannot be written: {error.strerror}"
        raise SceneError(f"{point.experiment}[{point.name}].path", str(folder), rule) from None
    except SceneError as error:
        if error.key == "path":
            raise error.inside(f"{point.experiment}[{point.name}]") from None
        return str(error)
    except SimulationError as error:
        return str(error)
    except MemoryError:
        return "there is not enough memory"
    return ""


def _make_in_process(tell: Callable[[Any], None], values: dict, path: str, overwrite: bool) -> str:
    """Make a point, given as a dictionary, in a process of its own; see `make`."""
    load_numba(ours=True)
    return make(Point.from_dict(values, path), overwrite)


# The request of a sweep: the values of each key that varies, and the observables, as plain values.


_SAME_FOR_ALL = (
    *("duration", "until", "at_most", "samples", "equilibration", "correlations", "replicas"),
    *("seed", "workers", "engine", "observables", "scene"),
)
"""Arguments of a sweep, which are no keys."""


def axes_of(over: object) -> dict[str, list]:
    """Return the values of each key that varies, as Python's own numbers, words and lists.

    A single value counts as a list of one. Raises SceneError.
    """
    if not isinstance(over, Mapping):
        rule = "must be a mapping from each key that varies to its values, such as {'count': [50, 100]}"
        raise SceneError("over", over, rule)
    axes = {}
    for key, values in over.items():
        if not isinstance(key, str):
            raise SceneError("over", key, "a key must be text, such as 'packing_fraction'")
        if key in _SAME_FOR_ALL:
            rule = "is an argument of a sweep and the same for all points"
            raise SceneError(f"over.{key}", values, rule + ("; replicas differ by it" * (key == "seed")))
        axes[key] = _values(f"over.{key}", values)
    check_values({"over": axes})
    for key, listed in axes.items():
        _refuse_repeated(f"over.{key}", listed)
    return axes


def names_of(observables: object, axes: Mapping[str, list]) -> list[str]:
    """Return the observables, each once; a single name counts as a list of one; raise SceneError."""
    listed = [observables] if isinstance(observables, str) else observables
    if not isinstance(listed, Iterable) or isinstance(listed, bytes | Mapping):
        raise SceneError("observables", observables, "must be the names of observables")
    names = list(dict.fromkeys([observable_name(name) for name in listed]))
    for name in names:
        if name in axes:
            rule = f"is also a key that varies: vary species.0.{name} instead"
            raise SceneError("observables", name, rule)
    return names


def _values(where: str, values: Any) -> list:
    """Return the values of a key; raise SceneError for too many, or an iterator that fails."""
    plain = _plain(values)
    if isinstance(plain, str | bytes | Mapping) or not isinstance(plain, Iterable):
        return [plain]
    try:
        listed = list(islice(plain, MOST_POINTS + 1))
    except Exception:  # an iterator of the user's own
        raise SceneError(where, values, "must be a list of values") from None
    if len(listed) > MOST_POINTS:
        raise SceneError(where, len(listed), f"a grid may have {MOST_POINTS} points")
    if not listed:
        raise SceneError(where, listed, "must not be empty")
    return [_plain(value) for value in listed]


def _plain(value: Any) -> Any:
    """Convert numbers and arrays of numpy, and convertible objects, to Python's own."""
    if hasattr(value, "__array__"):
        value = np.asarray(value).tolist()
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, str | bytes | range):
        return [_plain(item) for item in value]
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        return value
    return int(value) if isinstance(value, numbers.Integral) else float(value)


def _refuse_repeated(where: str, values: list) -> None:
    """Raise SceneError for a value that is there twice, also as 1 and as 1.0."""
    seen = set()
    for value in values:
        key = _hashable(value)
        if key in seen:
            raise SceneError(where, value, "is there twice: every point of a grid must be different")
        seen.add(key)


def _hashable(value: Any) -> Hashable:
    if isinstance(value, Mapping):
        return tuple((key, _hashable(item)) for key, item in value.items())
    if isinstance(value, list | Set):
        return tuple(_hashable(item) for item in value)
    return value if isinstance(value, Hashable) else repr(value)
