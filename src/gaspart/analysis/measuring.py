"""An observable of a trajectory, by its name, and the part of a run until a time."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaspart import analysis
from gaspart.analysis.observables import OBSERVABLES, known, require_selection
from gaspart.errors import SceneError

if TYPE_CHECKING:
    from gaspart.analysis.observable import Observable
    from gaspart.analysis.run import Source


def measure(
    source: Source, observable: str, start: float | None = None, end: float | None = None, **selection: Any
) -> Observable:
    """An observable of a trajectory (its path, or an open one) or a simulation, by its name as on the command
    line: `measure("run.nc", "pressure")`.

    start, and what `selection` states, such as species=1 or axis="x" (see `Named.selections`): as of the
    functions of `gaspart.analysis`; end: the time until which frames count, by default all. Without a start
    the first quarter of what is left does not count. Raises SceneError for an unknown name, a selection that
    the observable does not have, as `until_time` and as that function does."""
    one = OBSERVABLES[known(observable)]
    require_selection(observable, selection)
    function = getattr(analysis, one.function)
    with until_time(source, end, one.needs == "pairs") as part:
        found: Observable = function(part, start=start, **one.arguments, **selection)
    return found


@contextmanager
def until_time(source: Source, end: float | None, pairs: bool = False) -> Iterator[Source]:
    """The frames of a source until a time, whatever it is; itself if the time is None. pairs: whether those
    of a simulation count the collisions of each pair of species. Raises SceneError for fewer than two."""
    if end is None:
        yield source
        return
    from gaspart.analysis.run import repeated
    from gaspart.keys.values import number
    from gaspart.simulation import Simulation
    from gaspart.trajectory.reading import open_trajectory

    if isinstance(source, Simulation):
        source = repeated(source, pairs)
    with open_trajectory(source) if isinstance(source, str | Path) else nullcontext(source) as data:
        time = data["time"].values
        last = number("end", end, "must be a finite number")
        count = int((time <= last + 1e-9 * abs(last)).sum())
        if count < 2:
            longest = float(time[-1]) if len(time) else 0.0
            raise SceneError("end", end, f"leaves {count} frames of a run until time {longest:g}")
        yield data.isel(frame=slice(count))
