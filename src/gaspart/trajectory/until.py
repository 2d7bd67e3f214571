"""Runs that end at accuracies: required accuracies, and frame numbers of tests."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import asdict, astuple, dataclass
from itertools import takewhile

from gaspart.errors import SceneError
from gaspart.keys.values import number
from gaspart.scene.faces import wall_of

_ACCURACIES = 1e-8, 1.0
_FIRST = 64, 96
"""Numbers of frames at the first two tests.

The number at each later test is twice the number two tests before. The ratios of successive numbers are 3/2
and 4/3.
"""
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Requirement:
    """Required accuracy of an observable, as stored in a file. See `gaspart.Accuracy`, which validates
    observables.
    """

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
        """Return the maximum number of frames, including time 0; None if there is no limit. Raises SceneError
        if the maximum duration has no frame after time 0.
        """
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
        """Make an instance from a text, the inverse of `to_json`. Raises SceneError for invalid values, and
        TypeError or ValueError for a text of another form.
        """
        return cls(tuple(Requirement(**entry) for entry in json.loads(text)), at_most)


def examined_frames() -> Iterator[int]:
    """Yield the numbers of frames at which accuracies are tested: 64, 96, 128, 192 ..."""
    first, second = _FIRST
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
