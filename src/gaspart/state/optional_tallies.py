"""Tallies that not every run has, see `Tally`: those that a run asks for, and those of some scenes.

A run asks for a tally by an instance of its class, which holds its settings. An engine that can make it has
its name in `Engine.tallies`, and a part (`engines.features.part.TallyPart`) that is found by that name.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass, fields
from typing import TYPE_CHECKING, ClassVar

from gaspart.errors import SceneError
from gaspart.scene.driving import has_dragged_faces
from gaspart.scene.stress import require_tallied

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene


@dataclass(frozen=True)
class OptionalTally:
    """A tally. name: in messages, in files, and as `only` in the metadata of its fields of `Tally`."""

    name: ClassVar[str]

    def check(self, scene: Scene) -> None:
        """Raise SceneError for a scene of which no engine can make it."""

    def axes(self, scene: Scene) -> dict[str, int]:
        """The lengths of the axes `along` which its fields are, but for `face`."""
        return {}


@dataclass(frozen=True)
class StressTally(OptionalTally):
    """The stress tensor and the heat flux."""

    name: ClassVar[str] = "stress"

    def check(self, scene: Scene) -> None:
        """Raise SceneError unless velocities change at contacts only, in a periodic container."""
        require_tallied(scene)

    def axes(self, scene: Scene) -> dict[str, int]:
        """Both axes of the tensor."""
        return {"axis": scene.dimension, "direction": scene.dimension}


@dataclass(frozen=True)
class WallShearTally(OptionalTally):
    """The momentum that faces are given along themselves."""

    name: ClassVar[str] = "wall_shear"

    def axes(self, scene: Scene) -> dict[str, int]:
        """The components of the momentum."""
        return {"axis": scene.dimension}


ASKED: dict[str, type[OptionalTally]] = {tally.name: tally for tally in (StressTally,)}
"""All that a run can ask for, by name."""


def tallies_of(scene: Scene) -> tuple[OptionalTally, ...]:
    """Those that every run of a scene has, if its engine makes them."""
    return (WallShearTally(),) if has_dragged_faces(scene) else ()


def tallied_fields(tallies: Iterable[OptionalTally]) -> list[str]:
    """The fields of `Tally` that a run with these optional tallies has."""
    from gaspart.state.tally import Tally  # loads numpy, which planning does not need

    present = {None, *(tally.name for tally in tallies)}
    return [field.name for field in fields(Tally) if field.metadata.get("only") in present]


def tally_to_dict(tally: OptionalTally) -> dict:
    """The mapping that `tally_from_dict` accepts."""
    return {"name": tally.name, **asdict(tally)}


def tally_from_dict(mapping: dict) -> OptionalTally:
    """The tally described by {"name": name, setting: value, ...}. Raises SceneError for an unknown name, and
    TypeError for an unknown setting."""
    settings = dict(mapping)
    name = settings.pop("name", None)
    if name not in ASKED:
        raise SceneError("tallies", name, f"must be one of {', '.join(ASKED)}")
    return ASKED[name](**settings)
