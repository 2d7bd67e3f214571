"""Faces at rest: what happens to a particle that reaches a hard, thermal, attractive or sticky face.

A face without a kind is hard and follows the collision law of the scene.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from gaspart.errors import SceneError
from gaspart.keys import (
    choice,
    declare,
    describe,
    documented,
    fraction,
    positive,
    set_fields,
    validate,
    vector,
)
from gaspart.keys.kinds import POSITIVE, Kind
from gaspart.keys.values import positive_number

FACES = ("x_low", "x_high", "y_low", "y_high", "z_low", "z_high")
"""Keys of faces. In results a face has the name of a wall, such as `x low`. Users may write either form."""
COMPONENTS = ("all", "normal")

FACE_KINDS: dict[str, type[Surface]] = {}
"""All kinds of faces by name. The class `Surface` registers every derived class here."""


def key_of(face: Any) -> Any:
    """Return the key of a face for its key or its name as a wall. Other values are returned unchanged."""
    return face.strip().replace(" ", "_") if isinstance(face, str) else face


def wall_of(face: Any) -> Any:
    """Return the name of a face as a wall, `x low`. Other values are returned unchanged."""
    if isinstance(face, list | tuple):
        return [wall_of(name) for name in face]
    return face.strip().replace("_", " ") if isinstance(face, str) else face


@dataclass(frozen=True)
class Surface:
    """Kind of face. A derived class is registered by its `kind`. `moves` is True if the face moves along its
    normal. Only the event-driven engine simulates such faces.
    """

    kind: ClassVar[str]
    moves: ClassVar[bool] = False

    def __init_subclass__(cls) -> None:
        FACE_KINDS[cls.kind] = cls

    def __post_init__(self) -> None:
        validate(self)

    @property
    def rule(self) -> tuple[str, float]:
        """Name and parameter of the wall's effect on particles, for the kernels (`kernels.obstacles`). The
        effect may depend on this one number only, which is an energy or a momentum.
        """
        return self.kind, 0.0

    @property
    def smooth(self) -> bool:
        """True if the face acts on particles along its normal only."""
        return True

    @property
    def temperatures(self) -> tuple[float, ...]:
        """Temperature of the face, or the temperatures of its two ends; () without a temperature."""
        return ()


def _check_temperature(key: str, value: Any) -> float | dict[str, float]:
    """Return a checked temperature, or the temperatures at two opposite faces, the low face first."""
    if not isinstance(value, Mapping):
        return positive_number(key, value)
    ends = {
        key_of(face): positive_number(f"{key}.{face}", temperature) for face, temperature in value.items()
    }
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


@documented
@dataclass(frozen=True)
class Thermal(Surface):
    """A wall at a temperature; velocities of particles that leave it are drawn for this temperature.

    With `components` "all", all components are drawn, and the spins of rough particles (a diffuse wall with
    full accommodation); with "normal" only the normal component is drawn, and the others do not change.

    The normal velocity v is drawn from the flux-weighted distribution: v = sqrt(-2 kT/m ln U), where U is
    uniform in (0, 1). If the temperature varies along the face, the temperature at the point of the hit is
    used.

    Literature: R. Frederickx and P. Meerts (2010), section 4.4.

    Literature: J. C. Maxwell, Phil. Trans. R. Soc. 170, 231 (1879).

    Raises
    ------
    SceneError
        If a value is invalid, or a wall with components "normal" has a velocity.

    Examples
    --------
    >>> import gaspart as gp
    >>> cold, hot = gp.Thermal(temperature=1.0), gp.Thermal(temperature=2.0)
    >>> scene = gp.Scene(gp.Container((10.0, 10.0)), faces={"x_low": cold, "x_high": hot})
    >>> sorted(scene.face_temperatures)
    [1.0, 2.0]
    """

    temperature: float | dict[str, float] = field(
        hash=False,
        metadata=declare(
            describe(
                _TEMPERATURE,
                "temperature of the wall [energy]; one value at each of two opposite faces is a "
                "linear variation between them",
            )
        ),
    )
    components: str = field(
        default="all",
        metadata=declare(choice("velocity components that are drawn", *COMPONENTS)),
    )
    velocity: tuple[float, ...] | None = field(
        default=None,
        metadata=declare(
            vector(
                "velocity of the wall along itself [length/time], the mean of drawn velocities; "
                "without it the wall is at rest"
            )
        ),
    )
    accommodation: float | None = field(
        default=None,
        metadata=declare(
            fraction(
                "fraction of hits after which velocities are drawn; other hits are mirrored; 1 without it"
            )
        ),
    )

    kind: ClassVar[str] = "thermal"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.components == "normal" and self.slides:
            raise SceneError("velocity", self.velocity, 'requires components "all"')
        if self.accommodation == 1.0:  # absent everywhere, so that no other code has to test for this value
            set_fields(self, accommodation=None)

    @property
    def slides(self) -> bool:
        """True if the wall moves parallel to its surface."""
        return any(self.velocity or ())

    @property
    def rule(self) -> tuple[str, float]:
        return "thermal" if self.components == "all" else "thermal_normal", self.temperatures[0]

    @property
    def varies_along(self) -> int | None:
        """Axis along which the temperature varies; None for a uniform temperature."""
        return FACES.index(next(iter(self.temperature))) // 2 if isinstance(self.temperature, dict) else None

    @property
    def temperatures(self) -> tuple[float, ...]:
        return tuple(self.temperature.values()) if isinstance(self.temperature, dict) else (self.temperature,)

    @property
    def smooth(self) -> bool:
        return self.components == "normal"


@documented
@dataclass(frozen=True)
class Well(Surface):
    """A wall with an attractive square well: the energy is -`depth` closer than `width` to it.

    A particle leaves the well if the energy of its normal velocity, m v_n^2 / 2, exceeds `depth`. Otherwise
    it is reflected back into the well.

    Examples
    --------
    >>> import gaspart as gp
    >>> well = gp.Well(depth=2.0, width=0.5)
    >>> scene = gp.Scene(gp.Container((10.0, 10.0)), faces={"y_low": well})
    >>> scene.faces["y_low"].rule
    ('hard', 0.0)
    """

    depth: float = field(metadata=declare(positive("depth of the well [energy]")))
    width: float = field(
        metadata=declare(
            positive("largest distance of a particle's surface from the wall in the well [length]")
        )
    )
    temperature: float | None = field(
        default=None,
        metadata=declare(
            positive("temperature of the wall behind the well [energy]; without it the wall is hard")
        ),
    )

    kind: ClassVar[str] = "well"

    @property
    def rule(self) -> tuple[str, float]:
        return ("hard", 0.0) if self.temperature is None else ("thermal", self.temperature)

    @property
    def smooth(self) -> bool:
        return self.temperature is None

    @property
    def temperatures(self) -> tuple[float, ...]:
        return () if self.temperature is None else (self.temperature,)


@documented
@dataclass(frozen=True)
class Sticky(Surface):
    """A wall to which slow particles stick, after Frederickx & Meerts (2010), section 4.5.

    The normal kinetic energy of a particle that sticks becomes energy of its vibration, and the particle
    slides along the wall. If a contact with another particle gives it a normal velocity, the energy of this
    velocity is added to the vibration. Once the energy of the vibration reaches p^2 / 2m, the particle leaves
    the wall with this energy. No potential binds the particle, so that sticking is not the exact reverse of
    leaving: detailed balance is broken.

    Examples
    --------
    >>> import gaspart as gp
    >>> gp.Sticky(momentum=0.5).rule
    ('sticky', 0.5)
    """

    momentum: float = field(
        metadata=declare(
            positive("normal momentum below which an arriving particle stays [mass length/time]")
        )
    )

    kind: ClassVar[str] = "sticky"

    @property
    def rule(self) -> tuple[str, float]:
        return "sticky", self.momentum
