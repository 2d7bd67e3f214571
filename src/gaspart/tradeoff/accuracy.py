"""The accuracy of an observable that a run is to reach."""

from __future__ import annotations

from typing import Self

from gaspart.analysis.observables import OBSERVABLES, having
from gaspart.errors import SceneError, unknown_word
from gaspart.trajectory.until import Requirement


class Accuracy(Requirement):
    """The accuracy that a run is to reach: standard error / |value| of an observable.

    observable: Z, D, collision_rate, pressure or shear_viscosity, as `gaspart measure` names them; accuracy:
    relative, of one standard error that includes correlations; start: the time from which frames count, by
    default a quarter of the run; face: of the pressure, the wall (`x low`), by default each of them. Raises
    SceneError for other values.
    """

    def __post_init__(self) -> None:
        able = having(ends_runs=True)
        if self.observable not in able:
            rule = unknown_word(self.observable, able, "observable")
            raise SceneError("until.observable", self.observable, rule)
        super().__post_init__()
        if self.face is not None and OBSERVABLES[self.observable].along != ("face",):
            raise SceneError("until.face", self.face, f"has no meaning for {self.observable}")

    @classmethod
    def named(cls, name: str, accuracy: float, start: float | None = None) -> Self:
        """From its `name`, as on the command line and in a config: `Z`, or `pressure:x low`."""
        observable, colon, face = name.partition(":")
        return cls(observable.strip(), accuracy, start, face.strip() if colon else None)
