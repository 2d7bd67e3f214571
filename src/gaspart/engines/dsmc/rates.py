"""How often particles collide, what the engine's settings follow from, and with what error.

Mean values of a gas that fills its container evenly, with Maxwellian velocities of each kind's mean square.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from gaspart.scene.geometry import ball_volume
from gaspart.scene.scene import Scene
from gaspart.scene.species import Particle, Species

SLOPE, BEND = {2: 0.5625, 3: 1.5}, {2: 0.0, 3: 0.5}
"""Coefficients of the contact value, see `contact_values`, by dimension."""
_HIGHEST = 0.7  # packing fraction up to which contact values are evaluated


@dataclass(frozen=True)
class Rates:
    """frequency: collisions of a particle per time; speed: the mean speed; path: the mean free path with all
    kinds of particles at one temperature, infinite if nothing collides."""

    frequency: float
    speed: float
    path: float

    def crowded(self, times: float) -> Rates:
        """The rates where the density is so many times as high."""
        return Rates(times * self.frequency, self.speed, self.path / times)


def accessible(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """(d,), (d,): the lowest and highest coordinates of centres of the smallest particles."""
    lower, upper = scene.reach(scene.smallest_radius)
    return np.array(lower), np.array(upper)


def contact_values(number_densities: np.ndarray, radii: np.ndarray, dimension: int) -> np.ndarray:
    """(K, K) pair distributions at contact of a mixture.

    Boublik, J. Chem. Phys. 53, 471 (1970), and Mansoori et al., J. Chem. Phys. 54, 1523 (1971), for spheres,
    which for one species is Carnahan & Starling's; Jenkins & Mancini, J. Appl. Mech. 54, 27 (1987), for
    discs, which is Henderson's.
    """
    filled = ball_volume(dimension) * float((number_densities * radii**dimension).sum())
    free = 1.0 - min(filled, _HIGHEST)
    surface = ball_volume(dimension) * float((number_densities * radii ** (dimension - 1)).sum())
    ratio = surface * 2.0 * radii[:, None] * radii / (radii[:, None] + radii)
    return 1.0 / free + SLOPE[dimension] * ratio / free**2 + BEND[dimension] * ratio**2 / free**3


Kinds: TypeAlias = Sequence[Species | Particle]


def rates(scene: Scene, dense: bool, instead: Kinds | None = None) -> Rates:
    """The rates of a scene at its start, or as hot as its faces; dense: with contact values of a dense gas;
    instead: fewer kinds of particles that stand for those of the scene, each pair of which is evaluated."""
    d, kinds = scene.dimension, scene.moving_kinds if instead is None else instead
    heat = max(scene.face_temperatures, default=0.0)
    if not kinds:
        return Rates(0.0, 0.0, math.inf)
    squares = [max(square_of(kind, d), heat / kind.mass) for kind in kinds]
    often, speed = _rates(scene, kinds, dense, [1.0 / kind.mass for kind in kinds])
    return Rates(*_rates(scene, kinds, dense, squares), path=speed / often if often > 0.0 else math.inf)


def highest_speed(scene: Scene) -> float:
    """The highest mean speed that particles can come to have with the energy of the start, all of it shared
    so that each has the same momentum."""
    kinds = scene.moving_kinds
    energy = sum(
        0.5 * kind.count * kind.mass * scene.dimension * square_of(kind, scene.dimension) for kind in kinds
    )
    inverse, number = sum(kind.count / kind.mass for kind in kinds), sum(kind.count for kind in kinds)
    return math.sqrt(2.0 * energy * inverse) / max(1, number)


def _rates(scene: Scene, kinds: Kinds, dense: bool, squares: list[float]) -> tuple[float, float]:
    """Frequency and speed of kinds with these mean squares of a velocity component."""
    d, square = scene.dimension, np.array(squares)
    radius = np.array([kind.radius for kind in kinds])
    number = np.array([float(kind.count) for kind in kinds])
    lower, upper = accessible(scene)
    density = number / float((upper - lower).prod())
    sigma = radius[:, None] + radius
    section = math.pi * sigma**2 if d == 3 else 2.0 * sigma
    mean = 8.0 / math.pi if d == 3 else math.pi / 2.0  # of <v>^2 / (kT/m)
    relative = np.sqrt(mean * (square[:, None] + square))
    pairs = density[:, None] * (number - np.eye(len(number)))
    contact = contact_values(density, radius, d) if dense else 1.0
    frequency = float((np.maximum(pairs, 0.0) * section * relative * contact).sum() / number.sum())
    return frequency, float((number * np.sqrt(mean * square)).sum() / number.sum())


def square_of(kind: Species | Particle, dimension: int) -> float:
    """The mean square of a velocity component at the start."""
    if isinstance(kind, Particle):
        return sum(v * v for v in kind.velocity) / dimension
    return (
        kind.temperature / kind.mass if kind.temperature is not None else (kind.speed or 0.0) ** 2 / dimension
    )
