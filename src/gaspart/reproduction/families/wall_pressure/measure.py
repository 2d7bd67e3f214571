"""Pressure from the momentum transferred to the walls of the container.

Everything is in reduced units: the particles' diameter, mass and temperature are 1. Along a periodic axis the
total momentum is conserved: the temperature is defined by the motion about it.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.run import Run
from gaspart.analysis.series import face_pressures
from gaspart.analysis.statistics import average, correlated_mean
from gaspart.errors import SceneError
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table

UNITS = {"length": "diameters", "density": "1 / sigma^d", "temperature": "scene's energy"}
UNITS |= dict.fromkeys(("pressure", "whole_pressure", "bulk_pressure", "expected"), "k_B T / sigma^d")


def wall_pressure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the pressure on the walls of containers, with theory for each.

    The containers have walls on some or all axes.

    Returns over `point`: pressure with its error, the mean force on a wall over the area that centres can
    touch; whole_pressure, the same force over the full area of the wall; bulk_pressure, of an infinite fluid
    with as many particles per volume of the container; expected with its error, theory for this container;
    density, particles per volume of the container, and packing_fraction; temperature of the scene; hits;
    count, dimension, axes with walls, length along them. Raises SceneError for containers without walls, or
    with walled sides of several lengths.
    """
    return table("point", points, _row, units=UNITS)


def _row(point: Point) -> dict:
    scene = point.scene
    dimension, count, diameter = scene.dimension, scene.count, 2.0 * scene.largest_radius
    lengths = np.array(scene.container.lengths) / diameter
    walled = ~np.array(scene.container.periodic)
    if not walled.any() or np.ptp(lengths[walled]) > 1e-9 * lengths.max():
        raise SceneError(point.path, scene.container.boundary, "needs walls, all of one distance")
    touched = np.where(walled, lengths - 1.0, lengths)
    length, axes = float(lengths[walled][0]), int(walled.sum())
    expected = theory.wall_pressure(length, count / touched.prod(), count, dimension, axes)
    replicas = [_replica(run) for run in runs(point)]
    accessible = [pressures * diameter**dimension / temperature for pressures, temperature, _ in replicas]
    pressure = average([correlated_mean(series).estimate for series in accessible])
    share = touched.prod() / touched[walled][0] * lengths[walled][0] / lengths.prod()
    density = count / float(lengths.prod())
    eta = float(theory.packing_fraction(density, dimension))
    return {
        "pressure": pressure,
        "expected": expected,
        "whole_pressure": pressure.value * share,
        "bulk_pressure": density * float(theory.compressibility_factor(eta, dimension)),
        "density": density,
        "packing_fraction": eta,
        "temperature": float(np.mean([temperature for _, temperature, _ in replicas])),
        "hits": float(sum(hits for _, _, hits in replicas)),
        "count": count,
        "dimension": dimension,
        "axes": axes,
        "length": length,
    }


def _replica(run: Run) -> tuple[np.ndarray, float, int]:
    """Return the mean pressure (samples,), the temperature and the number of hits of a replica.

    The pressure is on the walls.
    """
    walled = np.repeat(~run.periodic, 2)
    hits = run.increments("wall_hits")[:, : 2 * run.dimension].sum()
    return face_pressures(run)[:, walled].mean(axis=1), run.temperature, hits
