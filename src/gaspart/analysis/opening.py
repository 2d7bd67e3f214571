"""Particles that pass a plane in the container, or an opening of interior walls in it."""

from __future__ import annotations

import numpy as np

from gaspart.analysis.conditions import walled_axis_of
from gaspart.analysis.expected.described import described
from gaspart.analysis.observable import LEAST_INTERVALS, Observable, observable
from gaspart.analysis.observables import require_defined
from gaspart.analysis.profiles import Means, with_freedom
from gaspart.analysis.run import Run, Source, open_run, selected
from gaspart.analysis.statistics import correlated_mean
from gaspart.errors import SceneError
from gaspart.scene.faces import FACES, Open


def particle_flux(
    source: Source,
    axis: str | None = None,
    at: float | None = None,
    species: int | None = None,
    start: float | None = None,
) -> Observable:
    """Measure the net number of particles that pass a plane across an axis per time.

    Parameters
    ----------
    source : str, Path, Dataset or Simulation
        A trajectory, by its path or open, or a simulation.
    axis : {"x", "y", "z"}, optional
        The axis. Default: the last one with open faces, or else with walls.
    at : float, [length], optional
        Position of the plane along the axis. Default: the middle.
    species : int, optional
        Only this species, by its number in the scene.
    start : float, [time], optional
        Frames before this time are discarded; 0 for a gas that streams out from the start. Default: a quarter
        of the run.

    Returns
    -------
    Observable
        The flux (component,) along the axis, in [1/time], positive towards larger coordinates.

    Raises
    ------
    SceneError
        If the axis is periodic, which images pass, or another one than that of open faces, the plane is
        outside the container, the file lacks particles, or there are too few frames.

    Notes
    -----
    The flux is the change of the number of particles beyond the plane, exactly, however often each particle
    has passed between frames: particles that come back do not count, nor do those that come and go through an
    open face beyond. The plane is that of the whole container; where interior walls lie in it, all pass their
    openings.

    Theory: 0 in a steady state without interior walls; of free flight through openings of walls in the plane
    n sqrt(k_B T / 2 pi m) times their area, with the density on both sides.

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
        place = 0.5 * run.scene.container.lengths[number] if at is None else float(at)
        members = np.flatnonzero(run.moving)[selected(run, species, None)]
        beyond = (run.positions[:, members, number] > place).sum(axis=1) - _entered_beyond(run, number)
        if len(beyond) <= LEAST_INTERVALS:
            raise SceneError("frames", len(beyond), f"an error needs {LEAST_INTERVALS + 1} or more")
        found = correlated_mean(np.diff(beyond) / np.diff(run.time), LEAST_INTERVALS).estimate
        along = {"component": (np.array(["xyz"[number]]), {"long_name": "axis"})}
        about = described("flux", run, number, place, members, beyond)
        means = Means(*(np.array([each]) for each in (found.value, found.error, found.freedom)))
        return with_freedom(observable("flux", along, means.values, means.errors, **about), means)


def _entered_beyond(run: Run, axis: int) -> np.ndarray | int:
    """(T,) how many particles more have entered through the upper face of an axis than left; 0 of one that is
    not open."""
    upper = 2 * axis + 1
    if not isinstance(run.scene.faces.get(FACES[upper]), Open):
        return 0
    return np.asarray(run.data["entries"].values[:, upper] - run.data["wall_hits"].values[:, upper])
