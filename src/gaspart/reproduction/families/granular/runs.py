"""Runs of rough and inelastic gases: temperatures against collisions, in the units of `measure`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gaspart.reproduction.points import grid
from gaspart.scene.restitution import Restitution
from gaspart.trajectory.run import open_trajectory


@dataclass(frozen=True)
class Run:
    """One replica over T frames: time, collisions per particle, T_tr and T_rot, (T,) each; first T_tr."""

    time: np.ndarray
    collisions: np.ndarray
    translation: np.ndarray
    rotation: np.ndarray
    start: float


def read_run(point: grid.Point, path: str) -> Run:
    """One trajectory, in which all particles are alike, without its equilibration."""
    first = grid.schedule(point).equilibration_frames
    with open_trajectory(path) as trajectory:
        velocities = trajectory["velocities"].values.astype(float)
        energy = trajectory["kinetic_energy"].values
        counted = trajectory["collisions"].values
        time = trajectory["time"].values.astype(float)
    count, dimension = velocities.shape[1:]
    mass = grid.scene(point).species[0].mass
    total = mass * (velocities**2).sum(axis=(1, 2))
    drift = velocities.mean(axis=1)
    translation = (total - mass * count * (drift**2).sum(axis=1)) / (dimension * (count - 1))
    spins = {2: 1, 3: 3}[dimension]
    rotation = (2.0 * energy - total) / (spins * count)
    return Run(
        time=time[first:],
        collisions=2.0 * counted[first:] / count,
        translation=translation[first:] / translation[0],
        rotation=rotation[first:] / translation[0],
        start=float(translation[0]),
    )


def read_runs(point: grid.Point) -> list[Run]:
    """All replicas of a point."""
    return [read_run(point, path) for path in point.replica_paths]


def law(point: grid.Point) -> Restitution:
    """That of the contacts of a point's scene."""
    return grid.scene(point).restitution or Restitution()


def inertia(point: grid.Point) -> float:
    """q = I / (m R^2) of a point's only species; by default that of a uniform disc or sphere."""
    kind = grid.scene(point).species[0]
    if kind.moment_of_inertia is None:
        return {2: 0.5, 3: 0.4}[grid.scene(point).dimension]
    return kind.moment_of_inertia / (kind.mass * kind.radius**2)
