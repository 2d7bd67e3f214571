"""State at the end of a trajectory, from its stored checkpoint or from its last frame."""

from __future__ import annotations

import warnings
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gaspart.errors import SceneError
from gaspart.scene.boundaries import refuse_open
from gaspart.scene.faces import GRADIENT
from gaspart.state.given import state_from_arrays
from gaspart.state.state import State
from gaspart.trajectory.checkpoint import kept_beside
from gaspart.trajectory.opening import open_verified, run_path
from gaspart.trajectory.reading import open_trajectory
from gaspart.trajectory.recipe import Recipe, read_recipe
from gaspart.trajectory.run import simulation_of

if TYPE_CHECKING:
    import xarray as xr


def last_state(path: str | Path) -> State:
    """Return the state of all particles at the end of a trajectory.

    The state is exact if the run was made with `keep_checkpoint`. Otherwise positions, velocities and spins
    are from the last frame, in single precision, and a warning is issued. The motion of a piston and the
    displacement of sheared images are exact.

    Parameters
    ----------
    path : str or Path
        The trajectory.

    Returns
    -------
    State
        The state. Another run can start from it.

    Raises
    ------
    SceneError
        If `open_trajectory` rejects the file, or if a stored checkpoint is damaged or belongs to another run.
        Without a checkpoint, SceneError is also raised if the last frame does not contain all particles
        (`follow`) or all properties (`keep`), or if a frame does not determine the state (in a scene with
        sticky faces).

    Examples
    --------
    >>> import gaspart as gp
    >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)])
    >>> path = gp.run(scene, seed=1, duration=2.0, sample_interval=0.1, path="gas.nc")
    >>> gp.last_state(path).time
    2.0
    """
    path = run_path(path)
    recipe = read_recipe(path)
    with open_verified(path) as (_, header, frames):
        checkpoint = kept_beside(path, header, "to start from the last frame, in single precision")
    if checkpoint and checkpoint.frames == frames:
        simulation = simulation_of(recipe)
        simulation.restore(checkpoint.arrays)
        return simulation.state.copy()
    refuse_open(recipe.scene, f"changes the particles, and {path} has no checkpoint of its end")
    if recipe.stored_count < recipe.scene.count:
        rule = f"has {recipe.stored_count} of {recipe.scene.count} particles, and no checkpoint"
        raise SceneError("file", str(path), rule)
    recipe.require_all(path)
    with open_trajectory(path) as data:
        if data.sizes["frame"] == 0:
            raise SceneError("frame", 0, "the trajectory has no frame yet")
        state = _of_frame(recipe, data.isel(frame=-1))
    rule = "has no checkpoint of its end (keep_checkpoint): its last state is known in single precision only"
    warnings.warn(f"gaspart: {path}: {rule}", stacklevel=2)
    return state


def _of_frame(recipe: Recipe, frame: xr.Dataset) -> State:
    """Return the state from a frame that contains all particles."""
    scene, time = recipe.scene, float(frame["time"])
    positions, velocities = (frame[name].values.astype(float) for name in ("coordinates", "velocities"))
    spins, vibrations = (
        frame[name].values.astype(float) if name in frame else None for name in ("spins", "vibrations")
    )
    piston, displaced = None, None
    if scene.has_piston:
        piston = np.array([float(frame[f"piston_{name}"]) for name in ("position", "velocity")])
    if scene.shear_rate is not None:
        begun = recipe.initial.displaced if recipe.initial else None
        displaced = (begun or 0.0) + scene.shear_rate * scene.container.lengths[GRADIENT] * time
    return replace(
        state_from_arrays(scene, positions, velocities, spins, piston, displaced, vibrations), time=time
    )
