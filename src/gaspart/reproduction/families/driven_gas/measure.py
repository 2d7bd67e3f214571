"""The steady state of inelastic gases that random kicks heat."""

from __future__ import annotations

from typing import Any

import xarray as xr

from gaspart.analysis.run import Run
from gaspart.analysis.statistics import mean_of
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table


def means(run: Run) -> dict[str, float]:
    """Compute averages of a run.

    temperature : m <v^2> / d about the centre of mass, mean over the frames.
    cumulant : d <v^4> / ((d + 2) <v^2>^2) - 1 of all velocities in these.
    given, lost : energies per particle and time, of kicks and in contacts.
    """
    squares, dimension = (run.peculiar**2).sum(axis=2), run.dimension
    second = squares.mean(axis=1)  # by frame, so that a temperature that fluctuates adds no cumulant
    fourth = (squares**2).mean(axis=1)
    return {
        "temperature": run.temperature,
        "cumulant": float(dimension * fourth.mean() / ((dimension + 2) * (second**2).mean()) - 1.0),
        "given": float(run.growth("thermostat_energy")) / run.count,
        "lost": float(run.growth("dissipated_energy")) / run.count,
    }


def driven_gas(points: list[Point], settings: dict) -> xr.Dataset:
    """Return the steady temperature and the fourth cumulant of driven gases.

    Returns over `gas`: dimension, restitution, packing_fraction, count, power; temperature, cumulant, given
    and lost (see `means`), with their errors from replicas.
    """
    units = {"temperature": "energy", **dict.fromkeys(("power", "given", "lost"), "energy / time")}
    return table("gas", points, _gas, units=units)


def _gas(point: Point) -> dict[str, Any]:
    scene = point.scene
    assert scene.restitution is not None and scene.thermostat is not None, "a driven granular gas"
    replicas = [means(run) for run in runs(point)]
    row = {
        "dimension": scene.dimension,
        "restitution": scene.restitution.normal,
        "packing_fraction": scene.packing_fraction,
        "count": scene.count,
        "power": scene.thermostat.power,
    }
    return row | {name: mean_of([replica[name] for replica in replicas]) for name in replicas[0]}
