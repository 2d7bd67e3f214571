"""A large disc in a fluid of small ones under gravity: the force on it held fast, where it floats set free.

The force on a fixed disc is what is missing in the fluid's balance of momentum, and so is exact over any
time: floor - ceiling - weight - gain of momentum. The large disc is the scene's first particle, and the small
ones its one species. Stretches and errors are those of `gaspart.reproduction.families.gravity.measure`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from gaspart.analysis.bins import Grid
from gaspart.analysis.statistics import jackknife
from gaspart.reproduction.families.shared.columns import (
    Field,
    Stretch,
    field,
    stretches,
)
from gaspart.reproduction.families.shared.rows import entries
from gaspart.reproduction.points.point import Point
from gaspart.theory.buoyancy import displaced_area
from gaspart.theory.geometry import particle_volume
from gaspart.theory.gravity import hydrostatic_profiles
from gaspart.theory.potential import excess_chemical_potential, packing_fraction_at


def buoyancy(points: list[Point], settings: dict) -> xr.Dataset:
    """Fixed discs at several heights, and free ones of several masses, in one and the same fluid; and the
    source's free discs in its own fluid.

    settings: `source`, the experiments of the source's fluid; `bins` of height; `blocks` of each replica;
    `clear`, the small diameters next to floor and ceiling where layers are, not hydrostatics; `far`, the
    small diameters across from the large disc's edge from which on the fluid is undisturbed; `near`, those
    within which it is disturbed, and the small discs that are missing are counted; `source_density`, at which
    a disc floats in the middle by the source's estimate.

    Dimensions fixed, free, source, and height of a theoretical curve: the mass displaced in the mean fluid of
    the fixed points. Heights are those of `columns`; masses are in those of a small disc. `force_radius` is
    how much larger than the large disc, in small radii, is the disc of undisturbed fluid whose weight is the
    force; `count_radius`, that of as many discs as are missing.
    """
    own = [point for point in points if point.experiment not in settings["source"]]
    held = [point for point in own if point.scene.particles[0].fixed]
    fixed = [_fixed(point, settings) for point in held]
    free = [_free(point, settings) for point in own if point not in held]
    of_source = [_free(point, settings) for point in points if point not in own]
    of_source.sort(key=lambda row: row["mass"])
    place, ratio = field(held[0]), fixed[0]["size_ratio"]
    z = np.linspace(0.0, place.height, 201)
    eta = np.mean([row.pop("fluid")(z) for row in fixed], axis=0)
    return xr.Dataset(
        {
            f"{kind}_{name}": (kind, np.array([row[name] for row in table]))
            for kind, table in (("fixed", fixed), ("free", free), ("source", of_source))
            for name in (table[0] if table else ())
        }
        | {"displaced": ("height", eta * displaced_area(eta, ratio))},
        coords={"height": z},
        attrs={
            "size_ratio": ratio,
            "strength": place.strength,
            "top": place.height,
            "source_density": settings["source_density"],
        },
    )


def _far(place: Field, stretch: Stretch, radius: float, settings: dict) -> np.ndarray:
    """(B,) density of the small discs far from the large one, of this radius, in bins of height."""
    across = np.abs(stretch.positions[..., 0] - stretch.positions[:, :1, 0])
    distance = radius + settings["far"] * place.diameter
    far = np.minimum(across, place.width - across) > distance
    grid = Grid.line(0.0, place.height, settings["bins"])
    counts = grid.sums(grid.cells(stretch.heights[far][:, None]))
    return counts / (len(stretch.heights) * (place.width - 2.0 * distance) * grid.volume)


def _fluid(
    place: Field, density: np.ndarray, temperature: float, settings: dict
) -> Callable[[np.ndarray], float | np.ndarray]:
    """The packing fraction at any heights: hydrostatics with as many discs as there are, layers excepted."""
    width = place.height / len(density)
    skip = int(np.ceil(settings["clear"] * place.diameter / width))
    z = np.linspace(skip * width, (len(density) - skip) * width, 1001)
    weight = place.masses[-1] * place.strength / temperature
    number = density[skip : len(density) - skip].sum() * width
    lowest = hydrostatic_profiles(z, [number], [weight], 2, place.diameter)[0, 0]
    eta = lowest * particle_volume(2, place.diameter)
    logarithm = np.log(eta) + excess_chemical_potential(eta, 2) + weight * z[0]
    return lambda height: packing_fraction_at(np.exp(logarithm - weight * height), 2)


def _fixed(point: Point, settings: dict) -> dict:
    """Force and effective radius of a fixed disc, and the fluid at its height."""
    place, found = field(point), stretches(point, settings["blocks"])
    radius, height = _large(point, place)
    ratio = 2.0 * radius / place.diameter
    unit = place.masses[-1] * place.strength
    force = np.array([s.floor - s.ceiling - place.weight - s.gain for s in found])
    density = np.array([_far(place, stretch, radius, settings) for stretch in found])
    temperatures = np.array([stretch.temperature for stretch in found])
    # The undisturbed density where the disc is: its mean over the disc's area.
    z = (np.arange(settings["bins"]) + 0.5) * place.height / settings["bins"]
    chord = np.sqrt(np.maximum(radius**2 - (z - height) ** 2, 0.0))
    chord /= chord.sum()
    volume = particle_volume(2, place.diameter)

    # One smooth profile for all blocks, scaled to each one's number: missing discs are counted relative to
    # it.
    fluid = _fluid(place, density.mean(axis=0), temperatures.mean(), settings)
    reach = radius + settings["near"] * place.diameter
    across, up = _disc(reach)
    undisturbed = float((fluid(height + up) * across).sum() / volume)
    inside = np.array([_inside(place, s, height, reach) for s in found])
    total = density.sum(axis=1) / density.mean(axis=0).sum()

    def radius_of(displaced: float, density: np.ndarray) -> float:
        return np.sqrt(displaced / (np.pi * (chord @ density))) / (0.5 * place.diameter) - ratio

    made = {
        "force": jackknife(lambda f: f / unit, force),
        "missing": jackknife(lambda n, share: undisturbed * share - n, inside, total),
        "packing_fraction": jackknife(lambda rho: chord @ rho * volume, density),
        "force_radius": jackknife(lambda f, rho: radius_of(f / unit, rho), force, density),
        "count_radius": jackknife(
            lambda n, share, rho: radius_of(undisturbed * share - n, rho), inside, total, density
        ),
    }
    row = entries(made, len(found) - 1)
    return row | {
        "height": height,
        "size_ratio": ratio,
        "radius_expected": float(np.sqrt(displaced_area(row["packing_fraction"], ratio)) - ratio),
        "fluid": fluid,
    }


def _disc(radius: float, points: int = 400) -> tuple[np.ndarray, np.ndarray]:
    """Strips of a disc: area and height above its centre, (points,) each."""
    up = radius * ((np.arange(points) + 0.5) * 2.0 / points - 1.0)
    return 2.0 * np.sqrt(radius**2 - up**2) * 2.0 * radius / points, up


def _inside(place: Field, stretch: Stretch, height: float, radius: float) -> float:
    """Mean number of small discs within `radius` of the large one's centre."""
    across = np.abs(stretch.positions[:, 1:, 0] - stretch.positions[:, :1, 0])
    across = np.minimum(across, place.width - across)
    square = across**2 + (stretch.heights[:, 1:] - height) ** 2
    return float((square < radius**2).sum(axis=1).mean())


def _free(point: Point, settings: dict) -> dict:
    """Where a free disc is, and where Boltzmann's factor of its weight and the displaced one's wants it."""
    place, found = field(point), stretches(point, settings["blocks"])
    radius, _ = _large(point, place)
    ratio = 2.0 * radius / place.diameter
    mass = point.scene.particles[0].mass
    heights = np.array([[s.heights[:, 0].mean(), (s.heights[:, 0] ** 2).mean()] for s in found])
    warm = float(np.mean([stretch.temperature for stretch in found]))
    fluid = _fluid(place, np.mean([_far(place, s, radius, settings) for s in found], axis=0), warm, settings)
    margin = radius - 0.5 * place.diameter
    z = np.linspace(margin, place.height - margin, 2001)
    # The forces are integrated, not the work's differences taken: that of the fluid's pressure, by far the
    # largest, is then exact, and only the edge's relies on scaled-particle theory.
    eta = fluid(z)
    force = place.masses[-1] * eta * displaced_area(eta, ratio) - mass
    exponent = np.cumsum(force) * (z[1] - z[0]) * place.strength / warm
    chance = np.exp(exponent - exponent.max())
    chance /= chance.sum()
    expected = chance @ z
    value, error = jackknife(lambda h: np.array([h[0], np.sqrt(max(h[1] - h[0] ** 2, 0.0))]), heights)
    return {
        "mass": mass / place.masses[-1],
        "height": value[0],
        "height_error": error[0],
        "height_freedom": len(found) - 1,
        "spread": value[1],
        "spread_error": error[1],
        "expected": expected,
        "expected_spread": np.sqrt(chance @ (z - expected) ** 2),
        "lowest": margin,
        "highest": place.height - margin,
        "density": mass / (np.pi * radius**2),
    }


def _large(point: Point, place: Field) -> tuple[float, float]:
    """Radius of the large disc, and the height of its place in the scene file."""
    particle = point.scene.particles[0]
    return particle.radius, particle.position[1] - 0.5 * place.diameter
