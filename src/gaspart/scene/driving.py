"""Drives of a gas: a uniform force along a periodic axis, and a stochastic thermostat."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from gaspart.errors import SceneError
from gaspart.keys import declare, positive, validate

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene
    from gaspart.scene.walls import Plate, Wall


_MOMENTUM = (
    "fixed particles, interior walls across it, rough contacts with walls, or faces or walls at a temperature"
)
_ENERGY = "inelastic contacts, or faces or walls at a temperature"


def check_driven(scene: Scene) -> None:
    """Raise SceneError if a force along a periodic axis would accelerate the gas forever.

    The scene must have a sink for the momentum that the force adds, and a sink for the energy that it adds.
    """
    for axis in scene.driven_axes:
        for has_sink, quantity, by in (
            (_takes_momentum(scene, axis), "momentum", _MOMENTUM),
            (_takes_energy(scene), "energy", _ENERGY),
        ):
            if not has_sink:
                rule = (
                    f"gives energy without limit along {'xyz'[axis]}, a periodic axis, where nothing takes "
                    f"the {quantity}: {by} would"
                )
                raise SceneError("gravity", scene.gravity, rule)


def _takes_momentum(scene: Scene, axis: int) -> bool:
    """Return True if particles exchange momentum along a periodic axis with other objects.

    The other objects are fixed particles, interior walls and faces of the container.
    """
    if scene.has_fixed:
        return True
    length = scene.container.lengths[axis]
    if any(wall.temperature or not _spans(wall, axis, length) for wall in scene.walls):
        return True
    surfaces = bool(scene.walls) or not scene.is_periodic
    return (scene.rough and surfaces) or not all(face.smooth for face in scene.faces.values())


def _takes_energy(scene: Scene) -> bool:
    """Return True if contacts lose energy, or faces or walls at a temperature exchange energy."""
    return scene.dissipates or bool(scene.face_temperatures)


def _spans(wall: Wall | Plate, axis: int, length: float) -> bool:
    """Return True if a wall spans the container along an axis.

    No particle then hits the ends of the wall along this axis.
    """
    first, *others = wall.corners.values()
    edges = ([b - a for a, b in zip(first, corner, strict=True)] for corner in others)
    return any(abs(edge[axis]) >= length and not any(edge[:axis] + edge[axis + 1 :]) for edge in edges)


# Stochastic thermostat.


@dataclass(frozen=True)
class Thermostat:
    """Random kicks of all particles at regular times.

    The kicks add energy, so that a dissipative gas can reach a steady state [1]_.

    Parameters
    ----------
    power : float, [energy/time]
        Mean energy that each particle receives per unit of time.
    interval : float, [time]
        Time between kicks. It should be short compared with the time between contacts.

    Raises
    ------
    SceneError
        If a value is not positive.

    Notes
    -----
    At each multiple of `interval`, a normal random number is added to every velocity component of a particle
    of mass m. Its variance is 2 power interval/(d m). Then the same velocity is subtracted from all
    particles, so that the total momentum is conserved. For short intervals this is white noise of strength
    xi_0^2 = 2 power/(d m).

    References
    ----------
    .. [1] D. R. M. Williams and F. C. MacKintosh, Phys. Rev. E 54, R9 (1996).

    Examples
    --------
    >>> import gaspart as gp
    >>> gas = gp.Species(count=100, radius=0.5, temperature=1.0)
    >>> heated = gp.Scene(
    ...     gp.Container((30.0, 30.0), boundary="periodic"),
    ...     species=[gas],
    ...     restitution=gp.Restitution(normal=0.9),
    ...     thermostat=gp.Thermostat(power=0.1, interval=0.01),
    ... )
    >>> heated.thermostat.power
    0.1
    """

    power: float = field(metadata=declare(positive("mean energy per time that a particle is given")))
    interval: float = field(
        metadata=declare(positive("time between kicks: short compared with that between contacts"))
    )

    def __post_init__(self) -> None:
        validate(self)
