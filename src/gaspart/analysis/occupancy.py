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
    """(T,) particles inside in each frame: those at the start, with all that have entered since, less those
    that have left."""
    opened = [number for number, _ in scene.faces_of(Open)]
    moved = data["entries"].values.sum(axis=1) - data["wall_hits"].values[:, opened].sum(axis=1)
    return np.asarray(scene.count + moved).astype(np.int64)


def particle_number(source: Source, start: float | None = None) -> Observable:
    """Mean number of particles inside, dimensionless, of a scene with open faces: in the frames.

    source: a trajectory, by its path or open, or a simulation; start: the time from which frames count (by
    default a quarter of the run). Raises SceneError without open faces, and for too few frames.
    """
    with open_run(source, start, varying=True) as run:
        require_defined("number", run.scene)
        counts = particle_numbers(run.scene, run.data)
        return scalar("particle_number", counts[1:].astype(float), run.time, **described("number", run))
