"""Tallies that not every run has, see `Tally`: requested tallies, and tallies of some scenes.

A run requests a tally by an instance of its class, which holds its settings. An engine that can make it has
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
    """Tally that not every run has.

    Attributes
    ----------
    name : str
        Name in messages, in files, and as `only` in the metadata of its fields of `Tally`.
    """

    name: ClassVar[str]

    def check(self, scene: Scene) -> None:
        """Raise SceneError for a scene of which no engine can make the tally.

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
            Lengths by the name of the axis.
        """
        return {}

    def to_text(self) -> str:
        """Return the settings as an option of `gaspart run`; "" without such an option."""
        return ""


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

    def axes(self, scene: Scene) -> dict[str, int]:
        """Return the lengths of both axes of the tensor.

        Parameters
        ----------
        scene : Scene
            Scene of the run.

        Returns
        -------
        dict of str to int
            Lengths by the name of the axis.
        """
        return {"axis": scene.dimension, "direction": scene.dimension}


@dataclass(frozen=True)
class ImpulseTally(OptionalTally):
    """Momentum that particles carry along an axis through planes across the axis.

    The density along the axis follows from it (`analysis.impulses`).

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
    most: ClassVar[int] = 100_000

    def __post_init__(self) -> None:
        one_of("impulses.axis", self.axis, ("x", "y", "z"))
        count_of("impulses.bins", self.bins, least=2, most=self.most)

    @classmethod
    def from_text(cls, text: str) -> ImpulseTally:
        """Make the tally from its axis and number of bins, such as "z:200".

        Parameters
        ----------
        text : str
            Axis and number of bins.

        Returns
        -------
        ImpulseTally
            Tally.

        Raises
        ------
        SceneError
            If the text is invalid.
        """
        axis, _, bins = str(text).partition(":")
        if not bins.isdecimal():
            raise SceneError("impulses", text, "must be an axis and a number of bins, such as z:200")
        return cls(axis, int(bins))

    def to_text(self) -> str:
        """Return the form that `from_text` accepts."""
        return f"{self.axis}:{self.bins}"

    def check(self, scene: Scene) -> None:
        """Raise SceneError unless the scene has the axis and is in equilibrium at one temperature.

        Parameters
        ----------
        scene : Scene
            Scene to check.
        """
        one_of("impulses.axis", self.axis, tuple("xyz"[: scene.dimension]))
        require_impulses(scene)

    def axes(self, scene: Scene) -> dict[str, int]:
        """Return the numbers of species and bins.

        Parameters
        ----------
        scene : Scene
            Scene of the run.

        Returns
        -------
        dict of str to int
            Lengths by the name of the axis.
        """
        return {"species": row_count(scene), "bin": self.bins}


@dataclass(frozen=True)
class PairImpulseTally(OptionalTally):
    """Momentum that pairs of particles gain along their separation, in shells of equal thickness.

    The pair distribution g(r) follows from it (`analysis.pairs`).

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

    def __post_init__(self) -> None:
        number("pair_impulses.furthest", self.furthest, "must be positive", above=0.0)
        count_of("pair_impulses.shells", self.shells, least=2, most=ImpulseTally.most)
        number("pair_impulses.share", self.share, "must be above 0 and at most 1", above=0.0, most=1.0)

    @classmethod
    def from_text(cls, text: str) -> PairImpulseTally:
        """Make the tally from its distance, number of shells and fraction, such as "3:300:0.5".

        Parameters
        ----------
        text : str
            Distance, number of shells and, optionally, fraction of contacts.

        Returns
        -------
        PairImpulseTally
            Tally.

        Raises
        ------
        SceneError
            If the text is invalid.
        """
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
        """Return the form that `from_text` accepts."""
        return f"{self.furthest!r}:{self.shells}:{self.share!r}"

    def check(self, scene: Scene) -> None:
        """Raise SceneError unless pair impulses are defined for a scene.

        Parameters
        ----------
        scene : Scene
            Scene, which must be periodic, in equilibrium at one temperature, and longer than twice the
            distance.
        """
        require_pair_impulses(scene, self.furthest)

    def axes(self, scene: Scene) -> dict[str, int]:
        """Return the number of shells.

        Parameters
        ----------
        scene : Scene
            Scene of the run.

        Returns
        -------
        dict of str to int
            Lengths by the name of the axis.
        """
        return {"shell": self.shells}


def useful_impulses(scene: Scene, tallies: Collection[str], axis: int, bins: int) -> tuple[ImpulseTally, ...]:
    """Return the impulse tally along an axis, if the density of a scene follows from it.

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
        One tally, or none.
    """
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
    """Return the option of `gaspart run` that requests a tally.

    Parameters
    ----------
    tally : OptionalTally
        Tally.

    Returns
    -------
    list of str
        Option and its value, or an empty list without such an option.
    """
    text = tally.to_text()
    return [f"--{tally.name.replace('_', '-')}", text] if text else []


def impulse_tallies(text: str | None) -> tuple[OptionalTally, ...]:
    """Return the impulse tally that a text requests.

    Parameters
    ----------
    text : str or None
        Text of `ImpulseTally.from_text`, or None without a tally.

    Returns
    -------
    tuple of OptionalTally
        One tally, or none.

    Raises
    ------
    SceneError
        If the text is invalid.
    """
    return () if text is None else (ImpulseTally.from_text(text),)


def pair_impulse_tallies(text: str | None) -> tuple[OptionalTally, ...]:
    """Return the tally of pair impulses that a text requests.

    Parameters
    ----------
    text : str or None
        Text of `PairImpulseTally.from_text`, or None without a tally.

    Returns
    -------
    tuple of OptionalTally
        One tally, or none.

    Raises
    ------
    SceneError
        If the text is invalid.
    """
    return () if text is None else (PairImpulseTally.from_text(text),)


@dataclass(frozen=True)
class WallShearTally(OptionalTally):
    """Momentum given to faces along themselves."""

    name: ClassVar[str] = "wall_shear"

    def axes(self, scene: Scene) -> dict[str, int]:
        """Return the number of components of the momentum.

        Parameters
        ----------
        scene : Scene
            Scene of the run.

        Returns
        -------
        dict of str to int
            Lengths by the name of the axis.
        """
        return {"axis": scene.dimension}


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

    def axes(self, scene: Scene) -> dict[str, int]:
        """Return the number of components of the momentum.

        Parameters
        ----------
        scene : Scene
            Scene of the run.

        Returns
        -------
        dict of str to int
            Lengths by the name of the axis.
        """
        return {"axis": scene.dimension}


ASKED: dict[str, type[OptionalTally]] = {
    tally.name: tally for tally in (StressTally, ImpulseTally, PairImpulseTally)
}
"""Tallies that a run can request, by name."""


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
    made = {
        WallShearTally(): scene.drags_faces,
        EntryTally(): scene.is_open,
        FixedCollisionTally(): scene.has_fixed,
        PerAreaTally(): scene.has_unequal_areas,
    }
    return tuple(tally for tally, present in made.items() if present)


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


def tally_to_dict(tally: OptionalTally) -> dict:
    """Return the mapping that `tally_from_dict` accepts.

    Parameters
    ----------
    tally : OptionalTally
        Tally.

    Returns
    -------
    dict
        Name and settings.
    """
    return {"name": tally.name, **asdict(tally)}


def tally_from_dict(mapping: dict) -> OptionalTally:
    """Return the tally that a mapping describes.

    Parameters
    ----------
    mapping : dict
        {"name": name, setting: value, ...}.

    Returns
    -------
    OptionalTally
        Tally.

    Raises
    ------
    SceneError
        If the name is unknown.
    TypeError
        If a setting is unknown.
    """
    settings = dict(mapping)
    name = settings.pop("name", None)
    if name not in ASKED:
        raise SceneError("tallies", name, f"must be one of {', '.join(ASKED)}")
    return ASKED[name](**settings)


def stored_tally(stored: str, kind: type[AnyTally]) -> AnyTally | None:
    """Return the tally of a kind among the tallies that a trajectory states.

    Parameters
    ----------
    stored : str
        Attribute `tallies` of the trajectory (JSON).
    kind : type
        Class of the tally.

    Returns
    -------
    OptionalTally or None
        Tally, or None if the trajectory does not have it.

    Raises
    ------
    SceneError
        If a name is unknown.
    TypeError
        If a setting is unknown.
    """
    tallies = map(tally_from_dict, json.loads(stored))
    return next((tally for tally in tallies if isinstance(tally, kind)), None)
