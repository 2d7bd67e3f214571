"""A face that is a piston."""

from __future__ import annotations

import numpy as np

from gaspart.engines.features.part import Part
from gaspart.kernels import model as kernels
from gaspart.kernels.obstacles.piston import advance_piston
from gaspart.scene.scene import Scene
from gaspart.state.state import State

_UNMOVED = 2.0**1000  # the mass of one at a stated speed: contacts change no bit of its velocity
_OF_EPOCH = 2.0**-24  # a particle at rest on which the piston lies meets it again after this part of an epoch


def piston_of(scene: Scene, state: State, unit_mass: float) -> kernels.Piston | None:
    """The piston of a state, in units of `unit_mass`; None if there is none."""
    if not scene.pistons or state.piston is None:
        return None
    ((n, face),) = scene.pistons
    x, velocity = state.piston
    inwards = (scene.container.lengths[n // 2] - x, -velocity) if n % 2 else (x, velocity)
    push = face.acceleration(scene, n // 2)
    mass = _UNMOVED if face.mass is None else face.mass / unit_mass
    return kernels.Piston(n, mass, push, np.array([*inwards, 0.0]), np.zeros(1))


class PistonPart(Part):
    """The piston of a scene: twice its speed, stated or that which its load gives it, is what it can give a
    particle."""

    def __init__(self, piston: kernels.Piston, scene: Scene) -> None:
        super().__init__({"piston": piston.motion})
        self._piston, self._lengths = piston, scene.container.lengths
        ((number, face),) = scene.pistons
        fallen = 2.0 * face.acceleration(scene, number // 2) * self._lengths[number // 2]
        self.gained = 4.0 * (fallen if face.speed is None else face.speed**2)

    def set_clock(self, clock: float) -> None:
        """Let the present motion be that at this time."""
        self._piston.motion[kernels.PISTON_CLOCK] = clock

    def begin_epoch(self, length: float, start: float, model: kernels.Model) -> kernels.Model:
        """Set the speed at which particles part from it."""
        self._piston.slowest[0] = 0.5 * self._piston.push * _OF_EPOCH * length
        return model

    def end_epoch(self, length: float, start: float) -> None:
        """Move it to the end of the epoch, and let that be time 0 of its clock."""
        advance_piston(self._piston.motion, self._piston.push, length)
        self.set_clock(0.0)

    def write(self, state: State, clock: float) -> None:
        """Write where it is along its axis, and its velocity."""
        piston, motion = self._piston, self._piston.motion.copy()
        advance_piston(motion, piston.push, clock)
        place, velocity = motion[kernels.PISTON_PLACE], motion[kernels.PISTON_VELOCITY]
        upper = piston.face % 2 == 1
        state.piston = np.array(
            [self._lengths[piston.face // 2] - place, -velocity] if upper else [place, velocity]
        )
