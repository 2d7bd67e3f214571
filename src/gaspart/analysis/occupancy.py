"""The number of particles in a container with open faces."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.analysis.expected.described import described
from gaspart.analysis.observable import Observable, scalar
from gaspart.analysis.observables import require_defined
from gaspart.analysis.run import Source, open_run
from gaspart.scene.faces import Open
from gaspart.scene.scene import Scene


def particle_numbers(scene: Scene, data: xr.Dataset) -> np.ndarray:
    """Return the number of particles inside in each frame.

    It is the number at the start, plus all that have entered since, minus those that have left.

    Parameters
    ----------
    scene : Scene
        The scene.
    data : Dataset
        The trajectory.

    Returns
    -------
    ndarray, shape (T,)
        The numbers.
    """
    opened = [number for number, _ in scene.faces_of(Open)]
    moved = data["entries"].values.sum(axis=1) - data["wall_hits"].values[:, opened].sum(axis=1)
    return np.asarray(scene.count + moved).astype(np.int64)


def particle_number(source: Source, start: float | None = None) -> Observable:
    """Measure the mean number of particles inside a container with open faces.

    Parameters
    ----------
    source : str, Path, Dataset or Simulation
        A trajectory, by its path or open, or a simulation.
    start : float, [time], optional
        Frames before this time are discarded. Default: a quarter of the run.

    Returns
    -------
    Observable
        The mean number in the frames, dimensionless.

    Raises
    ------
    SceneError
        If the scene has no open faces, or there are too few frames.

    Examples
    --------
    >>> import gaspart as gp
    >>> gas, reservoir = gp.Species(20, 0.5, temperature=1.0), gp.Open(activity=0.1, temperature=1.0)
    >>> scene = gp.Scene(
    ...     gp.Container((16.0, 16.0)), [gas], centres_to_walls=True, faces={"x_low": reservoir}
    ... )
    >>> simulation = gp.Simulation(scene, seed=1)
    >>> simulation.advance(20.0)
    >>> gp.analysis.particle_number(simulation).estimate.attrs["units"]
    '1'
    """
    with open_run(source, start, varying=True) as run:
        require_defined("number", run.scene)
        counts = particle_numbers(run.scene, run.data)
        return scalar("particle_number", counts[1:].astype(float), run.time, **described("number", run))
