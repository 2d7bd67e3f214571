"""Fields: density, flow and temperature in cells along one or more axes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from gaspart.analysis.impulses import described_density, mixed_density
from gaspart.analysis.observable import Observable, observable
from gaspart.analysis.profiles import Cells, with_freedom
from gaspart.analysis.run import Run, Source, open_run, selected
from gaspart.errors import SceneError
from gaspart.keys.values import count_of, one_of

QUANTITIES = ("density", "velocity", "temperature")


def field(
    source: Source,
    of: str = "density",
    axes: str | None = None,
    cells: int | Sequence[int] = 20,
    start: float | None = None,
    species: int | None = None,
) -> Observable:
    """Measure a property of the moving particles in equal cells along axes.

    Parameters
    ----------
    source : str, Path, Dataset or Simulation
        A trajectory, by its path or open, or a simulation.
    of : {"density", "velocity", "temperature"}, default "density"
        "density": particles per volume of the cell within the container of the moment (faces may move).
        "velocity": mean velocity. "temperature": twice the kinetic energy per degree of freedom about the
        local flow of mass.
    axes : str, optional
        Axes, such as "xy". Default: the first two.
    cells : int or sequence of int, default 20
        Number of cells, of each axis. Along the other axes a cell is as long as the container.
    start : float, [time], optional
        Frames before this time are discarded. Default: a quarter of the run.
    species : int, optional
        Only this species, by its number in the scene.

    Returns
    -------
    Observable
        Mean over all frames, ("x", "y"), of the velocity ("component", "x", "y"). NaN in cells that were
        always empty.

    Raises
    ------
    SceneError
        If the property or an axis is unknown, the file lacks particles, or there are too few frames.

    Notes
    -----
    The flow of a temperature is taken in these cells, and across faces that slide; before faces that move
    along their normal in layers of each frame (see `gaspart.analysis.flow`). Errors are as of `profile`, and
    so is the density along one axis of a run that has stored its impulses.

    Examples
    --------
    >>> import gaspart as gp
    >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)])
    >>> simulation = gp.Simulation(scene, seed=1)
    >>> simulation.advance(40.0)
    >>> gp.analysis.field(simulation, axes="xy", cells=3).estimate.dims
    ('x', 'y')
    """
    one_of("of", of, QUANTITIES)
    with open_run(source, start, sheared=True, varying=True) as run:
        along = _axes(run, axes)
        numbers = _numbers(cells, len(along))
        members = np.flatnonzero(run.moving)[selected(run, species, None)]
        cells = Cells(run, members, tuple(along), tuple(numbers))
        found, attributes = None, dict[str, str]()
        if of == "density" and len(along) == 1:
            found = mixed_density(run, along[0], numbers[0], species)
            attributes = described_density(run, along[0], numbers[0], found is not None)
        if found is None:
            found = cells.temperature(local=True) if of == "temperature" else getattr(cells, of)()
        coordinates: dict[str, Any] = {}
        if of == "velocity":
            coordinates["component"] = (np.array(list("xyz"[: run.dimension])), {"long_name": "component"})
        for k, middle in zip(along, cells.grid.middles, strict=True):
            coordinates["xyz"[k]] = (middle, {"units": "length", "long_name": "xyz"[k]})
        units, name = {
            "density": (f"1 / length^{run.dimension}", "number density"),
            "velocity": ("length / time", "velocity"),
            "temperature": ("energy", "temperature"),
        }[of]
        result = observable(of, coordinates, found.values, found.errors, units=units, long_name=name)
        result.attrs |= attributes
        return with_freedom(result, found)


def _axes(run: Run, axes: str | None) -> list[int]:
    """The numbers of the named axes. Raises SceneError."""
    names = "xyz"[: run.dimension]
    wanted = "xy" if axes is None else axes
    if not wanted or len(set(wanted)) < len(wanted) or not set(wanted) <= set(names):
        raise SceneError("axes", wanted, f"must be some of {names}, each once")
    return [names.index(axis) for axis in wanted]


def _numbers(cells: int | Sequence[int], axes: int) -> list[int]:
    """The number of cells along each axis. Raises SceneError."""
    each = [cells] * axes if isinstance(cells, int) else list(cells)
    if len(each) != axes:
        raise SceneError("cells", each, f"must be one number, or {axes}")
    return [count_of("cells", number, least=1) for number in each]
