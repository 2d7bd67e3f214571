"""Gases behind a piston: along an adiabat, at constant pressure, and without one."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from scipy.integrate import cumulative_trapezoid

from gaspart.reproduction.families.shared.rows import from_rows
from gaspart.reproduction.points import grid
from gaspart.scene.faces import pistons
from gaspart.scene.scene import Scene
from gaspart.theory.enskog import enskog_longitudinal_viscosity
from gaspart.theory.speeds import mean_speed
from gaspart.trajectory.run import open_trajectory


def piston(points: list[grid.Point], settings: dict) -> xr.Dataset:
    """Three kinds of points, all of particles of mass 1 in containers whose first axis has walls.

    With a piston and without an equilibration, over (path, path_replica, frame): volume over that at first;
    temperature over that at first; heating, see `_heating`; over `path` dimension and packing_fraction at
    first.
    With a piston and an equilibration, over (state, state_replica): density, the packing fraction in the
    middle half of the volume; factor, the external pressure over that density and the temperature;
    fluctuation, the number of particles times the variance of the volume over the square of that which they
    would have at this density; energy, twice the kinetic energy of the piston over the temperature; over
    `state` dimension and count.
    Without a piston, over (expansion, expansion_replica): heat, the final kinetic energy over the first;
    speed, the final mean speed over that of equilibrium at the first temperature; share of the
    particles in the half of the container that was empty; over `expansion` dimension.
    Final are means over the second half of the frames.
    """
    kinds: dict[str, list[dict]] = {"path": [], "state": [], "expansion": []}
    for point in points:
        scene, equilibration = grid.scene(point), grid.schedule(point).equilibration_frames
        kind = "expansion" if not pistons(scene) else "state" if equilibration else "path"
        read = {"path": _path, "state": _state, "expansion": _expansion}[kind]
        runs = [read(scene, path, equilibration) for path in point.replica_paths]
        row: dict[str, Any] = {name: np.stack([run[name] for run in runs]) for name in runs[0]}
        row["dimension"] = scene.dimension
        if kind == "state":
            row["count"] = scene.count
        if kind == "path":
            row["packing_fraction"] = scene.packing_fraction
        kinds[kind].append(row)
    parts = [from_rows(kind, rows, (f"{kind}_replica", "frame"), {}) for kind, rows in kinds.items()]
    return xr.merge(
        part.rename({name: f"{kind}_{name}" for name in part})
        for kind, part in zip(kinds, parts, strict=True)
    )


def _path(scene: Scene, path: str, _: int) -> dict[str, np.ndarray]:
    with open_trajectory(path) as run:
        length, energy, time = _length(scene, run), run["kinetic_energy"].values, run["time"].values
        rate = run["piston_velocity"].values / length  # its square counts: on either side
    heating = _heating(scene, time, length, energy, rate)
    return {"volume": length / length[0], "temperature": energy / energy[0], "heating": heating}


def _heating(
    scene: Scene, time: np.ndarray, length: np.ndarray, energy: np.ndarray, rate: np.ndarray
) -> np.ndarray:
    """(frame,) by how much viscosity has increased the logarithm of the temperature.

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


def _length(scene: Scene, run: xr.Dataset) -> np.ndarray:
    """(frame,) the distance of the piston from the wall opposite."""
    ((number, _),) = pistons(scene)
    place = run["piston_position"].values
    return place if number % 2 else scene.container.lengths[number // 2] - place


def _state(scene: Scene, path: str, first: int) -> dict[str, np.ndarray]:
    ((_, face),) = pistons(scene)
    area = scene.container.volume / scene.container.lengths[0]
    with open_trajectory(path) as run:
        length, velocity = _length(scene, run)[first:], run["piston_velocity"].values[first:]
        energy = run["kinetic_energy"].values[first:]
        places = run["coordinates"].values[first:, :, 0] / length[:, None]
    temperature = 2.0 * energy.mean() / (scene.dimension * scene.count)
    middle = ((places > 0.25) & (places < 0.75)).sum() / (0.5 * area * length.sum())
    bulk = scene.count / (middle * area)  # the length without what the walls deplete, which does not vary
    return {
        "density": middle * scene.packing_fraction * scene.container.volume / scene.count,
        "factor": face.pressure / (middle * temperature),
        "fluctuation": scene.count * length.var(ddof=1) / bulk**2,
        "energy": face.mass * np.mean(velocity**2) / temperature,
    }


def _expansion(scene: Scene, path: str, _: int) -> dict[str, np.ndarray]:
    with open_trajectory(path) as run:
        energy = run["kinetic_energy"].values
        half = len(energy) // 2
        speeds = np.linalg.norm(run["velocities"].values[half:].astype(float), axis=2)
        beyond = run["coordinates"].values[half:, :, 0] > 0.5 * scene.container.lengths[0]
    first = 2.0 * energy[0] / (scene.dimension * scene.count)
    return {
        "heat": energy[half:].mean() / energy[0],
        "speed": speeds.mean() / mean_speed(scene.dimension, first, count=scene.count),
        "share": beyond.mean(),
    }
