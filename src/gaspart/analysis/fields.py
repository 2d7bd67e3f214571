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
    """A property of the moving particles in equal cells along axes, ("x", "y"), mean over all frames.

    of: "density", particles per volume of the cell within the container of the moment (faces may move);
    "velocity", their mean velocity, ("component", "x", "y"); "temperature", twice their kinetic energy per
    degree of freedom about the local flow of mass: in these cells, and across faces that slide; before faces
    that move along their normal in layers of each frame (see `gaspart.analysis.flow`). NaN in cells that were
    always empty. Errors are as of `profile`, and so is the density along one axis of a run that has kept its
    impulses. axes: such as "xy", by default the first two;
    cells: their number, of each axis; along the other axes a cell is as long as the container. start: the
    time from which frames count (by default a quarter of the run); species: of one alone, by its number in
    the scene.

    Raises SceneError for an unknown property or axis, a file without all particles, and too few frames.
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
