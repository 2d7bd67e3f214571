"""The kinds of faces that a container may have: what happens to a particle that reaches it.

A face without a kind is hard and follows the scene's law of contacts.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, ClassVar, Literal

from gaspart.errors import SceneError
from gaspart.kinds import described
from gaspart.scene.keys import POSITIVE, declared, schema_of, validate
from gaspart.scene.keys import choice as choice_of
from gaspart.scene.validation import choice, from_mapping

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene

FACES = ("x_low", "x_high", "y_low", "y_high", "z_low", "z_high")
COMPONENTS = ("all", "normal")


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


KINDS: dict[str, type[Thermal | Well | Sticky]] = {
    surface.kind: surface for surface in (Thermal, Well, Sticky)
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


def surface_from_dict(mapping: object, where: str) -> Thermal | Well | Sticky:
    """The face that {"kind": "thermal" | "well" | "sticky", setting: value, ...} describes."""
    if not isinstance(mapping, dict):
        raise SceneError(where, mapping, "must be a mapping with a kind")
    settings = dict(mapping)
    kind = choice(f"{where}.kind", settings.pop("kind", None), KINDS)
    return from_mapping(KINDS[kind], settings, where)


def surface_to_dict(surface: Thermal | Well | Sticky) -> dict:
    """The inverse of `surface_from_dict`."""
    return {"kind": surface.kind, **asdict(surface)}


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
            raise SceneError(f"faces.{name}", surface, "must be Thermal, Well or Sticky")
        axis = known.index(name) // 2
        if scene.container.periodic[axis]:
            raise SceneError(f"faces.{name}", surface.kind, "a periodic axis has no faces")
        if surface.kind != "thermal" and scene.gravity is not None and scene.gravity[axis] != 0.0:
            raise SceneError(f"faces.{name}", surface.kind, "needs an axis without gravity")
        if surface.kind == "well":
            low, high = scene.reach(scene.largest_radius)
            both = (scene.faces.get(known[2 * axis + side]) for side in (0, 1))
            if sum(face.width for face in both if isinstance(face, Well)) >= high[axis] - low[axis]:
                rule = "leaves no room outside the wells of this axis for the largest particle"
                raise SceneError(f"faces.{name}.width", surface.width, rule)
