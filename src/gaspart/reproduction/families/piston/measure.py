"""Gases behind a piston: along an adiabat, at constant pressure, and without one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr
from scipy.integrate import cumulative_trapezoid

from gaspart.analysis.run import Run
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import merge_with_prefixes, table
from gaspart.scene.scene import Scene
from gaspart.theory.enskog import enskog_longitudinal_viscosity
from gaspart.theory.speeds import mean_speed


def piston(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure three kinds of points, of particles of mass 1, whose first axis has walls.

    With a piston and without an equilibration, over (path, path_replica, frame) are volume and temperature
    divided by their first values; heating, see `_heating`; over `path` dimension and the first
    packing_fraction.

    With a piston and an equilibration, over (state, state_replica) are density, the packing fraction in the
    middle half of the volume; factor, the external pressure over this density and the temperature;
    fluctuation, the number of particles times the variance of the volume over the square of the volume at
    this density; energy, twice the kinetic energy of the piston over the temperature; over `state` dimension
    and count.

    Without a piston, over (expansion, expansion_replica) are heat, the final kinetic energy over the first;
    speed, the final mean speed over its equilibrium value at the first temperature; share, the fraction of
    the particles in the half of the container that was empty; over `expansion` dimension. Final values are
    means over the second half of the frames.
    """
    kinds: dict[str, tuple] = {
        "path": (_path, "packing_fraction"),
        "state": (_state, "count"),
        "expansion": (_expansion,),
    }
    tables = {}
    for kind, (read, *facts) in kinds.items():
        chosen = [point for point in points if _kind(point) == kind]
        inner = f"{kind}_replica", "frame"
        tables[kind] = table(kind, chosen, _row, read, ("dimension", *facts), inner=inner, units={})
    return merge_with_prefixes(**tables)


def _kind(point: Point) -> str:
    if not point.scene.pistons:
        return "expansion"
    return "state" if point.schedule.equilibration_frames else "path"


def _row(point: Point, read: Callable[[Run], dict], facts: tuple[str, ...]) -> dict:
    """Return the results of `read` for each replica, and facts of the scene."""
    replicas = [read(run) for run in runs(point)]
    row = {name: np.stack([replica[name] for replica in replicas]) for name in replicas[0]}
    return row | {name: getattr(point.scene, name) for name in facts}


def _path(run: Run) -> dict[str, np.ndarray]:
    length, energy = _length(run), run.data["kinetic_energy"].values
    rate = run.data["piston_velocity"].values / length  # its square counts: on either side
    heating = _heating(run.scene, run.time, length, energy, rate)
    return {"volume": length / length[0], "temperature": energy / energy[0], "heating": heating}


def _heating(
    scene: Scene, time: np.ndarray, length: np.ndarray, energy: np.ndarray, rate: np.ndarray
) -> np.ndarray:
    """Compute the increase (frame,) of the logarithm of the temperature by viscosity.

    The gas between the wall and the piston flows with a velocity proportional to the distance from the wall;
    its longitudinal viscosity (Enskog's) times the square of the `rate` of strain is heat. An adiabat keeps
    the ratio of two temperatures, so that the parts add up.
    """
    dimension, diameter = scene.dimension, 2.0 * scene.largest_radius
    share = length / scene.container.lengths[0]
    viscosity = enskog_longitudinal_viscosity(scene.packing_fraction / share, dimension, diameter)
    viscosity *= np.sqrt(2.0 * energy / (dimension * scene.count))
    power = viscosity * rate**2 * scene.container.volume * share
    return cumulative_trapezoid(power / energy, time, initial=0)


def _length(run: Run) -> np.ndarray:
    """Compute the distance of the piston from the wall opposite, shape (frame,)."""
    ((number, _),) = run.scene.pistons
    position = run.data["piston_position"].values
    return position if number % 2 else run.scene.container.lengths[number // 2] - position


def _state(run: Run) -> dict[str, np.ndarray]:
    scene, length = run.scene, _length(run)
    ((_, face),) = scene.pistons
    area = scene.container.volume / scene.container.lengths[0]
    positions = run.data["coordinates"].values[:, :, 0] / length[:, None]
    temperature = 2.0 * run.data["kinetic_energy"].values.mean() / (scene.dimension * scene.count)
    middle = ((positions > 0.25) & (positions < 0.75)).sum() / (0.5 * area * length.sum())
    bulk = scene.count / (middle * area)  # the length without what the walls deplete, which does not vary
    return {
        "density": middle * scene.packing_fraction * scene.container.volume / scene.count,
        "factor": face.pressure / (middle * temperature),
        "fluctuation": scene.count * length.var(ddof=1) / bulk**2,
        "energy": face.mass * np.mean(run.data["piston_velocity"].values ** 2) / temperature,
    }


def _expansion(run: Run) -> dict[str, np.ndarray]:
    scene, energy = run.scene, run.data["kinetic_energy"].values
    half = len(energy) // 2
    speeds = np.linalg.norm(run.velocities[half:], axis=2)
    beyond = run.data["coordinates"].values[half:, :, 0] > 0.5 * scene.container.lengths[0]
    first = 2.0 * energy[0] / (scene.dimension * scene.count)
    return {
        "heat": energy[half:].mean() / energy[0],
        "speed": speeds.mean() / mean_speed(scene.dimension, first, count=scene.count),
        "share": beyond.mean(),
    }
