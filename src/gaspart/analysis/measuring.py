"""Measurement of observables by name, with a remark if the run drifts."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

from gaspart.analysis.combination import replicas
from gaspart.analysis.drift import drift_of
from gaspart.analysis.observables import OBSERVABLES, observable_name
from gaspart.analysis.run import measure_single, open_frames, until_time
from gaspart.errors import SceneError
from gaspart.trajectory.replicas import run_files

if TYPE_CHECKING:
    from gaspart.analysis.observable import Observable
    from gaspart.analysis.run import Source


@overload
def measure(
    source: Source | Sequence[Source],
    observable: str,
    start: float | None = ...,
    end: float | None = ...,
    **selection: Any,
) -> Observable: ...


@overload
def measure(
    source: Source | Sequence[Source],
    observable: Sequence[str],
    start: float | None = ...,
    end: float | None = ...,
    **selection: Any,
) -> dict[str, Observable]: ...


def measure(
    source: Source | Sequence[Source],
    observable: str | Sequence[str],
    start: float | None = None,
    end: float | None = None,
    **selection: Any,
) -> Observable | dict[str, Observable]:
    """Measure one or several observables of a trajectory or a simulation by name.

    Parameters
    ----------
    source : path, xarray.Dataset, Simulation, or sequence of these
        A trajectory (a path or an open trajectory), or a simulation. Of several runs, and of the path of a
        run with replicas, the mean is measured (see `analysis.replicas`).
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
        Observable}. If the run drifts in its measured part, the attribute `drift` says what drifts.

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
    third: object = start
    if isinstance(third, str):
        rule = f"must be a time; several observables are a list, such as {[observable, third]}"
        raise SceneError("start", third, rule)
    names = [observable] if isinstance(observable, str) else list(observable)
    names = [observable_name(name) for name in names]
    runs: list[Source] = [source]  # type: ignore[list-item]
    if isinstance(source, str | Path):
        runs = [*run_files(source)]
    elif isinstance(source, list | tuple):
        runs = [*source]
    if len(runs) != 1:
        results = {name: replicas(name, runs, start, end, **selection) for name in names}
    else:
        with open_frames(runs[0], any(OBSERVABLES[name].needs == "pairs" for name in names)) as data:
            results = {name: measure_single(data, name, start, end, **selection) for name in names}
            with until_time(data, end) as part:
                drift = drift_of(part, start=start)
        for result in results.values():
            result.attrs |= {"drift": drift} if drift else {}
    return results[names[0]] if isinstance(observable, str) else results
