"""Tallies that not every run has, see `Tally`: requested tallies, and tallies of some scenes.

A run requests a tally by an instance of its class with the settings, or by the text of these settings. An
engine that can make it has its name in `Engine.tallies`, and a part (`engines.features.part.TallyPart`) that
is found by that name.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable, Mapping
from dataclasses import MISSING, asdict, dataclass, fields
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeVar

from gaspart.errors import SceneError
from gaspart.keys.values import count_of, number, one_of
from gaspart.scene.features import require_impulses, require_pair_impulses, require_tallied, row_count

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene


AnyTally = TypeVar("AnyTally", bound="OptionalTally")


@dataclass(frozen=True)
class OptionalTally:
    """Tally that not every run has.

    Attributes
    ----------
    name : str
        Name in messages, in files, and as `only` in the metadata of its fields of `Tally`.
    meaning, form : str
        Description of the option of a run that requests it, and the form of its text: the settings in their
        order, separated by colons; "" without such an option.
    """

    name: ClassVar[str]
    meaning: ClassVar[str] = ""
    form: ClassVar[str] = ""

    @classmethod
    def from_text(cls, text: str) -> Self:
        """Make the tally from the text of its option.

        Parameters
        ----------
        text : str
            Text in the `form` of the tally.

        Returns
        -------
        OptionalTally
            Tally.

        Raises
        ------
        SceneError
            If the text is invalid.
        """
        readers = {"str": str, "int": int, "float": float}
        parts, keys = str(text).split(":"), fields(cls)
        least = sum(item.default is MISSING for item in keys)
        try:
            settings = [readers[str(item.type)](part) for item, part in zip(keys, parts, strict=False)]
        except ValueError:
            settings = []
        if len(settings) < max(least, len(parts)):
            raise SceneError(cls.name, text, f"must be of the form {cls.form}")
        return cls(*settings)

    def check(self, scene: Scene) -> None:
        """Raise SceneError if no engine can make the tally for a scene.

        Parameters
        ----------
        scene : Scene
            Scene to check.
        """

    def axes(self, scene: Scene) -> dict[str, int]:
        """Return the lengths of the axes `along` of its fields, except for `face`.

        Parameters
        ----------
        scene : Scene
            Scene of the run.

        Returns
        -------
        dict of str to int
            Lengths by the name of the axis. A setting with the name in the singular is the length of the
            axis.
        """
        from gaspart.state.tally import Tally  # loads numpy, which planning does not need

        lengths = {key.removesuffix("s"): length for key, length in asdict(self).items()}
        lengths |= {"axis": scene.dimension, "direction": scene.dimension, "species": row_count(scene)}
        own = (field.metadata for field in fields(Tally) if field.metadata.get("only") == self.name)
        return {axis: lengths[axis] for data in own for axis in data.get("along", ()) if axis != "face"}

    def to_text(self) -> str:
        """Return the text of its option, the inverse of `from_text`."""
        return ":".join(map(str, asdict(self).values()))

    @property
    def option(self) -> str:
        """Option of `gaspart run` that requests it, with its text."""
        return f"--{self.name.replace('_', '-')} {self.to_text()}"


@dataclass(frozen=True)
class StressTally(OptionalTally):
    """Stress tensor and heat flux."""

    name: ClassVar[str] = "stress"

    def check(self, scene: Scene) -> None:
        """Raise SceneError unless velocities change only at contacts, in a periodic container.

        Parameters
        ----------
        scene : Scene
            Scene to check.
        """
        require_tallied(scene)


@dataclass(frozen=True)
class ImpulseTally(OptionalTally):
    """Momentum that particles transport along an axis through planes across this axis.

    The density along the axis is computed from this momentum (`analysis.impulses`).

    Parameters
    ----------
    axis : {"x", "y", "z"}
        Axis.
    bins : int
        Number of equal bins of the container, from 2 to 100000.

    Raises
    ------
    SceneError
        If the axis or the number of bins is invalid.
    """

    axis: str
    bins: int

    name: ClassVar[str] = "impulses"
    meaning: ClassVar[str] = (
        "keep impulses along an axis in so many bins, such as `z:200`: in equilibrium `density` along the "
        "axis and `pressure` across it are then several times as accurate"
    )
    form: ClassVar[str] = "AXIS:BINS"
    most: ClassVar[int] = 100_000

    def __post_init__(self) -> None:
        one_of("impulses.axis", self.axis, ("x", "y", "z"))
        count_of("impulses.bins", self.bins, least=2, most=self.most)

    def check(self, scene: Scene) -> None:
        """Raise SceneError unless the scene has the axis and is in equilibrium at one temperature.

        Parameters
        ----------
        scene : Scene
            Scene to check.
        """
        one_of("impulses.axis", self.axis, tuple("xyz"[: scene.dimension]))
        require_impulses(scene)


@dataclass(frozen=True)
class PairImpulseTally(OptionalTally):
    """Momentum that pairs of particles gain along their separation, in shells of equal thickness.

    The pair distribution g(r) is computed from this tally (`analysis.pairs`).

    Parameters
    ----------
    furthest : float, [length]
        Largest distance, above 0.
    shells : int
        Number of shells, from 2 to 100000.
    share : float, default 1.0, [1]
        Fraction of contacts at which the pairs with the other particles are searched for, in (0, 1].

    Raises
    ------
    SceneError
        If a value is out of range.
    """

    furthest: float
    shells: int
    share: float = 1.0

    name: ClassVar[str] = "pair_impulses"
    meaning: ClassVar[str] = (
        "keep impulses of pairs up to a distance in so many shells, at a fraction of contacts (default: 1), "
        "such as `3:300:0.5`: in equilibrium `rdf` is then more accurate"
    )
    form: ClassVar[str] = "DISTANCE:SHELLS[:FRACTION]"

    def __post_init__(self) -> None:
        number("pair_impulses.furthest", self.furthest, "must be positive", above=0.0)
        count_of("pair_impulses.shells", self.shells, least=2, most=ImpulseTally.most)
        number("pair_impulses.share", self.share, "must be above 0 and at most 1", above=0.0, most=1.0)

    def check(self, scene: Scene) -> None:
        """Raise SceneError unless a scene is periodic, in equilibrium at one temperature, and long enough.

        Parameters
        ----------
        scene : Scene
            Scene to check.
        """
        require_pair_impulses(scene, self.furthest)


def useful_impulses(scene: Scene, tallies: Collection[str], axis: int, bins: int) -> tuple[ImpulseTally, ...]:
    """Return the impulse tally along an axis, if it gives the density of a scene.

    Parameters
    ----------
    scene : Scene
        Scene of the run.
    tallies : collection of str
        Names of the tallies that the engine can make.
    axis : int
        Index of the axis.
    bins : int
        Number of bins.

    Returns
    -------
    tuple of ImpulseTally
        Sequence with one tally or none.
    """
    tally = ImpulseTally("xyz"[axis], bins)
    try:
        tally.check(scene)
    except SceneError:
        return ()
    one_mass = all(kind.alike for kind in scene.kinds)
    pulled = bool(scene.gravity and scene.gravity[axis])
    by_mass = pulled or scene.container.periodic[axis]
    return (tally,) if tally.name in tallies and (one_mass or not by_mass) else ()


@dataclass(frozen=True)
class WallShearTally(OptionalTally):
    """Tangential momentum given to faces."""

    name: ClassVar[str] = "wall_shear"


@dataclass(frozen=True)
class EntryTally(OptionalTally):
    """Particles that have entered through open faces."""

    name: ClassVar[str] = "entries"


@dataclass(frozen=True)
class FixedCollisionTally(OptionalTally):
    """Collisions with fixed particles."""

    name: ClassVar[str] = "fixed_collisions"


@dataclass(frozen=True)
class PerAreaTally(OptionalTally):
    """Momentum and heat of faces per area that centres of each size can reach.

    A run has it if sizes differ.
    """

    name: ClassVar[str] = "per_area"


ASKED: dict[str, type[OptionalTally]] = {
    tally.name: tally for tally in (StressTally, ImpulseTally, PairImpulseTally)
}
"""Tallies that a run can have beside those of its scene, by name."""
REQUESTED = {name: tally for name, tally in ASKED.items() if tally.form}
"""Tallies that an option requests by its text, by name."""
TALLIES: tuple[type[OptionalTally], ...] = (
    *ASKED.values(),
    WallShearTally,
    EntryTally,
    FixedCollisionTally,
    PerAreaTally,
)
"""All optional tallies."""


def tallies_of(scene: Scene) -> tuple[OptionalTally, ...]:
    """Return the tallies that every run of a scene has, if its engine makes them.

    Parameters
    ----------
    scene : Scene
        Scene of the run.

    Returns
    -------
    tuple of OptionalTally
        Tallies.
    """
    conditions = {
        WallShearTally(): scene.drags_faces,
        EntryTally(): scene.is_open,
        FixedCollisionTally(): scene.has_fixed,
        PerAreaTally(): scene.has_unequal_areas,
    }
    return tuple(tally for tally, present in conditions.items() if present)


def tallied_fields(tallies: Iterable[OptionalTally]) -> list[str]:
    """Return the fields of `Tally` that a run with some optional tallies has.

    Parameters
    ----------
    tallies : iterable of OptionalTally
        Optional tallies.

    Returns
    -------
    list of str
        Names of the fields.
    """
    from gaspart.state.tally import Tally  # loads numpy, which planning does not need

    present = {None, *(tally.name for tally in tallies)}
    return [field.name for field in fields(Tally) if field.metadata.get("only") in present]


def tallies_to_json(tallies: Iterable[OptionalTally]) -> str:
    """Return the attribute `tallies` of a trajectory.

    Parameters
    ----------
    tallies : iterable of OptionalTally
        Requested tallies.

    Returns
    -------
    str
        JSON of their names and settings.
    """
    return json.dumps([{"name": tally.name, **asdict(tally)} for tally in tallies])


def tallies_from_json(text: str) -> tuple[OptionalTally, ...]:
    """Return the tallies in an attribute `tallies`, the inverse of `tallies_to_json`.

    Parameters
    ----------
    text : str
        JSON of their names and settings.

    Returns
    -------
    tuple of OptionalTally
        Tallies.

    Raises
    ------
    SceneError
        If a name is unknown.
    TypeError
        If a setting is unknown.
    """
    tallies = []
    for settings in json.loads(text):
        name = settings.pop("name", None)
        if name not in ASKED:
            raise SceneError("tallies", name, f"must be one of {', '.join(ASKED)}")
        tallies.append(ASKED[name](**settings))
    return tuple(tallies)


def stored_tally(attributes: Mapping[str, Any], kind: type[AnyTally]) -> AnyTally | None:
    """Return the tally of a kind among the tallies of a trajectory.

    Parameters
    ----------
    attributes : mapping of str to object
        Attributes of the trajectory.
    kind : type
        Class of the tally.

    Returns
    -------
    OptionalTally or None
        Tally, or None if the trajectory does not have it.

    Raises
    ------
    SceneError, TypeError
        As `tallies_from_json`.
    """
    tallies = tallies_from_json(attributes.get("tallies", "[]"))
    return next((tally for tally in tallies if isinstance(tally, kind)), None)
