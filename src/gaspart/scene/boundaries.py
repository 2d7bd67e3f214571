"""Faces in a run: flow between sheared faces, end of a piston's stroke, reservoirs behind open faces.

The module also contains the errors for scenes in which such faces have no meaning.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gaspart.errors import SceneError
from gaspart.scene.composition import Composition
from gaspart.scene.faces import FLOW, GRADIENT, LeesEdwards, Open
from gaspart.scene.sizes import CLOSE_PACKING, ball_volume
from gaspart.scene.surfaces import FACES, Thermal

if TYPE_CHECKING:
    import numpy as np

_SIGMAS = 10.0  # allowance for the number of an ideal gas, in standard deviations


def refuse_open(scene: Composition, rule: str) -> None:
    """Raise SceneError, with `rule` in its message, for a scene with open faces."""
    for number, face in scene.faces_of(Open):
        raise SceneError(f"faces.{FACES[number]}", face.kind, rule)


def refuse_sheared(scene: Composition, rule: str) -> None:
    """Raise SceneError, with `rule` in its message, for a scene with sheared faces."""
    for name, face in scene.faces.items():
        if isinstance(face, LeesEdwards):
            raise SceneError(f"faces.{name}", face.kind, rule)


def thermal_face(scene: Composition, name: str) -> Thermal:
    """Return the face with a name; raise SceneError unless it is thermal with a uniform temperature."""
    face = scene.faces.get(name)
    if not isinstance(face, Thermal) or face.varies_along is not None:
        raise SceneError(f"faces.{name}", face, "must be thermal, at one temperature")
    return face


def flow(scene: Composition, positions: np.ndarray) -> np.ndarray:
    """Return the velocity (..., d) of the flow at positions; 0 without shear."""
    return flow_of_rate(scene.shear_rate, scene.container.lengths[GRADIENT], positions)


def flow_of_rate(rate: float | None, height: float, positions: np.ndarray) -> np.ndarray:
    """Return the velocity (..., d) of a uniform shear flow at positions. Without a `rate`, the velocity is 0.
    `height`: side of the container along the gradient.
    """
    import numpy as np  # planning a workflow needs the rest of this module, but not this import

    velocities = np.zeros_like(positions, dtype=float)
    if rate is not None:
        velocities[..., FLOW] = rate * (positions[..., GRADIENT] - 0.5 * height)
    return velocities


def piston_end(scene: Composition, position: float | None = None) -> float:
    """Return the time at which a piston of prescribed speed compresses the particles to closest packing. The
    result is infinite if the scene has no such piston. `position`: position along the axis of the piston at
    time 0. Default: the side of the container.
    """
    for number, face in scene.pistons:
        if face.speed is not None:
            axis, length = number // 2, scene.container.lengths[number // 2]
            low, high = scene.reach(scene.largest_radius)
            packed = length * scene.packing_fraction / scene.closest_packing
            least = max(length - (high[axis] - low[axis]), packed)
            begin = 0.0 if position is None else length - position if number % 2 else position
            return max(0.0, length - begin - least) / face.speed
    return math.inf


def check_piston_end(scene: Composition, key: str, until: float, position: float | None = None) -> None:
    """Raise SceneError if a run would end, at `until`, later than `piston_end`. `key` names the setting of
    this end in the message.
    """
    end = piston_end(scene, position)
    if end < until:
        rule = f"must be before {end:.6g}, when the piston leaves no room for the particles"
        raise SceneError(key, until, rule)


def number_density(scene: Composition, face: Open) -> float:
    """Return the number density of an ideal gas that would be in equilibrium with a reservoir. The density is
    0 for a vacuum.
    """
    return (face.activity or 0.0) / ball_volume(scene.dimension, scene.species[0].radius)


def attempt_rate(scene: Composition, number: int, face: Open) -> float:
    """Return the number of particles per time that try to enter through a face. The rate through an open face
    of area A is z A (k_B T / 2 pi m)^(1/2), where z is the number density of the reservoir as an ideal gas.
    The argument `number` is the index of the face.
    """
    area = scene.container.volume / scene.container.lengths[number // 2]
    width = math.sqrt((face.temperature or 0.0) / scene.species[0].mass)
    return number_density(scene, face) * area * width / math.sqrt(2.0 * math.pi)


def mean_count(scene: Composition) -> float:
    """Return an upper bound of the mean number of particles between reservoirs. The bound is the mean number
    for an ideal gas at the same activity, or 0 if there is a vacuum behind every open face. Particles that
    repel each other are fewer than particles of an ideal gas. The pressure in the container is at most the
    pressure of the strongest reservoir. The gas is at least as hot as the coldest face or wall.
    """
    reservoirs = [face for _, face in scene.faces_of(Open) if face.temperature is not None]
    if not reservoirs:
        return 0.0
    pressure = max(number_density(scene, face) * (face.temperature or 0.0) for face in reservoirs)
    return pressure / min(scene.face_temperatures) * scene.container.volume


def capacity(scene: Composition) -> int:
    """Return the largest number of particles that the program provides for. Without open faces this is the
    number at the start. With reservoirs it is the mean number in equilibrium plus 10 standard deviations; the
    number of particles of an ideal gas has a Poisson distribution. The result never exceeds the number of
    particles that fit into the container.
    """
    mean = mean_count(scene)
    if mean == 0.0:
        return scene.count
    species, d = scene.species[0], scene.dimension
    most = scene.count + mean + _SIGMAS * math.sqrt(mean) + _SIGMAS
    around = math.prod(length + 2.0 * species.radius for length in scene.container.lengths)
    packed = CLOSE_PACKING[d] * around / ball_volume(d, species.radius)
    return max(scene.count, math.ceil(min(most, packed)))
