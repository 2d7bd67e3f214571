"""What an engine is asked for, an observable of a steady scene to an accuracy, and what it answers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import numpy as np

    from gaspart.engines.engine import Engine
    from gaspart.scene.scene import Scene
    from gaspart.state.state import State


class Local(Protocol):
    """The local density and temperature of a steady scene, in layers (S,) across an axis, as
    `gaspart.accuracy.conditions` knows them, which states what each of these is."""

    @property
    def scene(self) -> Scene:
        """The scene."""

    @property
    def axis(self) -> int | None:
        """Across which it changes; None of an even gas."""

    @property
    def scale(self) -> float:
        """The shortest length along the axis over which it changes by the factor e."""

    @property
    def free(self) -> np.ndarray:
        """(d,) lengths that centres can reach."""

    @property
    def share(self) -> np.ndarray:
        """(S,) the part of all particles in each layer."""

    @property
    def crowding(self) -> np.ndarray:
        """(S,) the density over the mean one."""

    @property
    def temperature(self) -> np.ndarray:
        """(S,) k_B T."""

    @property
    def filled(self) -> np.ndarray:
        """(S,) packing fraction."""

    @property
    def contact(self) -> np.ndarray:
        """(S,) contact value of an infinite gas."""

    @property
    def contact_of_few(self) -> np.ndarray:
        """(S,) that of so many particles."""

    @property
    def virial(self) -> np.ndarray:
        """(S,) Z - 1."""

    @property
    def path(self) -> np.ndarray:
        """(S,) mean free path."""

    @property
    def speed(self) -> np.ndarray:
        """(S,) mean speed."""

    @property
    def contrast(self) -> float:
        """The shortest free path of an even gas over the shortest one here."""

    @property
    def surfaces(self) -> float:
        """The part of all contacts that lack a neighbour beyond a wall."""

    @property
    def memory(self) -> float:
        """|D / Enskog's - 1|, by correlated collisions."""

    def of_points(self, observable: str, face: str | None) -> float | None:
        """By how much the observable of points differs where theory knows the column of particles."""


@dataclass(frozen=True)
class Asked:
    """An observable of a steady scene, and its relative accuracy: a standard error with the bias.

    conditions: of the scene; face: of the pressure, the wall; transported: whether transport coefficients
    govern the observable; initial: the state at time 0, None where only the errors of models are asked for.
    """

    observable: str
    accuracy: float
    conditions: Local
    face: str | None = None
    transported: bool = False
    initial: State | None = None

    @property
    def scene(self) -> Scene:
        """That of the conditions."""
        return self.conditions.scene


@dataclass(frozen=True)
class Candidate:
    """An engine with its settings for a scene. model, discretisation: bounds on its relative errors, by the
    equation that it solves, and by steps and cells."""

    engine: Engine
    model: float = 0.0
    discretisation: float = 0.0

    @property
    def bias(self) -> float:
        """The bound on its systematic error."""
        return self.model + self.discretisation
