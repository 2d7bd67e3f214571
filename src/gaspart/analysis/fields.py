"""Fields: density, flow velocity and temperature in cells along one or more axes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from gaspart.analysis.expected.equilibrium import describe
from gaspart.analysis.impulses import described_density, mixed_density
from gaspart.analysis.observable import Observable, observable, with_freedom
from gaspart.analysis.observables import require_defined
from gaspart.analysis.profiles import Cells, Means
from gaspart.analysis.run import Run, Source, open_run, select_particles
from gaspart.errors import SceneError
from gaspart.keys.values import count_of, one_of
from gaspart.scene.faces import GRADIENT
from gaspart.scene.scene import Scene

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

    For the temperature, the local flow is computed in the same cells and, between sliding faces, also
    resolved along the axis across them. If faces move along their normal, the flow is computed in layers of
    each frame (see `gaspart.analysis.flow`). Errors are defined as in `profile`. If the run has stored
    impulses, the density along one axis is also computed as in `profile`.

    Parameters
    ----------
    of : {"density", "velocity", "temperature"}, default "density"
        "density": number of particles divided by the volume of the cell. If faces move, only the part of the
        cell inside the container counts. "velocity": mean velocity. "temperature": twice the kinetic energy
        per degree of freedom, relative to the local mass-weighted flow.
    axes : str, optional
        Axes, such as "xy". Default: the first two.
    cells : int or sequence of int, default 20
        Number of cells along each of the `axes`. Along all other axes each cell extends over the whole
        container.

    Returns
    -------
    Observable
        Mean over all frames, with the `axes` as dimensions, such as ("x", "y"); for a velocity ("component",
        "x", "y"). The value is NaN in cells that were empty in all frames.

    Raises
    ------
    SceneError
        If the property or an axis is unknown, the file does not contain all particles, or there are too few
        frames.

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
        members = np.flatnonzero(run.moving)[select_particles(run, species, None)]
        cells = Cells(run, members, tuple(along), tuple(numbers))
        means, attributes = None, dict[str, str]()
        if of == "density" and len(along) == 1:
            means = mixed_density(run, along[0], numbers[0], species)
            attributes = described_density(run, along[0], numbers[0], means is not None)
        if means is None:
            means = cells.temperature(local=True) if of == "temperature" else getattr(cells, of)()
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
        result = observable(of, coordinates, means.values, means.errors, units=units, long_name=name)
        result.attrs |= attributes
        return with_freedom(result, means.freedoms)


def _axes(run: Run, axes: str | None) -> list[int]:
    """Return the indices of axes from their names; raise SceneError for unknown axes."""
    names = "xyz"[: run.dimension]
    requested = "xy" if axes is None else axes
    if not requested or len(set(requested)) < len(requested) or not set(requested) <= set(names):
        raise SceneError("axes", requested, f"must be some of {names}, each once")
    return [names.index(axis) for axis in requested]


def _numbers(cells: int | Sequence[int], axes: int) -> list[int]:
    """Return the number of cells along each axis; raise SceneError for invalid numbers."""
    each = [cells] * axes if isinstance(cells, int) else list(cells)
    if len(each) != axes:
        raise SceneError("cells", each, f"must be one number, or {axes}")
    return [count_of("cells", number, least=1) for number in each]


# Mean velocity of a gas along an axis.


def _across(scene: Scene) -> int:
    """Return the last axis along which the flow of a scene varies; without one, the last axis."""
    if scene.shear_rate is not None:
        return GRADIENT
    return (scene.flow_axes or (scene.dimension - 1,))[-1]


def velocity_profile(
    source: Source,
    axis: str | None = None,
    species: int | None = None,
    bins: int = 40,
    start: float | None = None,
) -> Observable:
    """Measure the profile of the mean velocity of the moving particles along an axis.

    All particles have equal weight in the mean, whatever their masses. For sheared gases and between sliding
    walls the velocity is relative to the scene's frame of reference. Uncertainties are defined as in `field`.

    Theory exists in four cases. For sheared images it is their linear flow. Between sliding plates it is free
    molecular flow above a Knudsen number of 100, and a linear flow with slip below 0.1. For dilute spheres
    that a force drives along plates it is a parabolic flow, also below 0.1. In equilibrium the velocity is
    everywhere equal to the velocity of the centre of mass.

    Parameters
    ----------
    axis : {"x", "y", "z"}, optional
        The axis. Default: the last one along which the flow varies, otherwise the last one.

    Returns
    -------
    Observable
        Mean velocity (component, position) in [length/time]. The value is NaN in bins that were empty in all
        frames.

    Raises
    ------
    SceneError
        If the axis is unknown, the species does not move, the file does not contain all particles, or there
        are too few frames.
    """
    with open_run(source, start, sheared=True, varying=True) as run:
        require_defined("velocity", run.scene, axis=axis, species=species)
        name = "xyz"[_across(run.scene)] if axis is None else axis
        result = field(run.data, "velocity", name, bins, float(run.time[0]), species)
        positions = result[name].values
        along = {
            "component": (result["component"].values, {"long_name": "component"}),
            "position": (positions, {"units": "length", "long_name": name}),
        }
        about = describe("velocity", run, "xyz".index(name), positions)
        means = Means(result.estimate.values, result.error.values, result["velocity_freedom"].values)
        return with_freedom(
            observable("velocity", along, means.values, means.errors, **about), means.freedoms
        )
