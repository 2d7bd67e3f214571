"""Open faces, through which particles leave and enter: requirements and maximum number of particles."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gaspart.errors import SceneError
from gaspart.scene.faces import FACES, Open
from gaspart.scene.geometry import CLOSE_PACKING, ball_volume

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene

MOST_ATTEMPTS = 1e12
"""Maximum number of attempts to enter while a particle of the reservoir crosses the container."""
_SIGMAS = 10.0  # standard deviations of the number of an ideal gas for which there is room


def check_open_faces(scene: Scene) -> None:
    """Raise SceneError for a scene in which entering or leaving particles are not defined.

    This concerns scenes with open faces.
    """
    for number, reservoir in scene.faces_of(Open):
        face = f"faces.{FACES[number]}"
        if not scene.centres_to_walls:
            raise SceneError(face, "open", "is passed by centres of particles: needs centres_to_walls: true")
        if len(scene.species) != 1 or scene.particles or not scene.count:
            raise SceneError(face, "open", "needs particles of one species, and no single ones")
        _check_attempts(scene, number, reservoir)


def _check_attempts(scene: Scene, number: int, face: Open) -> None:
    """Raise SceneError for a reservoir whose attempts to enter would stop the time."""
    speed = math.sqrt((face.temperature or 0.0) / scene.species[0].mass)
    if speed:
        attempts = attempt_rate(scene, number, face) * scene.container.lengths[number // 2] / speed
        if not attempts <= MOST_ATTEMPTS:
            rule = (
                f"must let at most {MOST_ATTEMPTS:g} particles try to enter "
                f"while one of them crosses the container, not {attempts:.2g}"
            )
            raise SceneError(f"faces.{FACES[number]}.activity", face.activity, rule)


def refuse_open(scene: Scene, rule: str) -> None:
    """Raise SceneError, with a rule, for a scene with open faces."""
    for number, face in scene.faces_of(Open):
        raise SceneError(f"faces.{FACES[number]}", face.kind, rule)


def number_density(scene: Scene, face: Open) -> float:
    """Return the number density of the ideal gas in equilibrium with a reservoir.

    It is 0 for a vacuum.
    """
    return (face.activity or 0.0) / ball_volume(scene.dimension, scene.species[0].radius)


def attempt_rate(scene: Scene, number: int, face: Open) -> float:
    """Return the number of particles per time that try to enter through a face.

    The rate through an open face of area A is z A (k_B T / 2 pi m)^(1/2).
    """
    area = scene.container.volume / scene.container.lengths[number // 2]
    width = math.sqrt((face.temperature or 0.0) / scene.species[0].mass)
    return number_density(scene, face) * area * width / math.sqrt(2.0 * math.pi)


def capacity(scene: Scene) -> int:
    """Return the maximum number of particles.

    It is the number at the start, and with open faces the number that may come in, 10 standard deviations
    above the mean. Particles that repel one another are fewer than the particles of an ideal gas at the same
    activity, whose number has the distribution of Poisson. The pressure inside is at most the pressure of the
    strongest reservoir, and the gas is at least as hot as the coldest face or wall. The number is never
    higher than the number that fits.
    """
    reservoirs = [face for _, face in scene.faces_of(Open) if face.temperature is not None]
    if not reservoirs:
        return scene.count
    species, d = scene.species[0], scene.dimension
    pressure = max(number_density(scene, face) * (face.temperature or 0.0) for face in reservoirs)
    mean = pressure / min(scene.face_temperatures) * scene.container.volume
    most = scene.count + mean + _SIGMAS * math.sqrt(mean) + _SIGMAS
    around = math.prod(length + 2.0 * species.radius for length in scene.container.lengths)
    packed = CLOSE_PACKING[d] * around / ball_volume(d, species.radius)
    return max(scene.count, math.ceil(min(most, packed)))
