"""The steady state of inelastic gases that random kicks heat."""

from __future__ import annotations

from dataclasses import dataclass

import xarray as xr

from gaspart.analysis.statistics import mean_of
from gaspart.reproduction.families.shared.rows import entries, from_rows
from gaspart.reproduction.points import grid
from gaspart.trajectory.run import open_trajectory


@dataclass(frozen=True)
class Run:
    """One replica. temperature: m <v^2> / d, mean over the frames; cumulant: d <v^4> / ((d + 2) <v^2>^2) - 1
    of all velocities in these; given, lost: energies per particle and time, of kicks and in contacts."""

    temperature: float
    cumulant: float
    given: float
    lost: float


def read_run(point: grid.Point, path: str) -> Run:
    """One trajectory without its equilibration. Velocities are those about the centre of mass."""
    first = grid.schedule(point).equilibration_frames
    with open_trajectory(path) as trajectory:
        velocities = trajectory["velocities"].values[first:].astype(float)
        time = trajectory["time"].values[first:]
        given, lost = (trajectory[key].values[first:] for key in ("thermostat_energy", "dissipated_energy"))
    count, dimension = velocities.shape[1:]
    mass = grid.scene(point).species[0].mass
    squares = ((velocities - velocities.mean(axis=1, keepdims=True)) ** 2).sum(axis=2)
    second = squares.mean(axis=1)  # by frame, so that a temperature that fluctuates adds no cumulant
    fourth = (squares**2).mean(axis=1)
    passed = count * (time[-1] - time[0])
    return Run(
        temperature=float(second.mean()) * mass * count / (dimension * (count - 1)),
        cumulant=float(dimension * fourth.mean() / ((dimension + 2) * (second**2).mean()) - 1.0),
        given=float((given[-1] - given[0]) / passed),
        lost=float((lost[-1] - lost[0]) / passed),
    )


def driven_gas(points: list[grid.Point], settings: dict) -> xr.Dataset:
    """The steady temperature and the fourth cumulant of driven gases.

    Returns over `gas`: dimension, restitution, packing_fraction, count, power; temperature, cumulant, given
    and lost (see `Run`), with their errors from replicas.
    """
    units = {"temperature": "energy", **dict.fromkeys(("power", "given", "lost"), "energy / time")}
    return from_rows("gas", [_gas(point) for point in points], units=units)


def _gas(point: grid.Point) -> dict[str, float]:
    scene = grid.scene(point)
    assert scene.restitution is not None and scene.thermostat is not None, "a driven granular gas"
    runs = [read_run(point, path) for path in point.replica_paths]
    row = {
        "dimension": scene.dimension,
        "restitution": scene.restitution.normal,
        "packing_fraction": scene.packing_fraction,
        "count": scene.count,
        "power": scene.thermostat.power,
    }
    names = ("temperature", "cumulant", "given", "lost")
    return row | entries({name: mean_of([getattr(run, name) for run in runs]) for name in names})
