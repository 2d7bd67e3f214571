"""Adviser of an engine: its settings and error bounds for an accuracy, its place in the table of costs.

The defaults are for the event-driven engine; `of_step` and `of_dsmc` have the advisers of the other engines.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Generic, TypeVar

from gaspart.engines.engine import Engine
from gaspart.scene.scene import Scene
from gaspart.state.state import State
from gaspart.theory.conditions import Conditions

E = TypeVar("E", bound=Engine)


@dataclass(frozen=True)
class AccuracyRequest:
    """Observable of a steady scene, and its requested relative accuracy: standard error and bias together."""

    observable: str
    accuracy: float
    conditions: Conditions
    face: str | None = None
    transported: bool = False
    initial: State | None = None

    @property
    def scene(self) -> Scene:
        """Scene for which the conditions hold."""
        return self.conditions.scene


@dataclass(frozen=True)
class Candidate:
    """Engine with its settings for a scene, and bounds on its relative errors."""

    engine: Engine
    model: float = 0.0
    discretisation: float = 0.0

    @property
    def bias(self) -> float:
        """Bound on the total systematic error: the sum of both bounds."""
        return self.model + self.discretisation


@dataclass(frozen=True)
class Adviser(Generic[E]):
    """Facts about an engine that plans and predictions of costs use.

    timed_at : packing fraction and time step of the entry in the table of costs that is timed to convert the
        table to another machine
    advised : settings that `engine: auto` in a config may specify
    pairs : method of finding pairs, in words
    """

    engine: E

    timed_at: ClassVar[tuple[float, float]] = (0.1, 0.0)
    advised: ClassVar[tuple[str, ...]] = ()
    pairs: ClassVar[str] = "automatic, about one per particle"

    @staticmethod
    def variants(kind: type[E]) -> tuple[E, ...]:
        """Return the candidates of a plan for a class of engines: one engine per collision model."""
        return (kind(),)

    def candidate(self, request: AccuracyRequest) -> Candidate:
        """Return the engine with settings for a requested accuracy and error bounds; SceneError if
        unsuitable.
        """
        return Candidate(self.engine)

    @property
    def timed_as(self) -> str:
        """Name in the table of costs (`gaspart.accuracy.table`)."""
        return self.engine.name

    def timed_step(self, scene: Scene) -> float:
        """Return the time step in the unit of the table of costs, or 0."""
        return 0.0

    def at_step(self, scene: Scene, step: float, precision: str) -> E:
        """Return the engine with the settings of a row of the table of costs, at `step` in the
        table's unit.
        """
        return self.engine

    @property
    def limitations(self) -> str:
        """Limitations in words."""
        return "nothing"

    def describe(self) -> str:
        """Return the name with the relevant settings, in words."""
        return f"{self.engine.name}, {self.engine.precision}"

    def notes(self, scene: Scene, observable: str, paths: bool) -> dict[str, str]:
        """Return remarks about the engine for a plan, by title; `paths`: for an observable of paths."""
        return {"boxes": self.pairs}
