"""The settings of the DSMC engine (Bird 1994)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Literal

from gaspart.errors import SceneError
from gaspart.scene.validation import choice, count_of, number
from gaspart.state.boxes import MOST_BOXES

if TYPE_CHECKING:
    from gaspart.engines.dsmc.dynamics import DsmcDynamics
    from gaspart.scene.scene import Scene
    from gaspart.state.state import State

MODELS = ("boltzmann", "enskog")


@dataclass(frozen=True)
class DSMC:
    """Small steps, in which particles first fly and then collide with partners drawn in their cell.

    time_step: in the scene's time unit; cells_per_side: a number of cells or one per axis. By default the
    engine chooses both from the mean free time and path of the initial state. model: "boltzmann", a dilute
    gas; or "enskog", a dense one, in which partners are a diameter apart and meet the more often the denser
    the gas. threads: how many share the work.

    The result is the same, bit for bit, for any number of threads. Errors: docs/dsmc.md.
    """

    time_step: float | None = None
    cells_per_side: int | tuple[int, ...] | None = None
    model: str = "boltzmann"
    threads: int = 1

    name: ClassVar[Literal["dsmc"]] = "dsmc"

    def __post_init__(self) -> None:
        if self.time_step is not None:
            step = number("time_step", self.time_step, "must be positive", above=0.0)
            object.__setattr__(self, "time_step", step)
        if self.cells_per_side is not None:
            check_cells(self.cells_per_side)
        choice("model", self.model, MODELS)
        count_of("threads", self.threads, least=1)

    def start(self, scene: Scene, state: State, seed: int | tuple[int, ...] = 0) -> DsmcDynamics:
        """Set the engine up for a scene in a given state; `seed` is that of collisions and thermal walls."""
        from gaspart.engines.dsmc.dynamics import DsmcDynamics

        return DsmcDynamics(self, scene, state, seed)


def check_cells(given: object) -> None:
    """Raise SceneError unless this is a number of cells, or one per axis."""
    sides = given if isinstance(given, (tuple, list)) else (given,)
    total = math.prod(count_of("cells_per_side", n, least=1) for n in sides)
    if total > MOST_BOXES or len(sides) > 3:
        rule = f"must be one number, or one per axis, of at most {MOST_BOXES} cells"
        raise SceneError("cells_per_side", given, rule)
