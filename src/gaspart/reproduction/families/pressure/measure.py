"""Measurements of pressure on walls, gases behind a piston, and estimators.

The first part measures the pressure from the momentum transferred to the walls of the container.

Units are reduced: the particles' diameter, mass and temperature are 1. Along a periodic axis the total
momentum is conserved. The temperature is then defined by velocities relative to the centre of mass.

The second part is on gases behind a piston: along an adiabat, at constant pressure, and in free expansion
without a piston.

The third part measures the density between two walls by counts and by impulses, and the pressure on the
walls.

The module also measures the mixture of both estimators. All estimates are from the same runs.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr
from scipy.integrate import cumulative_trapezoid

from gaspart import theory
from gaspart.accuracy.estimates import components
from gaspart.analysis.flow import Grid
from gaspart.analysis.impulses import mixture, numbers_by_impulses, read_impulses
from gaspart.analysis.run import Run
from gaspart.analysis.series import face_pressures
from gaspart.analysis.statistics import average, correlated_mean, mean_of
from gaspart.errors import SceneError
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import merge_with_prefixes, table
from gaspart.scene.scene import Scene
from gaspart.theory.enskog import enskog_longitudinal_viscosity
from gaspart.theory.speeds import mean_speed

UNITS = {"length": "diameters", "density": "1 / sigma^d", "temperature": "scene's energy"}
UNITS |= dict.fromkeys(("pressure", "whole_pressure", "bulk_pressure", "expected"), "k_B T / sigma^d")


def wall_pressure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the pressure on the walls of containers, with theory for each.

    The containers have walls on some or all axes. Variables over `point`:

    pressure : mean force on a wall divided by the area that centres can reach, with error
    whole_pressure : the same force divided by the full area of the wall
    bulk_pressure : theoretical pressure of an infinite fluid of this `density`
    expected : theoretical pressure of this container, with error
    density : particle number per volume of the container
    packing_fraction, temperature, dimension : of the scene
    hits, count : number of wall hits, and of particles
    axes, length : number of axes with walls, and length along them

    Raises SceneError for containers without walls, or whose axes with walls have different lengths.
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
    """Return the mean wall pressure (samples,), temperature and number of hits of a replica."""
    walled = np.repeat(~run.periodic, 2)
    hits = run.increments("wall_hits")[:, : 2 * run.dimension].sum()
    return face_pressures(run)[:, walled].mean(axis=1), run.temperature, hits


def piston(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure three kinds of points with walls on the first axis.

    Particles have mass 1.

    The first kind are points with a piston and without equilibration. Variables over (path, path_replica,
    frame) are volume and temperature divided by their first values, and heating (see `_heating`). Variables
    over `path` are dimension and the first packing_fraction.

    The second kind are points with a piston and with equilibration. Variables over (state, state_replica):

    density : packing fraction in the middle half of the volume
    factor : external pressure divided by this density and the temperature
    fluctuation : particle number times variance of the volume, divided by the squared volume at this density
    energy : twice the kinetic energy of the piston, divided by the temperature

    Variables over `state` are dimension and count.

    The third kind are points without a piston. Variables over (expansion, expansion_replica):

    heat : final kinetic energy divided by the initial energy
    speed : final mean speed divided by its equilibrium value at the initial temperature
    share : fraction of particles in the half of the container that was empty

    The variable over `expansion` is dimension. Final values are means over the second half of the frames.
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
        tables[kind] = table(kind, chosen, _piston_row, read, ("dimension", *facts), inner=inner, units={})
    return merge_with_prefixes(**tables)


def _kind(point: Point) -> str:
    if not point.scene.pistons:
        return "expansion"
    return "state" if point.schedule.equilibration_frames else "path"


def _piston_row(point: Point, read: Callable[[Run], dict], facts: tuple[str, ...]) -> dict:
    """Return the results of `read` for each replica, and properties of the scene."""
    replicas = [read(run) for run in runs(point)]
    row = {name: np.stack([replica[name] for replica in replicas]) for name in replicas[0]}
    return row | {name: getattr(point.scene, name) for name in facts}


def _path(run: Run) -> dict[str, np.ndarray]:
    length, energy = _length(run), run.data["kinetic_energy"].values
    # the square is used: the deviation may have either sign
    rate = run.data["piston_velocity"].values / length
    heating = _heating(run.scene, run.time, length, energy, rate)
    return {"volume": length / length[0], "temperature": energy / energy[0], "heating": heating}


def _heating(
    scene: Scene, time: np.ndarray, length: np.ndarray, energy: np.ndarray, rate: np.ndarray
) -> np.ndarray:
    """Compute the increase (frame,) of ln T by viscous heating.

    The gas between wall and piston flows with a velocity proportional to the distance from the wall. The heat
    is the longitudinal viscosity (Enskog) times the square of the `rate` of strain. Along an adiabat the
    ratio of two temperatures is constant, so that the increments add up.
    """
    dimension, diameter = scene.dimension, 2.0 * scene.largest_radius
    share = length / scene.container.lengths[0]
    viscosity = enskog_longitudinal_viscosity(scene.packing_fraction / share, dimension, diameter)
    viscosity *= np.sqrt(2.0 * energy / (dimension * scene.count))
    power = viscosity * rate**2 * scene.container.volume * share
    return cumulative_trapezoid(power / energy, time, initial=0)


def _length(run: Run) -> np.ndarray:
    """Compute the distance of the piston from the opposite wall, shape (frame,)."""
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
    # length without the layer that walls deplete; this layer does not change
    bulk = scene.count / (middle * area)
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


_BLOCKS = 32
_FILLED = 0.2
"""Minimum density of a bin, divided by the mean density; bins below it are partly inaccessible, and left out.
"""


def estimators(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure variances of densities along the last axis, for gases between walls across it.

    The setting is `widths` of bins. Variables over `case`, which is a point with a width of bins:

    packing_fraction, width : packing fraction, and width in diameters
    mixture, impulses : variance of counts divided by the variance of these estimators, median of all bins
    at_walls : `mixture` in the two bins at the walls
    mean_square : mean square of (counts - impulses) / error, divided by the value for Student's distribution
    additions : additions to the tally per tested pair of particles
    pressure : squared error of the wall pressure by impulses, divided by the squared error with known means
    pressures_apart : pressure by impulses minus pressure with known means, divided by the latter pressure

    The ratio of variances of each replica is computed from blocks of time. The result is the mean of these
    ratios over replicas.
    """
    cases = [(point, width) for point in points for width in settings["widths"]]
    return table("case", cases, _estimators_row)


def _estimators_row(case: tuple[Point, float]) -> dict[str, Any]:
    point, width = case
    diameter = 2.0 * point.scene.largest_radius
    replicas = [_compare(run, width * diameter) | pressures_of(run) for run in runs(point)]
    rows = {name: mean_of([replica[name] for replica in replicas]) for name in replicas[0]}
    return {"packing_fraction": point.scene.packing_fraction, "width": width, **rows}


def _compare(run: Run, width: float) -> dict[str, float]:
    """Compare the estimators of one run, in bins of the given width."""
    counted, impulses = blocks_of(run, width)
    filled = np.flatnonzero(counted.mean(axis=0) > _FILLED * counted.mean())
    counted, impulses = counted[:, filled], impulses[:, filled]
    apart = counted - impulses
    mixed = counted - mixture(counted, impulses, periodic=False) * apart
    own, other, both = (estimator.var(axis=0, ddof=1) for estimator in (counted, impulses, mixed))
    square = apart.mean(axis=0) ** 2 / apart.var(axis=0, ddof=1) * _BLOCKS
    tally = {name: run.increments(name).sum(axis=0) for name in ("collisions", "wall_hits", "pair_tests")}
    return {
        "mixture": float(np.median(own / both)),
        "impulses": float(np.median(own / other)),
        "at_walls": float((own / both)[[0, -1]].mean()),
        "mean_square": float(square.mean() * (_BLOCKS - 3.0) / (_BLOCKS - 1.0)),
        "additions": float((4 * tally["collisions"] + 2 * tally["wall_hits"].sum()) / tally["pair_tests"]),
    }


def pressures_of(run: Run) -> dict[str, float]:
    """Compare two estimators of the pressure of a run, on both walls; return the means.

    With known means both walls have the same pressure, except for rounding.
    """
    start = float(run.time[0])
    both = (components(data, "pressure", start) for data in (run.data.assign_attrs(tallies="[]"), run.data))
    plain, better = ([component.estimate for component in entries.values()] for entries in both)
    pairs = list(zip(plain, better, strict=True))
    return {
        "pressure": float(np.mean([(first.error / second.error) ** 2 for first, second in pairs])),
        "pressures_apart": float(np.mean([first.value / second.value - 1.0 for first, second in pairs])),
    }


def blocks_of(run: Run, width: float) -> tuple[np.ndarray, np.ndarray]:
    """Compute the mean particle numbers (blocks, bins), by counts and by impulses.

    Raises SceneError if the width is no multiple of the bins of the run.
    """
    axis, has = run.dimension - 1, read_impulses(run.data)
    length = float(run.scene.container.lengths[axis])
    bins = round(length / width)
    numbers = numbers_by_impulses(run, axis, bins, None)
    if numbers is None or not math.isclose(bins * width, length):
        rule = f"its bins, {has and has.to_text()}, do not divide a width of {width:g}"
        raise SceneError("impulses", has and has.to_text(), rule)
    size = len(numbers) // _BLOCKS
    used = size * _BLOCKS
    blocks = np.arange(used) // size
    grid = Grid.line(0.0, length, bins)
    cells = grid.cells(run.positions[1 : used + 1, :, axis, None], inside=True)
    counted = grid.sums(cells, None, blocks) / size
    time = np.diff(run.time)[:used].reshape(_BLOCKS, size).sum(axis=1)[:, None]
    return counted, numbers[:used].reshape(_BLOCKS, size, bins).sum(axis=1) / time
