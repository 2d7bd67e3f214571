"""A large disc under gravity in a fluid of small discs: its force or its height.

The force on a fixed disc is the missing term in the momentum balance of the fluid: floor - ceiling - weight -
gain of momentum. It is exact over any time. The large disc is the scene's first particle. The small discs are
the only species. Blocks and errors are defined in `gaspart.reproduction.families.gravity.measure`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.flow import Grid
from gaspart.analysis.statistics import jackknife, mean_of
from gaspart.reproduction.families.shared.columns import (
    Field,
    Stretch,
    field,
    stretches,
)
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import merge_with_prefixes, table
from gaspart.theory.brownian import displaced_area
from gaspart.theory.geometry import particle_volume
from gaspart.theory.gravity import hydrostatic_profiles
from gaspart.theory.tables import excess_chemical_potential, packing_fraction_at


def buoyancy(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure fixed and free discs in a fluid, and the source's free discs.

    Fixed discs differ in height, free discs in mass. The settings are:

    source : experiments with the source's fluid
    bins : number of bins of height
    blocks : number of blocks of each replica
    clear : distance from floor and ceiling, in small diameters, without hydrostatics due to layers of discs
    far : horizontal distance from the large disc's edge to undisturbed fluid, in small diameters
    near : distance from the large disc within which missing small discs are counted, in small diameters
    source_density : density at which a disc floats in the middle, as estimated by the source

    The dimensions of the result are fixed, free, source, and height. Over height the theoretical curve
    `displaced` is the displaced mass in the mean fluid of the fixed points. Heights are defined as in
    `columns`; masses are in units of the mass of a small disc. The force equals the weight of a disc of
    undisturbed fluid. `force_radius` is the radius of this disc minus the radius of the large disc, in units
    of the small radius. `count_radius` is defined in the same way, from the number of missing discs instead
    of the weight.
    """
    of_source = [point for point in points if point.experiment in settings["source"]]
    own = [point for point in points if point not in of_source]
    held = [point for point in own if point.scene.particles[0].fixed]
    moving = [point for point in own if point not in held]
    fixed = table("fixed", held, _measure_fixed, settings, inner=("place",))
    column, ratio = field(held[0]), float(fixed["size_ratio"][0])
    dataset = merge_with_prefixes(
        fixed=fixed.drop_vars("fluid"),
        free=table("free", moving, _free, settings),
        source=table("source", sorted(of_source, key=_mass), _free, settings),
    )
    eta = fixed["fluid"].values.mean(axis=0)
    dataset = dataset.assign(displaced=("height", eta * displaced_area(eta, ratio)), height=_heights(column))
    return dataset.assign_attrs(
        size_ratio=ratio,
        strength=column.strength,
        top=column.height,
        source_density=settings["source_density"],
    )


def _heights(column: Field) -> np.ndarray:
    """Return the heights at which the displaced mass is drawn."""
    return np.linspace(0.0, column.height, 201)


def _mass(point: Point) -> float:
    """Return the mass of the large disc."""
    return point.scene.particles[0].mass


def _of_blocks(function: Callable[..., Any], *samples: np.ndarray) -> Estimate:
    """Compute a function of means over blocks, with its error from the scatter of blocks."""
    return Estimate(*jackknife(function, *samples), len(samples[0]) - 1)


def _grid(column: Field, settings: dict) -> Grid:
    return Grid.line(0.0, column.height, settings["bins"])


def _far(column: Field, stretch: Stretch, radius: float, settings: dict) -> np.ndarray:
    """Compute the density (B,) of small discs far from the large disc, by height.

    `radius` is the radius of the large disc.
    """
    across = np.abs(stretch.positions[..., 0] - stretch.positions[:, :1, 0])
    distance = radius + settings["far"] * column.diameter
    far = np.minimum(across, column.width - across) > distance
    grid = _grid(column, settings)
    counts = grid.sums(grid.cells(stretch.heights[far][:, None]))
    return counts / (len(stretch.heights) * (column.width - 2.0 * distance) * grid.volume)


def _fluid(
    column: Field, density: np.ndarray, temperature: float, settings: dict
) -> Callable[[np.ndarray], float | np.ndarray]:
    """Return the hydrostatic packing fraction as a function of height.

    The layers at the floor are neglected.

    The fluid has the actual number of discs.
    """
    width = column.height / len(density)
    skip = int(np.ceil(settings["clear"] * column.diameter / width))
    z = np.linspace(skip * width, (len(density) - skip) * width, 1001)
    weight = column.masses[-1] * column.strength / temperature
    number = density[skip : len(density) - skip].sum() * width
    lowest = hydrostatic_profiles(z, [number], [weight], 2, column.diameter)[0, 0]
    eta = lowest * particle_volume(2, column.diameter)
    logarithm = np.log(eta) + excess_chemical_potential(eta, 2) + weight * z[0]
    return lambda height: packing_fraction_at(np.exp(logarithm - weight * height), 2)


def _measure_fixed(point: Point, settings: dict) -> dict:
    """Measure force and effective radius of a fixed disc, and the packing fraction at its height.

    `fluid` is the packing fraction of the undisturbed fluid at `_heights`.
    """
    column, blocks = field(point), stretches(point, settings["blocks"])
    radius, height = _large(point, column)
    ratio, volume = 2.0 * radius / column.diameter, particle_volume(2, column.diameter)
    force = np.array([s.floor - s.ceiling - column.weight - s.gain for s in blocks])
    displaced = force / (column.masses[-1] * column.strength)
    density = np.array([_far(column, stretch, radius, settings) for stretch in blocks])
    # One smooth profile serves for all blocks, scaled to the number of discs in each block: missing discs are
    # counted relative to it.
    warm = float(np.mean([stretch.temperature for stretch in blocks]))
    fluid = _fluid(column, density.mean(axis=0), warm, settings)
    reach = radius + settings["near"] * column.diameter
    across, up = _disc(reach)
    undisturbed = float((fluid(height + up) * across).sum() / volume)
    inside = np.array([_inside(column, stretch, height, reach) for stretch in blocks])
    missing = undisturbed * density.sum(axis=1) / density.mean(axis=0).sum() - inside
    # Undisturbed density at the disc's position, averaged over the area of the disc.
    [z] = _grid(column, settings).middles
    chord = np.sqrt(np.maximum(radius**2 - (z - height) ** 2, 0.0))
    there = density @ (chord / chord.sum())

    def radius_of(number: float, density: float) -> float:
        return float(np.sqrt(number / (np.pi * density))) / (0.5 * column.diameter) - ratio

    packing_fraction = mean_of(there * volume)
    return {
        "force": mean_of(displaced),
        "missing": mean_of(missing),
        "packing_fraction": packing_fraction,
        "force_radius": _of_blocks(radius_of, displaced, there),
        "count_radius": _of_blocks(radius_of, missing, there),
        "radius_expected": float(np.sqrt(displaced_area(packing_fraction.value, ratio)) - ratio),
        "height": height,
        "size_ratio": ratio,
        "fluid": fluid(_heights(column)),
    }


def _disc(radius: float, points: int = 400) -> tuple[np.ndarray, np.ndarray]:
    """Compute the areas of strips of a disc, and their heights above its centre, (points,)."""
    up = radius * ((np.arange(points) + 0.5) * 2.0 / points - 1.0)
    return 2.0 * np.sqrt(radius**2 - up**2) * 2.0 * radius / points, up


def _inside(column: Field, stretch: Stretch, height: float, radius: float) -> float:
    """Compute the mean number of small discs within `radius` of the large one's centre."""
    across = np.abs(stretch.positions[:, 1:, 0] - stretch.positions[:, :1, 0])
    across = np.minimum(across, column.width - across)
    square = across**2 + (stretch.heights[:, 1:] - height) ** 2
    return float((square < radius**2).sum(axis=1).mean())


def _free(point: Point, settings: dict) -> dict:
    """Measure the position of a free disc, and compute it from a Boltzmann factor.

    The energy in this factor contains the weight of the disc and the displaced weight.
    """
    column, blocks = field(point), stretches(point, settings["blocks"])
    radius, _ = _large(point, column)
    ratio, mass = 2.0 * radius / column.diameter, _mass(point)
    warm = float(np.mean([stretch.temperature for stretch in blocks]))
    fluid = _fluid(
        column, np.mean([_far(column, s, radius, settings) for s in blocks], axis=0), warm, settings
    )
    margin = radius - 0.5 * column.diameter
    z = np.linspace(margin, column.height - margin, 2001)
    # Forces are integrated, instead of differences of work. The largest term, from the pressure of the fluid,
    # is then exact. Only the term from the edge relies on scaled-particle theory.
    eta = fluid(z)
    force = column.masses[-1] * eta * displaced_area(eta, ratio) - mass
    exponent = np.cumsum(force) * (z[1] - z[0]) * column.strength / warm
    chance = np.exp(exponent - exponent.max())
    chance /= chance.sum()
    expected = chance @ z
    height, square = np.array([[s.heights[:, 0].mean(), (s.heights[:, 0] ** 2).mean()] for s in blocks]).T
    spread = _of_blocks(lambda mean, square: math.sqrt(max(square - mean**2, 0.0)), height, square)
    return {
        "mass": mass / column.masses[-1],
        "height": mean_of(height),
        "spread": (spread.value, spread.error),
        "expected": expected,
        "expected_spread": np.sqrt(chance @ (z - expected) ** 2),
        "lowest": margin,
        "highest": column.height - margin,
        "density": mass / (np.pi * radius**2),
    }


def _large(point: Point, column: Field) -> tuple[float, float]:
    """Return the radius of the large disc, and its height in the scene file."""
    particle = point.scene.particles[0]
    return particle.radius, particle.position[1] - 0.5 * column.diameter
