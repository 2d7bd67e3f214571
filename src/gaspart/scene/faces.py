"""The kinds of faces that a container may have: what happens to a particle that reaches it.

A face without a kind is hard and follows the scene's law of contacts.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

from gaspart.errors import SceneError
from gaspart.keys import (
    choice,
    declared,
    described,
    fraction,
    from_mapping,
    not_negative,
    positive,
    schema_of,
    set_fields,
    signed,
    validate,
    vector,
)
from gaspart.keys.kinds import POSITIVE, Kind
from gaspart.keys.values import one_of, positive_number, size

if TYPE_CHECKING:
    import numpy as np

    from gaspart.scene.scene import Scene

FACES = ("x_low", "x_high", "y_low", "y_high", "z_low", "z_high")
"""Keys of faces. In results they are named as walls, `x low`; users may write either."""
COMPONENTS = ("all", "normal")
WAVEFORMS = ("sine", "sawtooth")
FLOW, GRADIENT = 0, 1
"""The axes of the flow of a sheared gas and of its gradient."""


FACE_KINDS: dict[str, type[Surface]] = {}
"""All kinds of faces, by name; `Surface` adds each."""


@dataclass(frozen=True)
class Surface:
    """A kind of face. A class derived from it is known by its `kind` once it is declared.

    moves: whether it does by itself; only the event-driven engine has such faces.
    """

    kind: ClassVar[str]
    moves: ClassVar[bool] = False

    def __init_subclass__(cls) -> None:
        FACE_KINDS[cls.kind] = cls

    def __post_init__(self) -> None:
        validate(self)

    @property
    def rule(self) -> tuple[str, float]:
        """The name by which the kernels know what happens to a particle there (`kernels.obstacles`), and the
        one number on which that may depend: an energy or a momentum."""
        return self.kind, 0.0

    @property
    def smooth(self) -> bool:
        """Whether it acts on particles along its normal only."""
        return True

    @property
    def temperatures(self) -> tuple[float, ...]:
        """Its temperature, of one that varies those of its ends; none of a face without."""
        return ()


def _check_temperature(key: str, value: Any) -> float | dict[str, float]:
    """A temperature, or those at two opposite faces, the low one first."""
    if not isinstance(value, Mapping):
        return positive_number(key, value)
    ends = {key_of(face): positive_number(f"{key}.{face}", one) for face, one in value.items()}
    if sorted(ends, reverse=True) not in ([f"{axis}_low", f"{axis}_high"] for axis in "xyz"):
        rule = "must be of two opposite faces, such as {y_low: 1.0, y_high: 2.0}"
        raise SceneError(key, value, rule)
    return {face: ends[face] for face in sorted(ends, reverse=True)}


_ENDS = {
    "type": "object",
    "propertyNames": {"enum": list(FACES)},
    "additionalProperties": POSITIVE,
    "minProperties": 2,
    "maxProperties": 2,
}
_TEMPERATURE = Kind({"anyOf": [POSITIVE, _ENDS]}, _check_temperature)


@dataclass(frozen=True)
class Thermal(Surface):
    """A wall at a temperature, from whose distribution the velocity of a particle that leaves is drawn.

    The normal velocity is drawn weighted by the flux, v = sqrt(-2 kT/m ln U); with components "all" the
    tangential ones and, in a scene of rough particles, the spins are Maxwellian (a diffuse wall with full
    accommodation); with "normal" they are kept (the rule of Frederickx & Meerts 2010, section 4.4).
    A wall with a `velocity` moves along itself, and the distribution is that about its velocity. With an
    `accommodation` below 1 this happens after that fraction of hits, and after the others the particle leaves
    as from a mirror (Maxwell, Phil. Trans. R. Soc. 170, 231 (1879)). A temperature that is given at two
    opposite faces, as {"y_low": 1.0, "y_high": 2.0}, is linear between them: that where a particle hits.
    """

    temperature: float | dict[str, float] = field(
        hash=False,
        metadata=declared(
            described(_TEMPERATURE, "temperature of the wall, or those where it ends, at two opposite faces")
        ),
    )
    components: str = field(
        default="all",
        metadata=declared(choice("velocity components that are drawn", *COMPONENTS)),
    )
    velocity: tuple[float, ...] | None = field(
        default=None,
        metadata=declared(vector("velocity of the wall, along itself; without it the wall is at rest")),
    )
    accommodation: float | None = field(
        default=None,
        metadata=declared(
            fraction("fraction of hits after which velocities are drawn, of mirrored others; 1 without it")
        ),
    )

    kind: ClassVar[str] = "thermal"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.components == "normal" and self.slides:
            raise SceneError("velocity", self.velocity, 'needs components "all": no other drags particles')
        if self.accommodation == 1.0:  # absent everywhere, so that no other place has to ask
            set_fields(self, accommodation=None)

    @property
    def slides(self) -> bool:
        """Whether it moves."""
        return any(self.velocity or ())

    @property
    def rule(self) -> tuple[str, float]:
        """With its temperature, of one that varies that at its low end."""
        return "thermal" if self.components == "all" else "thermal_normal", self.temperatures[0]

    @property
    def varies_along(self) -> int | None:
        """The axis along which its temperature varies, None of one temperature."""
        return FACES.index(next(iter(self.temperature))) // 2 if isinstance(self.temperature, dict) else None

    @property
    def temperatures(self) -> tuple[float, ...]:
        """The temperature, or those of the low and the high end."""
        return tuple(self.temperature.values()) if isinstance(self.temperature, dict) else (self.temperature,)

    @property
    def smooth(self) -> bool:
        """Unless it draws all components."""
        return self.components == "normal"


@dataclass(frozen=True)
class Well(Surface):
    """A wall behind a step of the potential: a particle whose surface is within `width` of the face has the
    energy -`depth`. It leaves if m v_n^2 / 2 > depth, and is reflected if not. The wall itself is hard, or
    with a `temperature` as in `Thermal`."""

    depth: float = field(metadata=declared(positive("depth of the well: an energy")))
    width: float = field(
        metadata=declared(positive("distance of a particle's surface from the wall up to which it lies"))
    )
    temperature: float | None = field(
        default=None, metadata=declared(positive("temperature of the wall; without it the wall is hard"))
    )

    kind: ClassVar[str] = "well"

    @property
    def rule(self) -> tuple[str, float]:
        """The kind and the level of the wall behind the well."""
        return ("hard", 0.0) if self.temperature is None else ("thermal", self.temperature)

    @property
    def smooth(self) -> bool:
        """Unless the wall behind the well is thermal."""
        return self.temperature is None

    @property
    def temperatures(self) -> tuple[float, ...]:
        """That of the wall behind the well, if it has one."""
        return () if self.temperature is None else (self.temperature,)


@dataclass(frozen=True)
class Sticky(Surface):
    """A wall to which slow particles stick (Frederickx & Meerts 2010, section 4.5, made definite).

    A particle that arrives with a normal momentum below `momentum` p stays: its normal energy becomes that of
    a vibration, and it slides along the wall. If a contact with another particle gives it a normal velocity,
    that energy is added, and once the sum reaches p^2 / 2m it leaves the wall with all of it. No potential
    binds it, so that particles that stick are not balanced by those that leave: detailed balance is broken.
    """

    momentum: float = field(metadata=declared(positive("normal momentum below which a particle stays")))

    kind: ClassVar[str] = "sticky"

    @property
    def rule(self) -> tuple[str, float]:
        """With the momentum."""
        return "sticky", self.momentum


@dataclass(frozen=True)
class Vibrating(Surface):
    """A hard wall that moves in a prescribed way, whatever hits it, and gives or takes energy.

    It is at the side of the container at time 0, and moves inwards from there by twice the amplitude A at
    most: the sine is at A (1 - cos(2 pi t / period)), the sawtooth moves in at the speed 2 A / period and is
    back at once at the end of each period. Contacts follow the scene's law in the frame of the wall.
    """

    amplitude: float = field(metadata=declared(positive("half the distance that the wall moves")))
    period: float = field(metadata=declared(positive("duration of one vibration")))
    waveform: str = field(default="sine", metadata=declared(choice("how the wall moves", *WAVEFORMS)))

    kind: ClassVar[str] = "vibrating"
    moves: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        size("period", self.greatest_speed)
        size("period", self.greatest_acceleration)

    @property
    def greatest_speed(self) -> float:
        """The greatest speed of the wall, apart from the return of the sawtooth."""
        return (2.0 * math.pi if self.waveform == "sine" else 2.0) * self.amplitude / self.period

    @property
    def greatest_acceleration(self) -> float:
        """The greatest acceleration of the wall, apart from the return of the sawtooth."""
        return 2.0 * math.pi * self.greatest_speed / self.period if self.waveform == "sine" else 0.0

    def places(self, times: np.ndarray) -> np.ndarray:
        """(...) how far the wall has moved inwards at times (...)."""
        import numpy as np

        turns = np.fmod(times, self.period) / self.period
        if self.waveform == "sawtooth":
            return 2.0 * self.amplitude * turns
        return self.amplitude * (1.0 - np.cos(2.0 * math.pi * turns))


@dataclass(frozen=True)
class Piston(Surface):
    """A smooth wall of finite mass, pushed inwards by a constant external pressure and outwards by particles;
    or one that moves inwards at a `speed`, whatever hits it.

    With a mass and a pressure it starts at rest at the side of the container, which is as far outwards as it
    comes: it bounces off there without loss. Its kinetic energy and `pressure` times the volume, together
    with the energy of the particles, are conserved: with a light piston this is the ensemble of constant
    pressure and enthalpy (Andersen, J. Chem. Phys. 72, 2384 (1980)), and a heavy one compresses a gas
    adiabatically. One at a speed starts there too: slowly it compresses a gas, fast it drives a shock, and
    its work is what particles gain. Particles are smooth and elastic, and nothing else is in the container.
    """

    mass: float | None = field(
        default=None, metadata=declared(positive("mass of the piston, with a pressure"))
    )
    pressure: float | None = field(
        default=None,
        metadata=declared(not_negative("external pressure: the force on the piston over its area")),
    )
    speed: float | None = field(
        default=None,
        metadata=declared(positive("speed at which it moves inwards, instead of a mass and a pressure")),
    )

    kind: ClassVar[str] = "piston"
    moves: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        loaded = [value is not None for value in (self.mass, self.pressure)]
        if any(loaded) if self.speed is not None else not all(loaded):
            stated = {key: value for key, value in vars(self).items() if value is not None}
            raise SceneError("speed", stated, "a piston has a mass and a pressure, or a speed alone")

    def acceleration(self, scene: Scene, axis: int) -> float:
        """That by which its load pushes it inwards; 0 at a stated speed."""
        if self.mass is None or self.pressure is None:
            return 0.0
        container = scene.container
        return self.pressure / self.mass * (container.volume / container.lengths[axis])

    def initial_velocity(self, number: int) -> float:
        """That along its axis with which it starts, as the face of this number."""
        return (-1.0 if number % 2 else 1.0) * (self.speed or 0.0)


@dataclass(frozen=True)
class Open(Surface):
    """An opening as wide as the face: a particle whose centre reaches it leaves, and is gone. With an
    `activity` and a `temperature` particles of a reservoir enter there; without, there is a vacuum outside.

    The reservoir is a gas at rest with the activity eta exp(mu_excess / k_B T), eta its packing fraction
    (`theory.activity`; dilute, it is eta). That of the number density z sends z (k_B T / 2 pi m)^(1/2)
    particles per area and time, evenly over the face, with the velocities of those that pass a plane in one
    direction. Whichever would overlap a particle inside is turned away. The container with reservoirs of one
    kind is then, in equilibrium, exactly the grand-canonical ensemble of centres between its faces: a step
    in is the reversal of a step out, and both have the weight z^N exp(-E / k_B T). Needs one species, and
    `centres_to_walls`: the density is the reservoir's some diameters away from a face, not beside it.
    """

    activity: float | None = field(
        default=None, metadata=declared(positive("of the reservoir outside; without it a vacuum"))
    )
    temperature: float | None = field(
        default=None, metadata=declared(positive("of the reservoir, which has an activity too"))
    )

    kind: ClassVar[str] = "open"

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.activity is None) != (self.temperature is None):
            raise SceneError("temperature", self.temperature, "a reservoir has an activity and a temperature")

    @property
    def smooth(self) -> bool:
        """No: particles that leave and enter have momentum along it."""
        return False

    @property
    def temperatures(self) -> tuple[float, ...]:
        """That of the reservoir, if there is one."""
        return () if self.temperature is None else (self.temperature,)


@dataclass(frozen=True)
class LeesEdwards(Surface):
    """Periodic faces whose images slide (Lees & Edwards, J. Phys. C 5, 1921 (1972)): a gas without walls is
    sheared, u_x = `shear_rate` (y - L_y / 2).

    It is stated of the face y_high, and is true of y_low too, of a container that is periodic along all axes.
    A particle that leaves there enters at y_low displaced by -shear_rate L_y t along x, with v_x less by
    shear_rate L_y, and back. It acts at the start too: drawn velocities are about this flow, without a mean.
    The faces do work, by which an elastic gas heats.
    """

    shear_rate: float = field(metadata=declared(signed("gradient of the flow, du_x / dy")))

    kind: ClassVar[str] = "lees_edwards"
    moves: ClassVar[bool] = True


SCHEMA = {
    "type": "object",
    "propertyNames": {"enum": list(FACES)},
    "additionalProperties": {
        "anyOf": [
            schema_of(face, kind=described({"const": name}, "the kind of face"))
            for name, face in FACE_KINDS.items()
        ]
    },
}
"""The JSON schema of the faces of a scene, by name."""


def surface_from_dict(mapping: object, where: str) -> Surface:
    """The face that {"kind": one of `FACE_KINDS`, setting: value, ...} describes."""
    if not isinstance(mapping, dict):
        raise SceneError(where, mapping, "must be a mapping with a kind")
    settings = dict(mapping)
    kind = one_of(f"{where}.kind", settings.pop("kind", None), FACE_KINDS)
    return from_mapping(FACE_KINDS[kind], settings, where)


def surface_to_dict(surface: Surface) -> dict:
    """The inverse of `surface_from_dict`."""
    return {"kind": surface.kind, **asdict(surface)}


def key_of(face: Any) -> Any:
    """The key of a face that is given by either of its names; other things as they are."""
    return face.strip().replace(" ", "_") if isinstance(face, str) else face


def wall_of(face: Any) -> Any:
    """The name of a face as a wall, `x low`, likewise; of several faces each."""
    if isinstance(face, list | tuple):
        return [wall_of(one) for one in face]
    return face.strip().replace("_", " ") if isinstance(face, str) else face


def thermal_face(scene: Scene, name: str) -> Thermal:
    """The face of this name, which must be at one temperature. Raises SceneError."""
    face = scene.faces.get(name)
    if not isinstance(face, Thermal) or face.varies_along is not None:
        raise SceneError(f"faces.{name}", face, "must be thermal, at one temperature")
    return face
