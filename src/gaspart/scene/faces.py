"""The kinds of faces that a container may have: what happens to a particle that reaches it.

A face without a kind is hard and follows the scene's law of contacts.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, ClassVar, Literal

from gaspart.errors import SceneError
from gaspart.kinds import described
from gaspart.scene.keys import NOT_NEGATIVE, POSITIVE, declared, schema_of, validate
from gaspart.scene.keys import choice as choice_of
from gaspart.scene.limits import closest_packing
from gaspart.scene.validation import choice, from_mapping, size, vector

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene
    from gaspart.scene.walls import Plate, Wall

FACES = ("x_low", "x_high", "y_low", "y_high", "z_low", "z_high")
COMPONENTS = ("all", "normal")
WAVEFORMS = ("sine", "sawtooth")


@dataclass(frozen=True)
class Thermal:
    """A wall at a temperature, from whose distribution the velocity of a particle that leaves is drawn.

    The normal velocity is drawn weighted by the flux, v = sqrt(-2 kT/m ln U); with components "all" the
    tangential ones and, in a scene of rough particles, the spins are Maxwellian (a diffuse wall with full
    accommodation); with "normal" they are kept (the rule of Frederickx & Meerts 2010, section 4.4).
    """

    temperature: float = field(metadata=declared(POSITIVE, "temperature of the wall"))
    components: str = field(
        default="all",
        metadata=declared(choice_of(*COMPONENTS), "velocity components that are drawn"),
    )

    kind: ClassVar[Literal["thermal"]] = "thermal"

    def __post_init__(self) -> None:
        validate(self)


@dataclass(frozen=True)
class Well:
    """A wall behind a step of the potential: a particle whose surface is within `width` of the face has the
    energy -`depth`. It leaves if m v_n^2 / 2 > depth, and is reflected if not. The wall itself is hard, or
    with a `temperature` as in `Thermal`."""

    depth: float = field(metadata=declared(POSITIVE, "depth of the well: an energy"))
    width: float = field(
        metadata=declared(POSITIVE, "distance of a particle's surface from the wall up to which it lies")
    )
    temperature: float | None = field(
        default=None, metadata=declared(POSITIVE, "temperature of the wall; without it the wall is hard")
    )

    kind: ClassVar[Literal["well"]] = "well"

    def __post_init__(self) -> None:
        validate(self)


@dataclass(frozen=True)
class Sticky:
    """A wall to which slow particles stick (Frederickx & Meerts 2010, section 4.5, made definite).

    A particle that arrives with a normal momentum below `momentum` p stays: its normal energy becomes that of
    a vibration, and it slides along the wall. If a contact with another particle gives it a normal velocity,
    that energy is added, and once the sum reaches p^2 / 2m it leaves the wall with all of it. No potential
    binds it, so that particles that stick are not balanced by those that leave: detailed balance is broken.
    """

    momentum: float = field(metadata=declared(POSITIVE, "normal momentum below which a particle stays"))

    kind: ClassVar[Literal["sticky"]] = "sticky"

    def __post_init__(self) -> None:
        validate(self)


@dataclass(frozen=True)
class Vibrating:
    """A hard wall that moves in a prescribed way, whatever hits it, and gives or takes energy.

    It is at the side of the container at time 0, and moves inwards from there by twice the amplitude A at
    most: the sine is at A (1 - cos(2 pi t / period)), the sawtooth moves in at the speed 2 A / period and is
    back at once at the end of each period. Contacts follow the scene's law in the frame of the wall.
    """

    amplitude: float = field(metadata=declared(POSITIVE, "half the distance that the wall moves"))
    period: float = field(metadata=declared(POSITIVE, "duration of one vibration"))
    waveform: str = field(default="sine", metadata=declared(choice_of(*WAVEFORMS), "how the wall moves"))

    kind: ClassVar[Literal["vibrating"]] = "vibrating"

    def __post_init__(self) -> None:
        validate(self)
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

    def place(self, time: float) -> float:
        """How far the wall has moved inwards at a time, for pictures."""
        turns = math.fmod(time, self.period) / self.period
        if self.waveform == "sawtooth":
            return 2.0 * self.amplitude * turns
        return self.amplitude * (1.0 - math.cos(2.0 * math.pi * turns))


@dataclass(frozen=True)
class Piston:
    """A smooth wall of finite mass, pushed inwards by a constant external pressure and outwards by particles.

    It starts at rest at the side of the container, which is as far outwards as it comes: it bounces off there
    without loss. Its kinetic energy and `pressure` times the volume, together with the energy of the
    particles, are conserved: with a light piston this is the ensemble of constant pressure and enthalpy
    (Andersen, J. Chem. Phys. 72, 2384 (1980)), and a heavy one compresses a gas adiabatically. Particles are
    smooth and elastic, and nothing else is in the container.
    """

    mass: float = field(metadata=declared(POSITIVE, "mass of the piston"))
    pressure: float = field(
        metadata=declared(NOT_NEGATIVE, "external pressure: the force on the piston over its area")
    )

    kind: ClassVar[Literal["piston"]] = "piston"

    def __post_init__(self) -> None:
        validate(self)

    def acceleration(self, scene: Scene, axis: int) -> float:
        """That by which its load pushes it inwards."""
        container = scene.container
        return self.pressure / self.mass * (container.volume / container.lengths[axis])


Surface = Thermal | Well | Sticky | Vibrating | Piston
KINDS: dict[str, type[Surface]] = {
    surface.kind: surface for surface in (Thermal, Well, Sticky, Vibrating, Piston)
}
SCHEMA = {
    "type": "object",
    "propertyNames": {"enum": list(FACES)},
    "additionalProperties": {
        "anyOf": [
            schema_of(face, kind=described({"const": name}, "the kind of face"))
            for name, face in KINDS.items()
        ]
    },
}
"""The JSON schema of the faces of a scene, by name."""


def surface_from_dict(mapping: object, where: str) -> Surface:
    """The face that {"kind": one of `KINDS`, setting: value, ...} describes."""
    if not isinstance(mapping, dict):
        raise SceneError(where, mapping, "must be a mapping with a kind")
    settings = dict(mapping)
    kind = choice(f"{where}.kind", settings.pop("kind", None), KINDS)
    return from_mapping(KINDS[kind], settings, where)


def surface_to_dict(surface: Surface) -> dict:
    """The inverse of `surface_from_dict`."""
    return {"kind": surface.kind, **asdict(surface)}


def pistons(scene: Scene) -> list[tuple[int, Piston]]:
    """The faces that are pistons, one at most, with their number."""
    found = ((n, scene.faces.get(name)) for n, name in enumerate(FACES[: 2 * scene.dimension]))
    return [(n, face) for n, face in found if isinstance(face, Piston)]


def thermal_face(scene: Scene, name: str) -> Thermal:
    """The face of this name, which must be at a temperature. Raises SceneError."""
    face = scene.faces.get(name)
    if not isinstance(face, Thermal):
        raise SceneError(f"faces.{name}", face, "must be thermal")
    return face


def check_faces(scene: Scene) -> None:
    """Raise SceneError for faces that are impossible in this scene."""
    if not isinstance(scene.faces, dict):
        raise SceneError("faces", scene.faces, "must be a mapping of faces to their kinds")
    known = FACES[: 2 * scene.dimension]
    for name, surface in scene.faces.items():
        if name not in known:
            raise SceneError(f"faces.{name}", surface, f"unknown face; known are {', '.join(known)}")
        if type(surface) not in KINDS.values():
            *others, last = (kind.__name__ for kind in KINDS.values())
            raise SceneError(f"faces.{name}", surface, f"must be {', '.join(others)} or {last}")
        axis = known.index(name) // 2
        if scene.container.periodic[axis]:
            raise SceneError(f"faces.{name}", surface.kind, "a periodic axis has no faces")
        if surface.kind in ("well", "sticky") and scene.gravity is not None and scene.gravity[axis] != 0.0:
            raise SceneError(f"faces.{name}", surface.kind, "needs an axis without gravity")
        if surface.kind == "well":
            low, high = scene.reach(scene.largest_radius)
            both = (scene.faces.get(known[2 * axis + side]) for side in (0, 1))
            if sum(face.width for face in both if isinstance(face, Well)) >= high[axis] - low[axis]:
                rule = "leaves no room outside the wells of this axis for the largest particle"
                raise SceneError(f"faces.{name}.width", surface.width, rule)
        if isinstance(surface, Vibrating):
            _check_vibrating(scene, name, surface)
        if isinstance(surface, Piston):
            _check_piston(scene, name, surface)
    _check_room(scene)


def _check_piston(scene: Scene, name: str, surface: Piston) -> None:
    """Raise SceneError for a second piston, and one so light that its load moves it too fast."""
    if len(pistons(scene)) > 1:
        raise SceneError("faces", [FACES[n] for n, _ in pistons(scene)], "only one may be a piston")
    size(f"faces.{name}.mass", surface.acceleration(scene, FACES.index(name) // 2))


def _check_vibrating(scene: Scene, name: str, surface: Vibrating) -> None:
    """Raise SceneError for obstacles against which a vibrating face would press a particle."""
    axis, upper = FACES.index(name) // 2, FACES.index(name) % 2 == 1
    length = scene.container.lengths[axis]
    clear = 2.0 * (surface.amplitude + scene.largest_radius)
    for n, thing in enumerate(scene.species):
        if thing.fixed and thing.count:
            rule = f"must not be true where {name} vibrates: give fixed particles positions, as bodies"
            raise SceneError(f"species[{n}].fixed", True, rule)
    for n, body in enumerate(scene.bodies):
        x = vector(f"bodies[{n}].position", body.position, scene.dimension)[axis]
        if body.fixed and (length - x if upper else x) < clear + body.radius:
            rule = f"leaves less than a largest diameter between the particle and {name}, which vibrates"
            raise SceneError(f"bodies[{n}].position", body.position, rule)
    for n, wall in enumerate(scene.walls):
        heights = [length - corner[axis] if upper else corner[axis] for corner in wall.corners.values()]
        if min(heights) < clear and not (min(heights) <= 0.0 and _is_upright(wall, axis)):
            rule = f"leaves less than a largest diameter between the wall and {name}, which vibrates"
            raise SceneError(f"walls[{n}]", wall, rule)


def _is_upright(wall: Wall | Plate, axis: int) -> bool:
    """Whether a wall stands upright on a face across this axis."""
    corners = list(wall.corners.values())
    edges = [[b - a for a, b in zip(corners[0], corner, strict=True)] for corner in corners[1:3]]
    upright = [not any(edge[:axis] + edge[axis + 1 :]) for edge in edges]
    return any(upright) and all(
        stands or edge[axis] == 0.0 for stands, edge in zip(upright, edges, strict=True)
    )


def _check_room(scene: Scene) -> None:
    """Raise SceneError where vibrating faces leave too little room."""
    moving = {name: face for name, face in scene.faces.items() if isinstance(face, Vibrating)}
    low, high = scene.reach(scene.largest_radius)
    left = 1.0
    for axis in range(scene.dimension):
        own = {name: face for name, face in moving.items() if FACES.index(name) // 2 == axis}
        stroke = sum(2.0 * face.amplitude for face in own.values())
        if own and stroke >= high[axis] - low[axis]:
            name, face = next(iter(own.items()))
            rule = "leaves no room for the largest particle"
            raise SceneError(f"faces.{name}.amplitude", face.amplitude, rule)
        left *= 1.0 - stroke / scene.container.lengths[axis]
    if moving and scene.packing_fraction > left * closest_packing(scene):
        rule = "exceeds close packing where the faces have moved inwards"
        raise SceneError("packing_fraction", scene.packing_fraction, rule)
