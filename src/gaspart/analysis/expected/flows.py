"""The mean velocity of a gas along an axis: at rest, sheared, and between plates that slide or that a force
drives it along."""

from __future__ import annotations

import math
from functools import reduce

import numpy as np

from gaspart import theory
from gaspart.analysis.bulk import BOLTZMANN
from gaspart.analysis.expected.run import Expected, equation_of
from gaspart.analysis.expected.walls import FLUID, FREE, Plates, dilute, heating_of, plates_of
from gaspart.analysis.run import Run
from gaspart.scene.scene import Scene
from gaspart.scene.shear import flow
from gaspart.scene.walls import Plate
from gaspart.theory.heat import TEMPERATURE_JUMP

_ROUNDING = 1e-6
"""Of the largest velocity: a drift below it is the rounding of frames."""


def velocity(run: Run, axis: int, places: np.ndarray) -> Expected | None:
    """(component, position) at places (P,) along an axis, in a steady state."""
    scene = run.scene
    if scene.shear_rate is not None:
        middle = np.tile(0.5 * np.array(scene.container.lengths), (len(places), 1))
        middle[:, axis] = places
        return flow(scene, middle).T + _drift(run), 0.0, "the flow of sheared images"
    if plates := plates_of(run):
        return _between(plates, run, axis, places)
    if plates := plates_of(run, driven=True):
        return _pushed(plates, run, axis, places)
    if scene.faces or scene.thermostat or run.dissipates or scene.driven_axes or scene.walls:
        return None
    if not run.moving.all():
        return None
    return np.repeat(_drift(run), len(places), axis=1), 0.0, "equilibrium"


def _drift(run: Run) -> np.ndarray:
    """(d, 1) the velocity of the centre of mass, about the flow of sheared images, along axes on which it is
    conserved, 0 along others."""
    velocities = run.velocities
    if run.scene.shear_rate is not None:
        velocities = velocities - flow(run.scene, run.positions)
    momentum = np.einsum("tnd,n->d", velocities, run.masses) / len(run.time)
    drift = momentum / run.masses.sum()
    seen = np.abs(drift) > _ROUNDING * np.abs(velocities).max()
    return np.where(run.conserved & seen, drift, 0.0)[:, None]


def _between(plates: Plates, run: Run, axis: int, places: np.ndarray) -> Expected | None:
    """Between plates of one temperature, or that do not slide."""
    velocities = dict(run.scene.sliding_faces)
    ends = [velocities.get(2 * plates.axis + side) for side in (0, 1)]
    rest = (0.0,) * run.dimension
    low, high = (np.array(face.velocity if face else rest) for face in ends)
    mean = np.repeat(0.5 * (low + high)[:, None], len(places), axis=1)
    if not plates.slide.any():
        return mean, 0.0, "the gas is at rest between the plates"
    if not plates.equal or len(set(plates.accommodation)) > 1:
        return None
    if axis != plates.axis:
        return mean, 0.0, "the mean of both plates, by symmetry"
    if plates.freedom > FREE:
        error = np.abs(plates.slide)[:, None] / plates.freedom
        return mean, error, "free flight between plates: half of the particles come from each"
    fluid = plates.accommodating and plates.knudsen <= FLUID and dilute(plates, run)
    if plates.dimension == 2 or not fluid:
        return None
    path = plates.knudsen * plates.length
    gap = plates.length + 2.0 * theory.VELOCITY_SLIP * path
    middle = 0.5 * run.scene.container.lengths[axis]
    values = mean + np.multiply.outer(plates.slide, (places - middle) / gap)
    wrong = np.abs(plates.slide)[:, None] * (plates.knudsen**2 + heating_of(plates))
    near = np.abs(places - middle) > 0.5 * plates.length - 2.0 * path  # the layer that no fluid describes
    return np.where(near, np.nan, values), wrong, "linear flow with slip"


def _pushed(plates: Plates, run: Run, axis: int, places: np.ndarray) -> Expected | None:
    """Along plates of one temperature at rest, by a force.

    Uncertain by the next order of the slip, by the packing fraction, and by half of what friction warms the
    gas: in units of k_B T, with the greatest velocity u, 4/45 m u^2 in the middle, and at the plates 32/45 m
    u^2 times the coefficient of the temperature jump times the Knudsen number.
    """
    slow = not plates.slide.any() and plates.equal and axis == plates.axis
    if not slow or plates.dimension == 2 or not 0.0 < plates.knudsen <= FLUID or not dilute(plates, run):
        return None
    length, temperature = plates.length, plates.temperatures[0]
    from_middle = places - 0.5 * run.scene.container.lengths[axis]
    near = np.abs(from_middle) > 0.5 * length - 2.0 * plates.knudsen * length
    heights = np.append(np.where(near, 0.0, from_middle), 0.0) + 0.5 * length  # and in the middle
    speeds = theory.channel_velocity(heights, length, plates.density, 1.0, plates.diameter)
    force = plates.mass * np.array(run.scene.gravity) / math.sqrt(plates.mass * temperature)
    values = np.multiply.outer(force, speeds)
    fastest = values[:, -1]
    warmer = plates.mass * float(fastest @ fastest) / temperature
    warmer *= 4.0 / 45.0 + 32.0 / 45.0 * TEMPERATURE_JUMP * plates.knudsen
    dense = 0.0 if equation_of(run) == BOLTZMANN else plates.filled
    wrong = np.abs(fastest)[:, None] * (8.0 * plates.knudsen**2 + 0.5 * warmer + dense)
    return np.where(near, np.nan, values[:, :-1]), wrong, "Poiseuille's flow with slip"


def flux(run: Run, axis: int, place: float, members: np.ndarray, beyond: np.ndarray) -> Expected | None:
    """(component,) particles that pass the plane across an axis per time; members (n,): those that count;
    beyond (T,): how many of them are beyond the plane."""
    scene = run.scene
    if not scene.walls:
        return _closed(run)
    masses, radii = run.masses[members], run.radii[members]
    area = opening(scene, axis, place, float(radii.max()))
    moved = scene.thermostat or run.dissipates or run.has_gravity or scene.moving_wall
    plain = not (scene.faces or scene.face_temperatures or moved)
    alike = np.ptp(masses) == 0.0 and np.ptp(radii) == 0.0 and run.moving.all()
    if area is None or not alike or not plain or _path(run) < area ** (1.0 / (run.dimension - 1)):
        return None
    lower, upper = (np.array(ends) for ends in scene.reach(float(radii.max())))
    across = np.delete(upper - lower, axis).prod()
    sides = across * np.array([place - lower[axis], upper[axis] - place])
    numbers = np.array([len(members) - beyond.mean(), beyond.mean()])
    speed = math.sqrt(run.temperature / (2.0 * math.pi * masses[0]))
    rates = numbers / sides * speed * area
    spent = abs(int(beyond[-1]) - int(beyond[0])) / max(1.0, numbers.max())
    source = f"free flight through an opening of {area:.4g}"
    return np.array([rates[0] - rates[1]]), float(rates.max()) * spent, source


def _closed(run: Run) -> Expected | None:
    """Return the flux 0 of a steady state; None for a start in a region, and beside a piston, which moves
    what it compresses."""
    scene = run.scene
    if scene.is_open or scene.has_piston or any(kind.region is not None for kind in scene.species):
        return None
    return np.zeros(1), 0.0, "a steady state between walls"


def _path(run: Run) -> float:
    """The mean free path of the largest particles in the whole container."""
    lower, upper = run.scene.reach(run.scene.largest_radius)
    density = run.count / float(np.subtract(upper, lower).prod())
    filled = theory.packing_fraction(density, run.dimension, 2.0 * run.scene.largest_radius)
    if filled > theory.HIGHEST_PACKING_FRACTION[run.dimension]:
        return 0.0
    return float(theory.mean_free_path(filled, run.dimension, 2.0 * run.scene.largest_radius))


def opening(scene: Scene, axis: int, place: float, radius: float) -> float | None:
    """The area of the plane across an axis, in two dimensions its length, that interior walls in it leave to
    centres of particles of a radius. None if no wall lies in it, or if a plate is not along the axes."""
    across = [k for k in range(scene.dimension) if k != axis]
    near, length = 1e-9 * scene.container.lengths[axis], scene.container.lengths[axis]
    shadows = []
    for wall in scene.walls:
        corners = np.array(list(wall.corners.values()))
        if np.abs(corners[:, axis] - place).max() > near:
            continue
        if isinstance(wall, Plate) and any(np.count_nonzero(edge) > 1 for edge in wall.edges):
            return None
        shadows.append([corners[:, across].min(axis=0) - radius, corners[:, across].max(axis=0) + radius])
    if not shadows or not length > 0.0:
        return None
    lower, upper = (np.array(ends)[across] for ends in scene.reach(radius))
    return _uncovered(np.array(shadows), lower, upper)


def _uncovered(shadows: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> float:
    """The measure of a box from lower to upper (k,) that boxes (W, 2, k) leave."""
    edges = [
        np.unique(np.clip(np.append(shadows[:, :, k], [lower[k], upper[k]]), lower[k], upper[k]))
        for k in range(len(lower))
    ]
    left = np.ones([len(edge) - 1 for edge in edges], dtype=bool)
    for low, high in shadows:
        covered = [
            (edge[:-1] >= a - 1e-12) & (edge[1:] <= b + 1e-12)
            for edge, a, b in zip(edges, low, high, strict=True)
        ]
        left &= ~reduce(np.logical_and.outer, covered)
    widths = reduce(np.multiply.outer, [np.diff(edge) for edge in edges])
    return float((widths * left).sum())
