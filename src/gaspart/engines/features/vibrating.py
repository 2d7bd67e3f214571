"""Faces that vibrate."""

from __future__ import annotations

import numpy as np

from gaspart.engines.features.part import Part
from gaspart.kernels.model import Model, Motion
from gaspart.scene.faces import Vibrating
from gaspart.scene.scene import Scene

# A particle that is pressed to the face meets it again after a part of an epoch, or of the duration of a
# contact, if that is longer; of the period, if the face's acceleration presses it, and that is shorter.
_OF_EPOCH, _OF_DURATION, _OF_PERIOD = 2.0**-24, 2.0**-3, 2.0**-15
_OF_SPEED = 2.0**-48  # it parts with this part of the face's speed at least


def motion_of(scene: Scene) -> Motion | None:
    """How the faces move, before the first epoch; None if none vibrates."""
    moving = scene.faces_of(Vibrating)
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


class VibratingPart(Part):
    """Faces that move as prescribed: up to twice as fast as they do themselves particles leave them."""

    def __init__(self, scene: Scene, motion: Motion) -> None:
        super().__init__({})
        self._scene, self._motion, self._faces = scene, motion, scene.faces_of(Vibrating)
        self.gained = (2.0 * max(face.greatest_speed for _, face in self._faces)) ** 2

    def begin_epoch(self, length: float, start: float, model: Model) -> Model:
        """Let the periods go on where the clocks are at zero. The remainder of a division is exact, so that
        phases do not drift."""
        scene, motion = self._scene, self._motion
        motion.epoch[0] = length
        for n, face in self._faces:
            pull = abs(scene.gravity[n // 2]) if scene.gravity is not None else 0.0
            hop = max(_OF_EPOCH * length, _OF_DURATION * scene.contact_duration)
            motion.begun[n] = np.fmod(start, face.period)
            motion.slowest[n] = (
                0.5 * pull * hop
                + 0.5 * face.greatest_acceleration * min(hop, _OF_PERIOD * face.period)
                + face.greatest_speed * _OF_SPEED
            )
        return model
