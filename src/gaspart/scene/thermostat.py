"""A stochastic thermostat."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from gaspart.errors import SceneError
from gaspart.scene.keys import POSITIVE, declared, validate

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene


@dataclass(frozen=True)
class Thermostat:
    """Random kicks of all particles at regular times, which let a dissipative gas reach a steady state
    (Williams & MacKintosh, Phys. Rev. E 54, R9 (1996)).

    At each multiple of `interval` every velocity component of a particle of mass m is changed by a normal
    random number of variance 2 power interval/(d m), and then all velocities by the same, so that the total
    momentum is kept. For short intervals this is white noise of strength xi_0^2 = 2 power/(d m).
    """

    power: float = field(metadata=declared(POSITIVE, "mean energy per time that a particle is given"))
    interval: float = field(
        metadata=declared(POSITIVE, "time between kicks: short compared with that between contacts")
    )

    def __post_init__(self) -> None:
        validate(self)


def check_thermostat(scene: Scene) -> None:
    """Raise SceneError for a scene in which kicks are not defined."""
    if scene.thermostat is None:
        return
    if scene.gravity is not None and any(scene.gravity):
        raise SceneError("thermostat", scene.thermostat, "needs a scene without gravity")
    if any(face.kind != "thermal" for face in scene.faces.values()):
        raise SceneError("thermostat", scene.thermostat, "needs faces that are hard or thermal")
