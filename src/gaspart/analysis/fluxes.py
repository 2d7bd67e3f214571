"""Heat and tangential momentum transferred from a gas to the thermal walls of its container."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from gaspart.analysis.conditions import walled_axis_of
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.expected.equilibrium import describe
from gaspart.analysis.flow import per_area
from gaspart.analysis.observable import LEAST_INTERVALS, Observable, observable, scalar, with_freedom
from gaspart.analysis.observables import require_defined
from gaspart.analysis.profiles import Means
from gaspart.analysis.run import Run, Source, open_run, select_particles
from gaspart.analysis.statistics import correlated_mean
from gaspart.errors import SceneError
from gaspart.scene.faces import Open
from gaspart.scene.scene import Scene
from gaspart.scene.surfaces import FACES
from gaspart.trajectory.amber import face_names

_BLOCKS = 4096


def heat_flux(source: Source, start: float | None = None) -> Observable:
    """Measure the heat flux into each face that has a temperature.

    The heat is the energy that particles lose in the rest frame of the wall. For a sliding wall, the heat is
    the energy that the wall receives plus the work that the wall does on the gas. The result is the mean flux
    of the steady state. The energy of the gas and the first moment of this energy across the walls are
    bounded. The contributions of their changes are subtracted (`_mean_without_stores`).

    The theoretical flux is 0 in equilibrium. Between two plates it is the flux of free molecular flow above a
    Knudsen number of 100. Below 0.1 it follows from Fourier's law with Enskog's conductivity and temperature
    jumps. Between these limits it is an interpolation with an accuracy of 8 % (`heat.interpolated_flux`).
    Between sliding plates it is half of the power of the stress. With partial accommodation, theory exists
    only for free molecular flow.

    Returns
    -------
    Observable
        Heat that each face (face,) receives per time and accessible area, in [energy/(length^(d-1) time)].
        The flux is positive if the gas heats the wall. The documentation of `wall_pressure` defines the area.

    Raises
    ------
    SceneError
        If no face has a temperature, if there are too few frames, or if no particle hit these faces.

    Examples
    --------
    >>> import gaspart as gp
    >>> faces = {"x_low": gp.Thermal(1.0), "x_high": gp.Thermal(2.0)}
    >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)], faces=faces)
    >>> simulation = gp.Simulation(scene, seed=1)
    >>> simulation.advance(40.0)
    >>> gp.analysis.heat_flux(simulation).face.values.tolist()
    ['x low', 'x high']
    """
    with open_run(source, start, varying=True) as run:
        require_defined("heat_flux", run.scene)
        faces = np.array(run.scene.thermal_numbers)
        heat = _amounts_per_area(run, "wall_energy", "heat_per_area")
        for number, face in run.scene.sliding_faces:
            heat[:, number] -= _amounts_per_area(run, "wall_shear", "momentum_per_area")[
                :, number
            ] @ np.array(face.velocity)
        means = _steady(run, faces, heat[:, faces], _energies(run))
        along = {"face": (np.array(face_names(run.dimension))[faces], {"long_name": "face of the container"})}
        about = describe("heat_flux", run, faces)
        return with_freedom(
            observable("heat_flux", along, means.values, means.errors, **about), means.freedoms
        )


def wall_shear(source: Source, start: float | None = None) -> Observable:
    """Measure the shear stress on each face that changes tangential velocities.

    Only some engines tally the tangential momentum. They tally it for faces that slide and for faces along
    which a force drives the gas. As in `heat_flux`, the result is the mean of the steady state. The
    contribution of the change of the gas momentum is subtracted.

    If a force drives a gas along two identical faces, the theoretical force on each face is exactly half of
    the force on the gas. Between sliding plates above a Knudsen number of 100, the theoretical stress is
    computed for free molecular flow. Below 0.1 it follows from Enskog's viscosity with slip. Between these
    limits it is an interpolation with an accuracy of 8 % (`shear.interpolated_stress`). With partial
    accommodation, theory exists only for free molecular flow.

    Returns
    -------
    Observable
        Momentum that each face receives along each axis per time and accessible area, (face, component), in
        [energy/length^d]. The normal component is NaN; `wall_pressure` measures it.

    Raises
    ------
    SceneError
        If no face exerts a tangential force, if there are too few frames, or if no particle hit these faces.
    """
    with open_run(source, start) as run:
        require_defined("wall_shear", run.scene)
        faces = np.array(run.scene.drawing_numbers)
        axes = np.array([axis for axis in range(run.dimension) if (faces // 2 != axis).any()])
        momentum = _amounts_per_area(run, "wall_shear", "momentum_per_area")[:, faces][..., axes]
        parts = [_steady(run, faces, momentum[..., n], _momenta(run, axis)) for n, axis in enumerate(axes)]
        across = faces[:, None] // 2 == axes
        columns = {key: np.stack([getattr(part, key) for part in parts], axis=1) for key in vars(parts[0])}
        means = Means(**{key: np.where(across, np.nan, each) for key, each in columns.items()})
        along = {
            "face": (np.array(face_names(run.dimension))[faces], {"long_name": "face of the container"}),
            "component": (np.array(list("xyz"))[axes], {"long_name": "axis along the face"}),
        }
        about = describe("wall_shear", run, faces, axes)
        return with_freedom(
            observable("wall_shear", along, means.values, means.errors, **about), means.freedoms
        )


def _amounts_per_area(run: Run, name: str, tallied: str) -> np.ndarray:
    """Return the amounts (T - 1, 2d, ...) that faces receive per accessible area, as `per_area`."""
    if name not in run.data:
        raise SceneError(name, "missing", "the engine does not tally it, or an older version wrote the file")
    return per_area(run, run.increments(name)[:, : 2 * run.dimension], tallied)


def _steady(run: Run, faces: np.ndarray, amounts: np.ndarray, stored: list[np.ndarray]) -> Means:
    """Compute the time average of the amount that each face receives, and its error, shape (F,). `amounts`:
    (T - 1, F), amounts in each interval. `stored`: arrays (T,) of bounded sums over the gas. The average is
    corrected for their changes in each block. Raises SceneError for too few frames and for faces that no
    particle hit.
    """
    intervals = len(run.time) - 1
    if intervals < LEAST_INTERVALS:
        raise SceneError("frames", len(run.time), f"an error needs {LEAST_INTERVALS + 1} or more")
    if not run.growth("wall_hits")[faces].all():
        raise SceneError("wall_hits", 0, "nothing hit a thermal wall in the measured part; make a longer run")
    blocks = min(_BLOCKS, intervals)
    length = run.block_length(blocks)
    ends = slice(None, blocks * length + 1, length)
    grown = amounts[: blocks * length].reshape(blocks, length, -1).sum(axis=1)
    rates = grown / np.diff(run.time[ends])[:, None]
    changes = [np.diff(values[ends]) for values in stored]
    estimates = [_mean_without_stores(rate, changes) for rate in rates.T]
    columns = ([getattr(estimate, name) for estimate in estimates] for name in ("value", "error", "freedom"))
    return Means(*map(np.array, columns))


def _mean_without_stores(rates: np.ndarray, changes: list[np.ndarray]) -> Estimate:
    """Compute the mean of rates (K,) in blocks, corrected for changes of bounded sums. The blocks are
    consecutive. An amount that the gas stores in one block is later returned, so stored amounts do not change
    the long-time mean. The contribution of the changes (K,) of the bounded sums is removed by least squares.
    Blocks may be shorter than the correlation time. In free flight, the correlation time is the flight time
    from wall to wall. Therefore the error is computed as for a correlated series.
    """
    used = [change / np.abs(change).max() for change in changes if change.any()]
    design = np.stack([np.ones(len(rates)), *used], axis=1)
    slopes = np.linalg.lstsq(design, rates, rcond=None)[0][1:]
    return correlated_mean(rates - design[:, 1:] @ slopes, LEAST_INTERVALS).estimate


def _energies(run: Run) -> list[np.ndarray]:
    """Compute the translational energy (T,) relative to the faces and its first moments along their normals,
    if all are stored.
    """
    if run.is_subset:
        return []
    masses = run.masses[run.moving]
    return _with_moments(run, lambda part: 0.5 * (_about_faces(part) ** 2).sum(axis=2) * masses)


def _momenta(run: Run, axis: int) -> list[np.ndarray]:
    """Compute the momentum (T,) along `axis` relative to the faces, and its first moments along their
    normals.
    """
    if run.is_subset:
        return []
    masses = run.masses[run.moving]
    return _with_moments(run, lambda part: _about_faces(part)[..., axis] * masses)


def _about_faces(run: Run) -> np.ndarray:
    """Compute velocities (T, M, d) relative to the mean velocity of the thermal faces."""
    frame = np.zeros(run.dimension)
    for _, face in run.scene.sliding_faces:
        frame += np.array(face.velocity) / len(run.scene.thermal_numbers)
    return np.asarray(run.velocities[:, run.moving] - frame)


def _with_moments(run: Run, carried: Callable[[Run], np.ndarray]) -> list[np.ndarray]:
    """Sum an amount that particles carry, and its first moments across the thermal faces. `carried` returns
    the amounts (T, M) in a part of the run; each sum has the shape (T,). For the moments, positions are
    relative to the middle of the container.
    """
    across = sorted({number // 2 for number in run.scene.thermal_numbers})
    sums = []
    for _, part in run.parts():
        amounts = np.nan_to_num(carried(part))  # of absent particles
        places = part.positions[:, run.moving] - 0.5 * np.array(run.scene.container.lengths)
        places = np.nan_to_num(places)
        sums.append([amounts.sum(axis=1), *((amounts * places[..., axis]).sum(axis=1) for axis in across)])
    return list(np.concatenate(sums, axis=1))


# Particles that cross a plane in the container, or an opening between interior walls in the plane.


def particle_flux(
    source: Source,
    axis: str | None = None,
    at: float | None = None,
    species: int | None = None,
    start: float | None = None,
) -> Observable:
    """Measure the net number of particles per time that cross a plane across an axis.

    The flux is computed from the change of the number of particles beyond the plane. So it is exact, however
    often particles cross the plane between frames. Particles that cross and return do not count. Particles
    that enter or leave through an open face beyond the plane do not count either. The plane crosses the whole
    container. If interior walls lie in the plane, all particles pass through their openings.

    Without interior walls, the theoretical flux is 0 in a steady state. For openings between interior walls
    in the plane, theory exists in free molecular flow. The flux through the openings in each direction is n
    sqrt(k_B T / 2 pi m) times their area, where n is the density on the side from which the particles come.

    Parameters
    ----------
    axis : {"x", "y", "z"}, optional
        The axis. Default: the last axis with open faces, otherwise the last axis with walls.
    at : float, [length], optional
        Position of the plane along the axis. Default: the middle of the container.
    start : float, [time], optional
        Frames before this time are discarded; use 0 for a gas that flows out from the start. Default: a
        quarter of the run.

    Returns
    -------
    Observable
        The number of particles per time (component,), in [1/time]. It is positive if more particles cross the
        plane towards larger coordinates than towards smaller ones.

    Raises
    ------
    SceneError
        If the axis is periodic, because images of particles then cross the plane; if faces across another
        axis are open; if the plane is outside the container; if the file does not contain all particles; or
        if there are too few frames.

    Examples
    --------
    >>> import gaspart as gp
    >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)])
    >>> simulation = gp.Simulation(scene, seed=1)
    >>> simulation.advance(40.0)
    >>> gp.analysis.particle_flux(simulation, axis="x", at=3.0).estimate.attrs["units"]
    '1 / time'
    """
    with open_run(source, start, varying=True) as run:
        require_defined("flux", run.scene, axis=axis, at=at, species=species)
        number = walled_axis_of(run.scene, axis)
        position = 0.5 * run.scene.container.lengths[number] if at is None else float(at)
        members = np.flatnonzero(run.moving)[select_particles(run, species, None)]
        there = [(part.positions[:, members, number] > position).sum(axis=1) for _, part in run.parts()]
        beyond = np.concatenate(there) - _entered_beyond(run, number)
        if len(beyond) <= LEAST_INTERVALS:
            raise SceneError("frames", len(beyond), f"an error needs {LEAST_INTERVALS + 1} or more")
        estimate = correlated_mean(np.diff(beyond) / np.diff(run.time), LEAST_INTERVALS).estimate
        along = {"component": (np.array(["xyz"[number]]), {"long_name": "axis"})}
        about = describe("flux", run, number, position, members, beyond)
        means = Means(*(np.array([each]) for each in (estimate.value, estimate.error, estimate.freedom)))
        return with_freedom(observable("flux", along, means.values, means.errors, **about), means.freedoms)


def _entered_beyond(run: Run, axis: int) -> np.ndarray | int:
    """Return the net number (T,) of particles that have entered through the upper face; 0 if it is closed."""
    upper = 2 * axis + 1
    if not isinstance(run.scene.faces.get(FACES[upper]), Open):
        return 0
    return np.asarray(run.data["entries"].values[:, upper] - run.data["wall_hits"].values[:, upper])


# The number of particles in a container with open faces.


def particle_numbers(scene: Scene, data: xr.Dataset) -> np.ndarray:
    """Return the number of particles in each frame: the initial ones plus entered minus left."""
    opened = [number for number, _ in scene.faces_of(Open)]
    moved = data["entries"].values.sum(axis=1) - data["wall_hits"].values[:, opened].sum(axis=1)
    return np.asarray(scene.count + moved).astype(np.int64)


def particle_number(source: Source, start: float | None = None) -> Observable:
    """Measure the mean number of particles inside a container with open faces.

    Without collisions, correlations decay as slowly as 1/t. Therefore the error is computed by
    `gaspart.analysis.statistics.slow_mean`.

    Returns
    -------
    Observable
        The mean number in the frames, dimensionless.

    Raises
    ------
    SceneError
        If the scene has no open faces, or there are too few frames.
    """
    with open_run(source, start, varying=True) as run:
        require_defined("number", run.scene)
        counts = particle_numbers(run.scene, run.data)
        series = counts[1:].astype(float)
        return scalar("particle_number", series, run.time, slow=True, **describe("number", run))
