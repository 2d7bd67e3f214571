"""Runs of rough and inelastic gases: temperatures against collisions, in the units of `measure`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gaspart.analysis.run import Run
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.scene.restitution import Restitution


@dataclass(frozen=True)
class Temperatures:
    """Temperatures in T frames of a run: time, collisions per particle, T_tr, T_rot (T,); first T_tr."""

    time: np.ndarray
    collisions: np.ndarray
    translation: np.ndarray
    rotation: np.ndarray
    start: float


def temperatures(run: Run, first: int) -> Temperatures:
    """Return the temperatures in all frames of a run of like particles from number `first` on."""
    count, dimension, mass = run.count, run.dimension, run.scene.species[0].mass
    translation, rotation = run.temperatures, np.zeros(len(run.time))
    if run.scene.rough:  # of smooth particles the file may lack all but one
        total = mass * (run.velocities**2).sum(axis=(1, 2))
        rotation = (2.0 * run.data["kinetic_energy"].values - total) / ({2: 1, 3: 3}[dimension] * count)
    return Temperatures(
        time=run.time[first:],
        collisions=2.0 * run.data["collisions"].values[first:] / count,
        translation=translation[first:] / translation[0],
        rotation=rotation[first:] / translation[0],
        start=float(translation[0]),
    )


def read(point: Point) -> list[Temperatures]:
    """Return the temperatures in all replicas of a point, without their equilibration."""
    first = point.schedule.equilibration_frames
    return [temperatures(run, first) for run in runs(point, first=0)]


def law(point: Point) -> Restitution:
    """Return the law of the contacts of a point's scene."""
    return point.scene.restitution or Restitution()


def inertia(point: Point) -> float:
    """Return q = I / (m R^2) of a point's only species.

    The default is that for a uniform disc or sphere.
    """
    kind = point.scene.species[0]
    if kind.moment_of_inertia is None:
        return {2: 0.5, 3: 0.4}[point.scene.dimension]
    return kind.moment_of_inertia / (kind.mass * kind.radius**2)
