"""Measurement of observables by name, and restriction of a run to an end time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

from gaspart import analysis
from gaspart.analysis.observables import OBSERVABLES, observable_name, require_selection
from gaspart.errors import SceneError

if TYPE_CHECKING:
    import xarray as xr

    from gaspart.analysis.observable import Observable
    from gaspart.analysis.run import Source


@overload
def measure(
    source: Source, observable: str, start: float | None = ..., end: float | None = ..., **selection: Any
) -> Observable: ...


@overload
def measure(
    source: Source,
    observable: Sequence[str],
    start: float | None = ...,
    end: float | None = ...,
    **selection: Any,
) -> dict[str, Observable]: ...


def measure(
    source: Source,
    observable: str | Sequence[str],
    start: float | None = None,
    end: float | None = None,
    **selection: Any,
) -> Observable | dict[str, Observable]:
    """Measure one or several observables of a trajectory or a simulation by name.

    Parameters
    ----------
    source : path, xarray.Dataset or Simulation
        A trajectory (a path or an open trajectory), or a simulation.
    observable : str or sequence of str
        Names as in `gaspart measure`, such as "pressure"; aliases are accepted, such as "viscosity".
    start : float, [time], optional
        Frames before this time are discarded. Default: the first quarter of the frames.
    end : float, [time], optional
        Frames after this time are discarded. Default: none.
    **selection
        Selections that the observables accept, such as species=1 or axis="x".

    Returns
    -------
    Observable or dict
        The measured quantity with its uncertainty. For several names, the result is a dict {name:
        Observable}.

    Raises
    ------
    SceneError
        If a name is unknown, if the observable does not accept a selection, if fewer than two frames remain,
        or if the scene or the run does not have the data that the observable needs.

    Examples
    --------
    >>> import gaspart as gp
    >>> scene = gp.Scene(
    ...     container=gp.Container(lengths=(10.0, 10.0), boundary="periodic"),
    ...     species=[gp.Species(count=32, radius=0.5, temperature=1.0, exact_temperature=True)],
    ... )
    >>> simulation = gp.Simulation(scene, seed=1)
    >>> simulation.advance(40.0)
    >>> measured = gp.measure(simulation, ["Z", "collision_rate"])
    >>> list(measured)
    ['Z', 'collision_rate']
    """
    if not isinstance(observable, str):
        names = [observable_name(name) for name in observable]
        with open_frames(source, any(OBSERVABLES[name].needs == "pairs" for name in names)) as data:
            return {name: measure(data, name, start, end, **selection) for name in names}
    name = observable_name(observable)
    declared = OBSERVABLES[name]
    require_selection(name, selection)
    function = getattr(analysis, declared.function)
    with until_time(source, end, declared.needs == "pairs") as part:
        result: Observable = function(part, start=start, **declared.arguments, **selection)
    return result


@contextmanager
def until_time(source: Source, end: float | None, pairs: bool = False) -> Iterator[Source]:
    """Return the frames of a source up to the time `end`.

    Without an end time, the source itself is returned.

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
    """Yield the frames of a source; they are read or computed only once.

    Parameters
    ----------
    source : str, Path, Dataset or Simulation
        A trajectory (a path or an open trajectory), or a simulation.
    pairs : bool, default False
        For a simulation, also count the collisions of each pair of species.

    Yields
    ------
    Dataset
        The frames. If the source is a file, it is closed at the end of the `with` block.
    """
    from gaspart.analysis.run import repeat_run
    from gaspart.simulation import Simulation
    from gaspart.trajectory.reading import open_trajectory

    if isinstance(source, Simulation):
        source = repeat_run(source, pairs)
    with open_trajectory(source) if isinstance(source, str | Path) else nullcontext(source) as data:
        yield data
