"""Vibrating faces of a scene, as the kernels know them."""

from __future__ import annotations

import numpy as np

from gaspart.kernels.model import Motion
from gaspart.scene.faces import FACES, Vibrating
from gaspart.scene.scene import Scene

# A particle that is pressed to the face meets it again after a part of an epoch, or of the duration of a
# contact, if that is longer; of the period, if the face's acceleration presses it, and that is shorter.
_OF_EPOCH, _OF_DURATION, _OF_PERIOD = 2.0**-24, 2.0**-3, 2.0**-15
_OF_SPEED = 2.0**-48  # it parts with this part of the face's speed at least


def vibrating_faces(scene: Scene) -> list[tuple[int, Vibrating]]:
    """The vibrating faces, with their number."""
    found = ((n, scene.faces.get(name)) for n, name in enumerate(FACES[: 2 * scene.dimension]))
    return [(n, face) for n, face in found if isinstance(face, Vibrating)]


def greatest_speed(scene: Scene) -> float:
    """The greatest speed of any face, 0 if none vibrates."""
    return max((face.greatest_speed for _, face in vibrating_faces(scene)), default=0.0)


def motion_of(scene: Scene) -> Motion | None:
    """How the faces move, before the first epoch; None if none vibrates."""
    moving = vibrating_faces(scene)
    if not moving:
        return None
    shape = (2 * scene.dimension,)
    motion = Motion(
        stroke=np.zeros(shape),
        period=np.zeros(shape),
        sine=np.zeros(shape, dtype=bool),
        begun=np.zeros(shape),
        slowest=np.zeros(shape),
        epoch=np.zeros(1),
    )
    for n, face in moving:
        motion.stroke[n], motion.period[n] = 2.0 * face.amplitude, face.period
        motion.sine[n] = face.waveform == "sine"
    return motion


def begin_epoch(motion: Motion, scene: Scene, start: float, epoch: float) -> None:
    """Let the clocks count from the time `start`, for an epoch of this length. The remainder of a division
    is exact, so that phases do not drift."""
    motion.epoch[0] = epoch
    for n, face in vibrating_faces(scene):
        pull = abs(scene.gravity[n // 2]) if scene.gravity is not None else 0.0
        hop = max(_OF_EPOCH * epoch, _OF_DURATION * scene.contact_duration)
        motion.begun[n] = np.fmod(start, face.period)
        motion.slowest[n] = (
            0.5 * pull * hop
            + 0.5 * face.greatest_acceleration * min(hop, _OF_PERIOD * face.period)
            + face.greatest_speed * _OF_SPEED
        )
