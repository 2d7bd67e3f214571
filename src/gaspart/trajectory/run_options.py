"""Options of a run that determine the contents of its file, and the accuracies that end it.

A field of `Contents` declares an option: its type, meaning and default, its attribute in the file, and the
reasons that exclude it. The following are derived from this declaration: the checks and attributes of a
`Recipe`, the keys of a config, the options of `gaspart run`, the command in a file that reproduces it, and
the reference pages of all these. A tally that a run can request is declared in `state.tally`. In Python it is
an object. On the command line and in configs it is the text of its settings.

Planning a workflow imports this module. To keep planning fast, functions import slow modules only when they
run.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import asdict, astuple, dataclass, field, fields
from itertools import takewhile
from typing import TYPE_CHECKING, Any, TypeVar

from gaspart.errors import SceneError
from gaspart.keys import TEXT, Kind, choice, count, declare, describe, flag
from gaspart.keys.values import number
from gaspart.scene.boundaries import refuse_open
from gaspart.scene.features import row_count
from gaspart.scene.surfaces import wall_of
from gaspart.state.optional_tallies import OptionalTally
from gaspart.state.tally import TALLIES, Tally

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene
    from gaspart.trajectory.correlator import Correlations

AnyTally = TypeVar("AnyTally", bound=OptionalTally)

KEPT = {"positions": "coordinates", "velocities": "velocities"}
"""Choices of `keep`, with the variable of a frame that each choice stores."""

REQUESTED = {name: tally for name, tally in TALLIES.items() if tally.form}
"""Classes of the tallies that a run can request by an option, by name."""


# Values of the options, and their attributes in a file.


def _to_int32(value: int) -> Any:
    """Convert a value to an attribute that is a 32-bit integer."""
    import numpy as np

    return np.int32(value)


def _read_correlations(value: str | Mapping[str, Any]) -> Correlations:
    """Return correlations from an attribute of a file, or from an argument of a job."""
    from gaspart.trajectory.correlator import Correlations

    return Correlations.from_json(value) if isinstance(value, str) else Correlations(**value)


def _check_correlations(key: str, value: Any) -> Correlations:
    """Return `value` if it is a `Correlations` object; otherwise raise SceneError."""
    from gaspart.trajectory.correlator import Correlations

    if not isinstance(value, Correlations):
        raise SceneError(key, value, "must be a gaspart.Correlations")
    return value


def _check_tallies(key: str, value: Any) -> tuple[OptionalTally, ...]:
    """Return requested tallies in the order of their declarations; SceneError if they are none."""
    tallies = value if isinstance(value, Iterable) and not isinstance(value, str) else (value,)
    requested: dict[str, OptionalTally] = {}
    for tally in tallies:
        if not isinstance(tally, OptionalTally) or tally.fact:
            able = ", ".join(f"gaspart.{kind.__name__}" for kind in TALLIES.values() if not kind.fact)
            raise SceneError(key, tally, f"must be of {able}")
        if requested.setdefault(tally.name, tally) != tally:
            raise SceneError(tally.name, tally.to_text(), "must be requested only once")
    return tuple(requested[name] for name in TALLIES if name in requested)


def tallies_to_json(tallies: Iterable[OptionalTally]) -> str:
    """Return the attribute `tallies` of a trajectory: names and settings as JSON."""
    return json.dumps([{"name": tally.name, **asdict(tally)} for tally in tallies])


def tallies_from_json(text: str) -> tuple[OptionalTally, ...]:
    """Return the tallies of an attribute, the inverse of `tallies_to_json`; SceneError or TypeError."""
    tallies = []
    for settings in json.loads(text):
        name = settings.pop("name", None)
        if name not in TALLIES or TALLIES[name].fact:
            able = (key for key, tally in TALLIES.items() if not tally.fact)
            raise SceneError("tallies", name, f"must be one of {', '.join(able)}")
        tallies.append(TALLIES[name](**settings))
    return tuple(tallies)


def stored_tally(attributes: Mapping[str, Any], kind: type[AnyTally]) -> AnyTally | None:
    """Return the tally of a class from a trajectory's attributes, or None; raises as `tallies_from_json`."""
    tallies = tallies_from_json(attributes.get("tallies", "[]"))
    return next((tally for tally in tallies if isinstance(tally, kind)), None)


# Declarations.


def _declare(
    kind: Kind,
    store: Callable[[Any], Any],
    restore: Callable[[Any], Any],
    closed: bool = False,
    until: str = "",
) -> dict[str, Any]:
    """Return the metadata of the field of an option. `kind`: kind of the value; for an option of the command
    line and a key of a config, also meaning and default. `store` and `restore`: conversions to the attribute
    of a file, and back. `closed`: True if open faces exclude the option, because particles are replaced.
    `until`: rule for the message if accuracies that end the run exclude the option.
    """
    return {**declare(kind), "store": store, "restore": restore, "closed": closed, "until": until}


_DISPLACEMENTS = "also keep unwrapped displacements since time 0, in float64, for mean-squared displacements"
_FOLLOW = (
    "keep only the first so many particles (single `particles` come first, then `species`); counters and "
    "energies are those of all"
)
_KEEP = (
    "what frames hold of each particle (by default positions, velocities and spins; without positions "
    "no other program reads the file, and chemfiles finds 0)"
)
_PAIRS = "count the collisions of each pair of species, with which `contact_values` are measured"


@dataclass(frozen=True, kw_only=True)
class Contents:
    """Contents of the file of a run; an invalid value raises SceneError."""

    displacements: bool = field(
        default=False,
        metadata=_declare(flag(_DISPLACEMENTS, default=False), _to_int32, bool, closed=True),
    )
    follow: int | None = field(
        default=None, metadata=_declare(count(_FOLLOW, default=None), _to_int32, int, closed=True)
    )
    keep: str | None = field(
        default=None,
        metadata=_declare(
            choice(_KEEP, *KEPT, default=None),
            str,
            str,
            until="has no meaning with until, which measures what is there",
        ),
    )
    correlations: Correlations | None = field(
        default=None,
        metadata=_declare(
            Kind({}, _check_correlations),
            lambda correlations: correlations.to_json(),
            _read_correlations,
            closed=True,
        ),
    )
    pairs: bool = field(
        default=False, metadata=_declare(flag(_PAIRS, default=False), _to_int32, bool, closed=True)
    )
    tallies: tuple[OptionalTally, ...] = field(
        default=(), metadata=_declare(Kind({}, _check_tallies), tallies_to_json, tallies_from_json)
    )

    def __post_init__(self) -> None:
        for item in fields(Contents):
            value = getattr(self, item.name)
            if value is not None or item.default is not None:
                object.__setattr__(self, item.name, item.metadata["kind"].check(item.name, value))

    def check_scene(self, scene: Scene, until: bool) -> None:
        """Raise SceneError for an option that the scene or `until` excludes."""
        if self.follow is not None and self.follow > scene.count:
            rule = f"must be at most {scene.count}, the number of particles"
            raise SceneError("follow", self.follow, rule)
        for item in fields(Contents):
            if value := getattr(self, item.name):
                if until and item.metadata["until"]:
                    raise SceneError(item.name, value, item.metadata["until"])
                if item.metadata["closed"]:
                    refuse_open(scene, f"excludes {item.name}: the particles change")

    @property
    def kept(self) -> tuple[str, ...]:
        """Names of optional data that the file contains, as in `needs` of observables."""
        fluxes = self.correlations is not None and self.correlations.stress
        return ("fluxes",) * fluxes + ("pairs",) * self.pairs

    def attributes(self) -> dict[str, Any]:
        """Return the attributes of the file for all options with non-default values."""
        values = {item: getattr(self, item.name) for item in fields(Contents)}
        return {item.name: item.metadata["store"](value) for item, value in values.items() if value}


OPTIONS: dict[str, Kind] = {
    **{item.name: kind for item in fields(Contents) if "description" in (kind := item.metadata["kind"])},
    **{
        tally.name: describe(TEXT, tally.meaning, title=tally.form, default=None)
        for tally in REQUESTED.values()
    },
}
"""Kind, meaning and default of each option of the command line, by its name, in the order of the help text.
"""


def required_contents(needs: Collection[str]) -> dict[str, bool]:
    """Return the values of fields of `Contents` that observables with these `needs` require."""
    return {"displacements": "paths" in needs, "pairs": "pairs" in needs}


def stored_contents(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields of `Contents` from a file's attributes; SceneError, TypeError or ValueError."""
    return {
        item.name: item.metadata["restore"](attributes[item.name])
        for item in fields(Contents)
        if item.name in attributes
    }


def recipe_fields(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields of a recipe for settings in plain values. Texts and mappings are converted to
    objects. Raises SceneError for an invalid text of a tally, or for invalid correlations. `settings`: fields
    of `Recipe`, with correlations as a mapping, and texts of tallies by their names.
    """
    result = {name: value for name, value in settings.items() if name not in REQUESTED}
    if result.get("correlations") is not None:
        result["correlations"] = _read_correlations(result["correlations"])
    texts = {name: settings[name] for name in REQUESTED if settings.get(name) is not None}
    return {**result, "tallies": tuple(REQUESTED[name].from_text(text) for name, text in texts.items())}


def contents_of(settings: Mapping[str, Any]) -> Contents:
    """Return the `Contents` of a run's file from settings in plain values, see `recipe_fields`."""
    names = {item.name for item in fields(Contents)}
    values = recipe_fields(
        {name: value for name, value in settings.items() if name in names | REQUESTED.keys()}
    )
    return Contents(**values)


def stated_options(contents: Contents) -> dict[str, Any]:
    """Return the values of `OPTIONS`, with tallies as texts; the inverse of `recipe_fields`."""
    texts = {tally.name: tally.to_text() for tally in contents.tallies}
    return {name: texts.get(name, getattr(contents, name, None)) for name in OPTIONS}


# Variables of the optional tallies of a run.


def scene_tallies(scene: Scene) -> tuple[OptionalTally, ...]:
    """Return the tallies that every run of a scene has, if the engine supports them."""
    return tuple(tally() for tally in TALLIES.values() if tally.fact and getattr(scene, tally.fact))


def tallied_fields(tallies: Iterable[OptionalTally]) -> list[str]:
    """Return the names of the fields of `Tally` that a run with these optional tallies has."""
    present = {None, *(tally.name for tally in tallies)}
    return [item.name for item in fields(Tally) if item.metadata.get("only") in present]


def tally_axes(tally: OptionalTally, scene: Scene) -> dict[str, int]:
    """Return the length of each axis of a tally's fields but `face`, from the setting with the
    axis's plural.
    """
    lengths = {key.removesuffix("s"): length for key, length in asdict(tally).items()}
    lengths |= {"axis": scene.dimension, "direction": scene.dimension, "species": row_count(scene)}
    own = (item.metadata for item in fields(Tally) if item.metadata.get("only") == tally.name)
    return {axis: lengths[axis] for data in own for axis in data.get("along", ()) if axis != "face"}


# Runs that end at accuracies: required accuracies, and frame numbers of tests.


_ACCURACIES = 1e-8, 1.0
_FIRST_TESTS = 64, 96
"""Numbers of frames at the first two tests.

The number at each later test is twice the number two tests before. The ratios of successive numbers are 3/2
and 4/3.
"""
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Requirement:
    """Required accuracy of an observable, as stored in a file; see `gaspart.Accuracy`."""

    observable: str
    accuracy: float
    start: float | None = None
    face: str | None = None

    def __post_init__(self) -> None:
        low, high = _ACCURACIES
        rule = f"must be from {low:g} to {high:g}, the relative standard error"
        value = number("until.accuracy", self.accuracy, rule, least=low, most=high)
        object.__setattr__(self, "accuracy", value)
        if self.start is not None:
            start = number("until.start", self.start, "must not be negative", least=0.0)
            object.__setattr__(self, "start", start)
        object.__setattr__(self, "face", wall_of(self.face))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Requirement) and astuple(self) == astuple(other)

    def __hash__(self) -> int:
        return hash(astuple(self))

    @property
    def name(self) -> str:
        """Name of the observable as on the command line, with the face if one is prescribed."""
        return self.observable if self.face is None else f"{self.observable}:{self.face}"


@dataclass(frozen=True)
class Until:
    """Accuracies that a run must all reach, and its maximum duration (None: no maximum)."""

    accuracies: tuple[Requirement, ...]
    at_most: float | None = None

    def __post_init__(self) -> None:
        if not self.accuracies or not all(
            isinstance(requirement, Requirement) for requirement in self.accuracies
        ):
            raise SceneError("until", self.accuracies, "must be a gaspart.Accuracy, or several")
        names = [requirement.name for requirement in self.accuracies]
        for name in names:
            if names.count(name) > 1:
                raise SceneError("until", name, "must be requested only once")
        if self.at_most is not None:
            longest = number("at_most", self.at_most, "must be positive", above=0.0)
            object.__setattr__(self, "at_most", longest)

    def most_frames(self, sample_interval: float) -> int | None:
        """Return the maximum number of frames, with time 0, or None; SceneError without one after time 0."""
        if self.at_most is None:
            return None
        intervals = math.floor(min(self.at_most / sample_interval, 2.0**53) * (1.0 + _ROUNDING))
        if intervals < 1:
            rule = f"must be at least the sample_interval, {sample_interval:g}"
            raise SceneError("at_most", self.at_most, rule)
        return intervals + 1

    def to_json(self) -> str:
        """Return the accuracies for the attributes of a file."""
        entries = [
            {key: value for key, value in asdict(requirement).items() if value is not None}
            for requirement in self.accuracies
        ]
        return json.dumps(entries)

    @classmethod
    def from_dict(cls, values: dict) -> Until:
        """Make an instance from a mapping, the inverse of `dataclasses.asdict`. Raises SceneError."""
        return cls(tuple(Requirement(**entry) for entry in values["accuracies"]), values["at_most"])

    @classmethod
    def from_json(cls, text: str, at_most: float | None) -> Until:
        """Make an instance from `to_json`'s text; SceneError for values, TypeError or ValueError for
        texts.
        """
        return cls(tuple(Requirement(**entry) for entry in json.loads(text)), at_most)


def examined_frames() -> Iterator[int]:
    """Yield the numbers of frames at which accuracies are tested: 64, 96, 128, 192 ..."""
    first, second = _FIRST_TESTS
    while True:
        yield first
        yield second
        first, second = 2 * first, 2 * second


def is_examined(frames: int) -> bool:
    """Return True if accuracies are tested at this number of frames."""
    return next(count for count in examined_frames() if count >= frames) == frames


def examined_before(frames: int) -> int | None:
    """Return the number of frames of the last test before `frames`, or None."""
    earlier = list(takewhile(lambda count: count < frames, examined_frames()))
    return earlier[-1] if earlier else None


def examined_from(frames: float) -> int:
    """Return the number of frames of the first test with at least `frames` frames."""
    return next(count for count in examined_frames() if count >= frames)
