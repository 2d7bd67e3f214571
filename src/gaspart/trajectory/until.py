"""Runs that end when accurate: what is asked of them, and the numbers of frames at which it is examined."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from itertools import takewhile

from gaspart.errors import SceneError, unknown_word
from gaspart.scene.validation import number

OBSERVABLES = ("Z", "D", "collision_rate", "pressure", "shear_viscosity")
"""Of which a run can be required to know one with a given accuracy."""
_ACCURACIES = 1e-8, 1.0
_FIRST = 64, 96
"""Frames at the first two examinations; each further one has twice as many as the one before its
predecessor, so that the ratios are 3/2 and 4/3."""
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Accuracy:
    """The accuracy that a run is to reach: standard error / |value| of an observable.

    observable: Z, D, collision_rate, pressure or shear_viscosity, as `gaspart measure` names them; accuracy:
    relative, of one standard error that includes correlations; start: the time from which frames count, by
    default a quarter of the run; face: of the pressure, the wall (`x low`), by default each of them. Raises
    SceneError for other values.
    """

    observable: str
    accuracy: float
    start: float | None = None
    face: str | None = None

    def __post_init__(self) -> None:
        if self.observable not in OBSERVABLES:
            rule = unknown_word(self.observable, OBSERVABLES, "observable")
            raise SceneError("until.observable", self.observable, rule)
        low, high = _ACCURACIES
        rule = f"must be from {low:g} to {high:g}, the relative standard error"
        value = number("until.accuracy", self.accuracy, rule, least=low, most=high)
        object.__setattr__(self, "accuracy", value)
        if self.start is not None:
            start = number("until.start", self.start, "must not be negative", least=0.0)
            object.__setattr__(self, "start", start)
        if self.face is not None and self.observable != "pressure":
            raise SceneError("until.face", self.face, f"has no meaning for {self.observable}")

    @classmethod
    def named(cls, name: str, accuracy: float, start: float | None = None) -> Accuracy:
        """From its `name`, as on the command line and in a config: `Z`, or `pressure:x low`."""
        observable, colon, face = name.partition(":")
        return cls(observable.strip(), accuracy, start, face.strip() if colon else None)

    @property
    def name(self) -> str:
        """The observable, with its face if one is stated, as on the command line."""
        return self.observable if self.face is None else f"{self.observable}:{self.face}"


@dataclass(frozen=True)
class Until:
    """Accuracies that a run is to reach, all of them, and its longest duration, None for none."""

    accuracies: tuple[Accuracy, ...]
    at_most: float | None = None

    def __post_init__(self) -> None:
        if not self.accuracies or not all(isinstance(one, Accuracy) for one in self.accuracies):
            raise SceneError("until", self.accuracies, "must be a gaspart.Accuracy, or several")
        names = [one.name for one in self.accuracies]
        for name in names:
            if names.count(name) > 1:
                raise SceneError("until", name, "is asked for twice")
        if self.at_most is not None:
            longest = number("at_most", self.at_most, "must be positive", above=0.0)
            object.__setattr__(self, "at_most", longest)

    def most_frames(self, sample_interval: float) -> int | None:
        """Frames of the longest run, including the one at time 0; None if it is not limited. Raises
        SceneError for a longest duration without a frame after that."""
        if self.at_most is None:
            return None
        intervals = math.floor(min(self.at_most / sample_interval, 2.0**53) * (1.0 + _ROUNDING))
        if intervals < 1:
            rule = f"must be at least the sample_interval, {sample_interval:g}"
            raise SceneError("at_most", self.at_most, rule)
        return intervals + 1

    def to_json(self) -> str:
        """The accuracies in the attributes of a file."""
        asked = [
            {key: value for key, value in asdict(one).items() if value is not None} for one in self.accuracies
        ]
        return json.dumps(asked)

    @classmethod
    def from_json(cls, text: str, at_most: float | None) -> Until:
        """The inverse of `to_json`. Raises SceneError, and TypeError or ValueError for another text."""
        return cls(tuple(Accuracy(**one) for one in json.loads(text)), at_most)


def examined_frames() -> Iterator[int]:
    """The numbers of frames at which a run is examined, without end: 64, 96, 128, 192 ..."""
    first, second = _FIRST
    while True:
        yield first
        yield second
        first, second = 2 * first, 2 * second


def is_examined(frames: int) -> bool:
    """Whether a run is examined when it has so many frames."""
    return next(count for count in examined_frames() if count >= frames) == frames


def examined_before(frames: int) -> int | None:
    """The number of frames of the last examination before that at so many; None if there is none."""
    earlier = list(takewhile(lambda count: count < frames, examined_frames()))
    return earlier[-1] if earlier else None


def examined_from(frames: float) -> int:
    """The number of frames of the first examination with at least so many."""
    return next(count for count in examined_frames() if count >= frames)
