"""Collision rate, mean speed and mean free path of a scene.

The rates are for a gas that fills its container homogeneously. The velocities of each kind are Maxwellian,
with the mean square of the kind. The engines choose settings by these rates, so this module imports no other
theory except for `discretisation`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from gaspart.scene.boundaries import mean_count
from gaspart.scene.scene import Scene
from gaspart.scene.sizes import ball_volume
from gaspart.scene.species import Particle, Species
from gaspart.theory.discretisation import contact_values

MEAN_SQUARE = {2: math.pi / 2.0, 3: 8.0 / math.pi}
"""Square of the mean of Maxwell's speeds, in units of k_B T / m, by dimension."""


@dataclass(frozen=True)
class Rates:
    """Mean collision rate, speed and free path of a gas."""

    frequency: float
    speed: float
    path: float

    def at_density(self, times: float) -> Rates:
        """Return the rates at a density multiplied by `times`."""
        return Rates(times * self.frequency, self.speed, self.path / times)


def usual_count(scene: Scene) -> float:
    """Return the number of particles for rates; between open faces at the start or by the strongest
    reservoir.
    """
    return max(scene.count, mean_count(scene)) if scene.is_open else scene.count


def accessible(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Return the lowest and highest coordinates (d,) of the centres of the smallest particles."""
    lower, upper = scene.reach(scene.smallest_radius)
    return np.array(lower), np.array(upper)


Kinds: TypeAlias = Sequence[Species | Particle]


def rates(scene: Scene, dense: bool, instead: Kinds | None = None) -> Rates:
    """Compute the collision rates of a scene in its initial state. If the faces are hotter than the
    particles, the temperature of the faces is used. `dense`: True to use the contact values of a dense gas.
    `instead`: representative kinds of particles that replace the kinds of the scene, because each pair of
    kinds is evaluated.
    """
    d, kinds = scene.dimension, scene.moving_kinds if instead is None else instead
    heat = max(scene.face_temperatures, default=0.0)
    if not kinds:
        return Rates(0.0, 0.0, math.inf)
    squares = [max(square_of(kind, d), heat / kind.mass) for kind in kinds]
    often, speed = _rates(scene, kinds, dense, [1.0 / kind.mass for kind in kinds])
    return Rates(*_rates(scene, kinds, dense, squares), path=speed / often if often > 0.0 else math.inf)


def rate_at_scatterers(scene: Scene) -> float:
    """Compute the collisions per time of a moving particle with fixed ones: mean speed times cross section
    per free volume.
    """
    d, moving = scene.dimension, scene.moving_kinds
    fixed = [kind for kind in scene.kinds if kind.fixed and kind.count]
    if not fixed or not moving:
        return 0.0
    heat, (lower, upper) = max(scene.face_temperatures, default=0.0), accessible(scene)
    number, radius = (
        np.array([getattr(kind, key) for kind in fixed], dtype=float) for key in ("count", "radius")
    )
    volume, total = float((upper - lower).prod()), 0.0
    for kind in moving:
        sigma = radius + kind.radius
        covered = ball_volume(d) * float((number * sigma**d).sum()) / volume
        free = volume * (1.0 - covered if covered < 1.0 else math.exp(-covered))  # they may overlap
        section = float((number * (2.0 * sigma if d == 2 else math.pi * sigma**2)).sum())
        speed = math.sqrt(MEAN_SQUARE[d] * max(square_of(kind, d), heat / kind.mass))
        total += kind.count * speed * section / free
    return total / sum(kind.count for kind in moving)


def highest_speed(scene: Scene) -> float:
    """Return the highest mean speed at the initial energy: all particles have momenta of equal magnitude."""
    kinds = scene.moving_kinds
    energy = sum(
        0.5 * kind.count * kind.mass * scene.dimension * square_of(kind, scene.dimension) for kind in kinds
    )
    inverse, number = sum(kind.count / kind.mass for kind in kinds), sum(kind.count for kind in kinds)
    return math.sqrt(2.0 * energy * inverse) / max(1, number)


def _rates(scene: Scene, kinds: Kinds, dense: bool, squares: list[float]) -> tuple[float, float]:
    """Return collision frequency and speed of kinds with given mean squares of a velocity component."""
    d, square = scene.dimension, np.array(squares)
    radius = np.array([kind.radius for kind in kinds])
    number = np.array([usual_count(scene) if scene.is_open else float(kind.count) for kind in kinds])
    lower, upper = accessible(scene)
    density = number / float((upper - lower).prod())
    section, mean = cross_sections(radius, d), MEAN_SQUARE[d]
    relative = np.sqrt(mean * (square[:, None] + square))
    pairs = density[:, None] * (number - np.eye(len(number)))
    contact = contact_values(density, radius, d) if dense else 1.0
    frequency = float((np.maximum(pairs, 0.0) * section * relative * contact).sum() / number.sum())
    return frequency, float((number * np.sqrt(mean * square)).sum() / number.sum())


def cross_sections(radii: np.ndarray, dimension: int) -> np.ndarray:
    """Return the cross section (K, K) of each pair of kinds, from their radii (K,)."""
    sigma = radii[:, None] + radii
    return math.pi * sigma**2 if dimension == 3 else 2.0 * sigma


def square_of(kind: Species | Particle, dimension: int) -> float:
    """Return the initial mean square of a velocity component."""
    if isinstance(kind, Particle):
        return sum(v * v for v in kind.velocity) / dimension
    return (
        kind.temperature / kind.mass if kind.temperature is not None else (kind.speed or 0.0) ** 2 / dimension
    )
