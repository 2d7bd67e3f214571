"""Frames of a source, and an observable that is measured from them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaspart import analysis
from gaspart.analysis.observables import OBSERVABLES, require_selection
from gaspart.errors import SceneError

if TYPE_CHECKING:
    import xarray as xr

    from gaspart.analysis.observable import Observable
    from gaspart.analysis.run import Source


def measure_single(
    source: Source, name: str, start: float | None = None, end: float | None = None, **selection: Any
) -> Observable:
    """Measure an observable of one run by its name, without a remark on drifts; see `measuring.measure`."""
    declared = OBSERVABLES[name]
    require_selection(name, selection)
    function = getattr(analysis, declared.function)
    with until_time(source, end, declared.needs == "pairs") as part:
        result: Observable = function(part, start=start, **declared.arguments, **selection)
    return result


@contextmanager
def until_time(source: Source, end: float | None, pairs: bool = False) -> Iterator[Source]:
    """Return the frames of a source up to the time `end`. Without an end time, the source itself is returned.
    If `pairs` is True, the frames of a simulation include the numbers of collisions of each pair of species.
    Raises SceneError for fewer than two frames.
    """
    if end is None:
        yield source
        return
    from gaspart.keys.values import number

    with open_frames(source, pairs) as data:
        time = data["time"].values
        last = number("end", end, "must be a finite number")
        count = int((time <= last + 1e-9 * abs(last)).sum())
        if count < 2:
            longest = float(time[-1]) if len(time) else 0.0
            raise SceneError("end", end, f"leaves {count} frames of a run until time {longest:g}")
        yield data.isel(frame=slice(count))


@contextmanager
def open_frames(source: Source, pairs: bool = False) -> Iterator[xr.Dataset]:
    """Yield the frames of a source; they are read or computed only once."""
    from gaspart.analysis.run import repeat_run
    from gaspart.simulation import Simulation
    from gaspart.trajectory.reading import open_trajectory

    if isinstance(source, Simulation):
        source = repeat_run(source, pairs)
    with open_trajectory(source) if isinstance(source, str | Path) else nullcontext(source) as data:
        yield data
