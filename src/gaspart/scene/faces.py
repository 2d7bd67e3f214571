"""Faces of a container: those that move or let particles through, and the table of all kinds."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, ClassVar, Protocol

from gaspart.errors import SceneError
from gaspart.keys import (
    choice,
    declare,
    describe,
    documented,
    from_mapping,
    not_negative,
    positive,
    real,
    schema_of,
)
from gaspart.keys.values import one_of, size
from gaspart.scene.surfaces import FACE_KINDS, FACES, Surface

if TYPE_CHECKING:
    import numpy as np

    from gaspart.scene.container import Container

WAVEFORMS = ("sine", "sawtooth")
FLOW, GRADIENT = 0, 1
"""Axis of the flow of a sheared gas, and axis of its gradient."""


@documented
@dataclass(frozen=True)
class Vibrating(Surface):
    """A hard wall with a prescribed vibration, which gives energy to particles or takes it.

    The wall is at the side of the container at time 0, and moves inwards from this side by at most 2 A. The
    sine has the inward displacement A (1 - cos(2 pi t / period)). The sawtooth moves inwards at the speed 2 A
    / period. At the end of each period it returns instantaneously. Contacts follow the collision law of the
    scene in the frame of the wall.

    Examples
    --------
    >>> import gaspart as gp
    >>> floor = gp.Vibrating(amplitude=0.1, period=2.0)
    >>> floor.places([0.0, 1.0])
    array([0. , 0.2])
    """

    amplitude: float = field(
        metadata=declare(positive("amplitude A [length], half the distance that the wall moves"))
    )
    period: float = field(metadata=declare(positive("duration of one vibration [time]")))
    waveform: str = field(
        default="sine", metadata=declare(choice("displacement as a function of time", *WAVEFORMS))
    )

    kind: ClassVar[str] = "vibrating"
    moves: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        size("period", self.greatest_speed)
        size("period", self.greatest_acceleration)

    @property
    def greatest_speed(self) -> float:
        """Maximum speed of the wall, except during the return of the sawtooth."""
        return (2.0 * math.pi if self.waveform == "sine" else 2.0) * self.amplitude / self.period

    @property
    def greatest_acceleration(self) -> float:
        """Maximum acceleration of the wall, except during the return of the sawtooth."""
        return 2.0 * math.pi * self.greatest_speed / self.period if self.waveform == "sine" else 0.0

    def places(self, times: np.ndarray) -> np.ndarray:
        """Return the inward displacement of the wall from the side of the container at some times."""
        import numpy as np

        turns = np.fmod(times, self.period) / self.period
        if self.waveform == "sawtooth":
            return 2.0 * self.amplitude * turns
        return self.amplitude * (1.0 - np.cos(2.0 * math.pi * turns))


class _HasContainer(Protocol):
    @property
    def container(self) -> Container: ...


@documented
@dataclass(frozen=True)
class Piston(Surface):
    """A smooth wall that particles and an external pressure move, or that has a constant speed.

    In a scene with a piston, all particles must be smooth and elastic, and there must be no fixed particles
    or interior walls.

    The piston starts at the side of the container. With a mass and a pressure it starts at rest. The side is
    its outermost position, where it bounces back without loss. The sum of three energies is conserved: the
    kinetic energy of the piston, `pressure` times the volume, and the energy of the particles. A light piston
    samples the ensemble of constant pressure and enthalpy (H. C. Andersen, J. Chem. Phys. 72, 2384 (1980)),
    and a heavy one compresses a gas adiabatically. A piston with a prescribed speed compresses a gas if it is
    slow and drives a shock if it is fast. The work of the piston becomes energy of the particles.

    Raises
    ------
    SceneError
        Unless the piston has either both `mass` and `pressure`, or only `speed`.

    Examples
    --------
    >>> import gaspart as gp
    >>> piston = gp.Piston(mass=10.0, pressure=0.5)
    >>> scene = gp.Scene(gp.Container((10.0, 8.0)), faces={"x_high": piston})
    >>> piston.acceleration(scene, axis=0)
    0.4
    """

    mass: float | None = field(
        default=None, metadata=declare(positive("mass of the piston [mass], with a pressure"))
    )
    pressure: float | None = field(
        default=None,
        metadata=declare(
            not_negative(
                "external pressure that pushes the piston inwards [energy/length^d] (force over "
                "area), with a mass"
            )
        ),
    )
    speed: float | None = field(
        default=None,
        metadata=declare(
            positive("inward speed [length/time], which hits do not change, instead of a mass and a pressure")
        ),
    )

    kind: ClassVar[str] = "piston"
    moves: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        loaded = [value is not None for value in (self.mass, self.pressure)]
        if any(loaded) if self.speed is not None else not all(loaded):
            stated = {key: value for key, value in vars(self).items() if value is not None}
            raise SceneError("speed", stated, "must be mass and pressure, or speed alone")

    def acceleration(self, scene: _HasContainer, axis: int) -> float:
        """Return the inward acceleration along `axis` by the external pressure; 0 with a speed."""
        if self.mass is None or self.pressure is None:
            return 0.0
        container = scene.container
        return self.pressure / self.mass * (container.volume / container.lengths[axis])

    def initial_velocity(self, number: int) -> float:
        """Return the velocity along its axis at time 0 of the piston with a face's index."""
        return (-1.0 if number % 2 else 1.0) * (self.speed or 0.0)


@documented
@dataclass(frozen=True)
class Open(Surface):
    """An opening as wide as the face, through which particles leave, and enter from a reservoir.

    A particle that reaches the face leaves for good. With an `activity` and a `temperature`, particles from a
    reservoir enter through the face, and the scene must have `centres_to_walls`. Otherwise there is a vacuum
    outside, and the container may have interior walls. The scene must have one species.

    The reservoir is a gas at rest. In the dilute limit its activity is eta. Let z be the number density that
    is equivalent to the activity. The reservoir sends z (k_B T / 2 pi m)^(1/2) particles per area and time,
    uniformly over the face, with the velocities of particles that pass a plane in one direction. An arriving
    particle that would overlap a particle inside is rejected. If all reservoirs are identical, the particles
    in equilibrium are therefore exactly a grand-canonical ensemble of centres between the faces. The reason
    is detailed balance: an entry is the time reversal of an exit, and a state with N particles and energy E
    has the weight z^N exp(-E / k_B T). The density equals the density of the reservoir only at distances of
    several diameters from a face.

    The Boltzmann model of the DSMC engine has no excluded volume, so that it rejects no particle: in this
    model the reservoir is an ideal gas with the packing fraction `activity`.

    Raises
    ------
    SceneError
        If a value is invalid, or only one of `activity` and `temperature` is given.

    See Also
    --------
    gaspart.theory.activity : Activity of a gas of a packing fraction.

    Examples
    --------
    >>> import gaspart as gp
    >>> reservoir = gp.Open(activity=0.1, temperature=1.0)
    >>> scene = gp.Scene(
    ...     gp.Container((10.0, 10.0)),
    ...     species=[gp.Species(count=5, radius=0.5, temperature=1.0)],
    ...     centres_to_walls=True,
    ...     faces={"x_low": reservoir, "x_high": reservoir},
    ... )
    >>> scene.is_open
    True
    """

    activity: float | None = field(
        default=None,
        metadata=declare(
            positive("activity eta exp(mu_excess / k_B T) of the reservoir outside; without it a vacuum")
        ),
    )
    temperature: float | None = field(
        default=None, metadata=declare(positive("temperature of the reservoir [energy], with an activity"))
    )

    kind: ClassVar[str] = "open"

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.activity is None) != (self.temperature is None):
            raise SceneError("temperature", self.temperature, "must be given together with activity")

    @property
    def smooth(self) -> bool:
        """False, because particles that leave and enter carry momentum parallel to the face."""
        return False

    @property
    def temperatures(self) -> tuple[float, ...]:
        return () if self.temperature is None else (self.temperature,)


@documented
@dataclass(frozen=True)
class LeesEdwards(Surface):
    """Pair of periodic faces whose images slide, for shear flow without walls.

    The mean velocity of the gas is u_x = shear_rate (y - L_y / 2).

    The boundary condition was introduced by Lees and Edwards (A. W. Lees and S. F. Edwards, J. Phys. C 5,
    1921 (1972)). It must be set for y_high of a container that is periodic along all axes, and then applies
    to y_low, too. A particle that leaves at y_high at time t enters at y_low. Its x is then displaced by
    -shear_rate L_y t, and its v_x is reduced by shear_rate L_y. For a particle that leaves at y_low the signs
    are reversed. The initial velocities are the sum of the velocity of the flow and random velocities with
    mean 0. The faces do work, which heats an elastic gas.

    Examples
    --------
    >>> import gaspart as gp
    >>> box = gp.Container((10.0, 10.0), boundary="periodic")
    >>> gp.Scene(box, faces={"y_high": gp.LeesEdwards(shear_rate=0.5)}).shear_rate
    0.5
    """

    shear_rate: float = field(metadata=declare(real("gradient of the flow [1/time], du_x / dy")))

    kind: ClassVar[str] = "lees_edwards"
    moves: ClassVar[bool] = True


SCHEMA = {
    "type": "object",
    "propertyNames": {"enum": list(FACES)},
    "additionalProperties": {
        "anyOf": [
            schema_of(face, kind=describe({"const": name}, "the kind of face"))
            for name, face in FACE_KINDS.items()
        ]
    },
}
"""JSON schema of the faces of a scene, by name."""


def surface_from_dict(mapping: object, where: str) -> Surface:
    """Return the face from a mapping {"kind": one of `FACE_KINDS`, setting: value, ...}."""
    if not isinstance(mapping, dict):
        raise SceneError(where, mapping, "must be a mapping with a kind")
    settings = dict(mapping)
    kind = one_of(f"{where}.kind", settings.pop("kind", None), FACE_KINDS)
    return from_mapping(FACE_KINDS[kind], settings, where)


def surface_to_dict(surface: Surface) -> dict:
    """Return the mapping that describes a face, the inverse of `surface_from_dict`."""
    return {"kind": surface.kind, **asdict(surface)}
