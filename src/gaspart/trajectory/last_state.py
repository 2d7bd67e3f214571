"""The state at the end of a trajectory: the exact one of a kept checkpoint, or that of the last frame."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from gaspart.errors import SceneError
from gaspart.state.given import given_state
from gaspart.state.state import State
from gaspart.trajectory.checkpoint import kept_beside
from gaspart.trajectory.opening import checked
from gaspart.trajectory.reading import open_trajectory
from gaspart.trajectory.recipe import read_recipe
from gaspart.trajectory.run import simulation_of


def last_state(path: str | Path) -> State:
    """The state of all particles at the end of a trajectory, to look at or to start another run from.

    It is exact if the run had `keep_checkpoint`; otherwise positions, velocities and spins are those of the
    last frame, in single precision. Raises SceneError for a file that `open_trajectory` refuses, for a kept
    checkpoint that is damaged or of another run, and, of a last frame, one that lacks particles (`follow`)
    or does not hold the state: of a scene with a piston, vibrating or sticky faces, or vibrations.
    """
    path = Path(path)
    recipe = read_recipe(path)
    with checked(path) as (_, header, frames):
        checkpoint = kept_beside(path, header, "to start from the last frame, in single precision")
    if checkpoint and checkpoint.frames == frames:
        simulation = simulation_of(recipe)
        simulation.restore(checkpoint.arrays)
        return simulation.state
    if recipe.stored_count < recipe.scene.count:
        rule = f"has {recipe.stored_count} of {recipe.scene.count} particles, and no checkpoint"
        raise SceneError("file", str(path), rule)
    with open_trajectory(path) as data:
        if data.sizes["frame"] == 0:
            raise SceneError("frame", 0, "the trajectory has no frame yet")
        last = data.isel(frame=-1)
        names = ("coordinates", "velocities", "spins")
        parts = [last[name].values.astype(float) for name in names if name in last]
        return replace(given_state(recipe.scene, *parts), time=float(last["time"]))
