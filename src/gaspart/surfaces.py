"""The kinds of faces that a container may have: what happens to a body that comes to a wall.

A face without a kind is hard, and follows the scene's law of contacts.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, ClassVar, Literal

from gaspart.errors import SceneError
from gaspart.validation import choice, from_mapping, positive, settle

if TYPE_CHECKING:
    from gaspart.scene import Scene

FACES = ("x_low", "x_high", "y_low", "y_high", "z_low", "z_high")
COMPONENTS = ("all", "normal")


@dataclass(frozen=True)
class Thermal:
    """A wall at a temperature, which a body leaves with a velocity drawn from it.

    The normal velocity is drawn weighted by the flux, v = sqrt(-2 kT/m ln U); with components "all" the
    tangential ones and, in a scene of rough bodies, the spins are Maxwellian (a diffuse wall with full
    accommodation); with "normal" they are kept (the rule of Frederickx & Meerts 2010, section 4.4).
    """

    temperature: float
    components: str = "all"

    kind: ClassVar[Literal["thermal"]] = "thermal"

    def __post_init__(self) -> None:
        settle(self, temperature=positive("temperature", self.temperature))
        choice("components", self.components, COMPONENTS)


@dataclass(frozen=True)
class Well:
    """A wall behind a step of the potential: a body whose surface is within `width` of the face has the
    energy -`depth`. Crossing outward needs m v_n^2 / 2 > depth, else the body is thrown back. The wall
    itself is hard, or with a `temperature` as in `Thermal`."""

    depth: float
    width: float
    temperature: float | None = None

    kind: ClassVar[Literal["well"]] = "well"

    def __post_init__(self) -> None:
        for key in ("depth", "width"):
            settle(self, **{key: positive(key, getattr(self, key))})
        if self.temperature is not None:
            settle(self, temperature=positive("temperature", self.temperature))


@dataclass(frozen=True)
class Sticky:
    """A wall to which slow bodies stick (Frederickx & Meerts 2010, section 4.5, made definite).

    A body that comes with a normal momentum below `momentum` p stays: its normal energy becomes that of a
    vibration, and it glides along the wall. If a contact with another body gives it a normal velocity, that
    energy is added, and once the sum reaches p^2 / 2m it leaves the wall with all of it. Nothing binds it, so
    bodies that stick are not balanced by bodies that leave: detailed balance is broken.
    """

    momentum: float

    kind: ClassVar[Literal["sticky"]] = "sticky"

    def __post_init__(self) -> None:
        settle(self, momentum=positive("momentum", self.momentum))


KINDS: dict[str, type[Thermal | Well | Sticky]] = {
    surface.kind: surface for surface in (Thermal, Well, Sticky)
}


def surface_from_dict(mapping: object, where: str) -> Thermal | Well | Sticky:
    """The face that {"kind": "thermal" | "well" | "sticky", setting: value, ...} describes."""
    if not isinstance(mapping, dict):
        raise SceneError(where, mapping, "must be a mapping with a kind")
    settings = dict(mapping)
    kind = choice(f"{where}.kind", settings.pop("kind", None), KINDS)
    return from_mapping(KINDS[kind], settings, where)


def surface_to_dict(surface: Thermal | Well | Sticky) -> dict:
    """What `surface_from_dict` takes."""
    return {"kind": surface.kind, **asdict(surface)}


def thermal_face(scene: Scene, name: str) -> Thermal:
    """The face of this name, which must be at a temperature. Raises SceneError."""
    face = scene.faces.get(name)
    if not isinstance(face, Thermal):
        raise SceneError(f"faces.{name}", face, "must be thermal")
    return face


def check_faces(scene: Scene) -> None:
    """Raise SceneError for faces that a scene cannot have."""
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
                rule = "leaves no room outside the wells of this axis for the largest body"
                raise SceneError(f"faces.{name}.width", surface.width, rule)
