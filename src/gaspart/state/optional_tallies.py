"""Tallies that not every run has, see `Tally`: those that a run asks for, and those of some scenes.

A run asks for a tally by an instance of its class, which holds its settings. An engine that can make it has
its name in `Engine.tallies`, and a part (`engines.features.part.TallyPart`) that is found by that name.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable
from dataclasses import asdict, dataclass, fields
from typing import TYPE_CHECKING, ClassVar, TypeVar

from gaspart.errors import SceneError
from gaspart.keys.values import count_of, number, one_of
from gaspart.scene.impulses import require_impulses, require_pair_impulses, row_count
from gaspart.scene.stress import require_tallied

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene


AnyTally = TypeVar("AnyTally", bound="OptionalTally")


@dataclass(frozen=True)
class OptionalTally:
    """A tally. name: in messages, in files, and as `only` in the metadata of its fields of `Tally`."""

    name: ClassVar[str]

    def check(self, scene: Scene) -> None:
        """Raise SceneError for a scene of which no engine can make it."""

    def axes(self, scene: Scene) -> dict[str, int]:
        """The lengths of the axes `along` which its fields are, but for `face`."""
        return {}

    def to_text(self) -> str:
        """Its settings, in the form of an option of `gaspart run`; "" of one that has no such option."""
        return ""


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
class ImpulseTally(OptionalTally):
    """The momentum that particles carry along an axis, "x", "y" or "z", through planes across it, in so many
    equal bins of the container, from which their density follows (`analysis.impulses`). Raises SceneError for
    another axis, and for fewer than 2 bins and more than 100000."""

    axis: str
    bins: int

    name: ClassVar[str] = "impulses"
    most: ClassVar[int] = 100_000

    def __post_init__(self) -> None:
        one_of("impulses.axis", self.axis, ("x", "y", "z"))
        count_of("impulses.bins", self.bins, least=2, most=self.most)

    @classmethod
    def from_text(cls, text: str) -> ImpulseTally:
        """From its axis and number of bins, such as "z:200". Raises SceneError."""
        axis, _, bins = str(text).partition(":")
        if not bins.isdecimal():
            raise SceneError("impulses", text, "must be an axis and a number of bins, such as z:200")
        return cls(axis, int(bins))

    def to_text(self) -> str:
        """The form that `from_text` accepts."""
        return f"{self.axis}:{self.bins}"

    def check(self, scene: Scene) -> None:
        """Raise SceneError unless the scene has the axis, and is in equilibrium at one temperature."""
        one_of("impulses.axis", self.axis, tuple("xyz"[: scene.dimension]))
        require_impulses(scene)

    def axes(self, scene: Scene) -> dict[str, int]:
        """Species and bins."""
        return {"species": row_count(scene), "bin": self.bins}


@dataclass(frozen=True)
class PairImpulseTally(OptionalTally):
    """The momentum that pairs of particles gain along their separation, in so many shells of equal thickness
    up to the `furthest` distance, from which g(r) follows (`analysis.pair_impulses`). share: of contacts, at
    which the pairs with the others are searched for. Raises SceneError for a distance that is not positive,
    fewer than 2 shells and more than 100000, and a share that is not in (0, 1]."""

    furthest: float
    shells: int
    share: float = 1.0

    name: ClassVar[str] = "pair_impulses"

    def __post_init__(self) -> None:
        number("pair_impulses.furthest", self.furthest, "must be positive", above=0.0)
        count_of("pair_impulses.shells", self.shells, least=2, most=ImpulseTally.most)
        number("pair_impulses.share", self.share, "must be above 0 and at most 1", above=0.0, most=1.0)

    @classmethod
    def from_text(cls, text: str) -> PairImpulseTally:
        """From its distance, number of shells and share, such as "3:300:0.5". Raises SceneError."""
        parts = str(text).split(":")
        try:
            furthest, shells = float(parts[0]), int(parts[1])
            share = float(parts[2]) if parts[2:] else 1.0
        except (ValueError, IndexError):
            parts = []
        if len(parts) not in (2, 3):
            rule = "must be a distance, a number of shells and a share of contacts, such as 3:300:0.5"
            raise SceneError("pair_impulses", text, rule)
        return cls(furthest, shells, share)

    def to_text(self) -> str:
        """The form that `from_text` accepts."""
        return f"{self.furthest!r}:{self.shells}:{self.share!r}"

    def check(self, scene: Scene) -> None:
        """Raise SceneError unless the scene is periodic, in equilibrium at one temperature, and longer than
        twice the distance."""
        require_pair_impulses(scene, self.furthest)

    def axes(self, scene: Scene) -> dict[str, int]:
        """Shells."""
        return {"shell": self.shells}


def useful_impulses(scene: Scene, tallies: Collection[str], axis: int, bins: int) -> tuple[ImpulseTally, ...]:
    """Those along an axis, if a run of a scene can keep them and the density follows from them; tallies: the
    names of those that its engine can make."""
    asked = ImpulseTally("xyz"[axis], bins)
    try:
        asked.check(scene)
    except SceneError:
        return ()
    one_mass = all(kind.alike for kind in scene.kinds)
    pulled = bool(scene.gravity and scene.gravity[axis])
    by_mass = pulled or scene.container.periodic[axis]
    return (asked,) if asked.name in tallies and (one_mass or not by_mass) else ()


def option_of(tally: OptionalTally) -> list[str]:
    """The option of `gaspart run` by which a run keeps a tally; none of one that has no such option."""
    text = tally.to_text()
    return [f"--{tally.name.replace('_', '-')}", text] if text else []


def impulse_tallies(text: str | None) -> tuple[OptionalTally, ...]:
    """What a run asks for that is to keep impulses, if it is. Raises SceneError as `from_text`."""
    return () if text is None else (ImpulseTally.from_text(text),)


def pair_impulse_tallies(text: str | None) -> tuple[OptionalTally, ...]:
    """The same of those of pairs. Raises SceneError as `PairImpulseTally.from_text`."""
    return () if text is None else (PairImpulseTally.from_text(text),)


@dataclass(frozen=True)
class WallShearTally(OptionalTally):
    """The momentum that faces are given along themselves."""

    name: ClassVar[str] = "wall_shear"

    def axes(self, scene: Scene) -> dict[str, int]:
        """The components of the momentum."""
        return {"axis": scene.dimension}


@dataclass(frozen=True)
class EntryTally(OptionalTally):
    """The particles that have entered through open faces."""

    name: ClassVar[str] = "entries"


@dataclass(frozen=True)
class FixedCollisionTally(OptionalTally):
    """The collisions with fixed particles."""

    name: ClassVar[str] = "fixed_collisions"


@dataclass(frozen=True)
class PerAreaTally(OptionalTally):
    """What faces are given per area that centres of particles of each size can reach, where sizes differ."""

    name: ClassVar[str] = "per_area"

    def axes(self, scene: Scene) -> dict[str, int]:
        """The components of the momentum."""
        return {"axis": scene.dimension}


ASKED: dict[str, type[OptionalTally]] = {
    tally.name: tally for tally in (StressTally, ImpulseTally, PairImpulseTally)
}
"""All that a run can ask for, by name."""


def tallies_of(scene: Scene) -> tuple[OptionalTally, ...]:
    """Those that every run of a scene has, if its engine makes them."""
    made = {
        WallShearTally(): scene.drags_faces,
        EntryTally(): scene.is_open,
        FixedCollisionTally(): scene.has_fixed,
        PerAreaTally(): scene.has_unequal_areas,
    }
    return tuple(tally for tally, present in made.items() if present)


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


def stored_tally(stored: str, kind: type[AnyTally]) -> AnyTally | None:
    """The tally of a kind among those that a trajectory states in its attribute `tallies` (JSON); None if it
    is not there. Raises as `tally_from_dict`."""
    tallies = map(tally_from_dict, json.loads(stored))
    return next((tally for tally in tallies if isinstance(tally, kind)), None)
