"""Time-stepped engine (Frederickx & Meerts 2010), with corrected contacts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gaspart.engines.engine import register
from gaspart.engines.step.settings import StepSettings
from gaspart.keys import documented

if TYPE_CHECKING:
    from gaspart.engines.step.dynamics import StepDynamics
    from gaspart.scene.scene import Scene
    from gaspart.state.optional_tallies import OptionalTally
    from gaspart.state.state import State


@documented
@register
@dataclass(frozen=True)
class TimeStepped(StepSettings):
    """Time-stepped engine: after each step, pairs that overlap are moved back to their contact, and collide.

    After the collision, the pair moves for the rest of the step. The result is bitwise identical for any
    `boxes_per_side`, `near_boxes`, `skin` and `threads`.

    docs/time-stepped.md describes the measured effect of each setting.

    Literature: Frederickx and Meerts (2010).

    See Also
    --------
    EventDriven : Exact collisions of hard particles.
    DSMC : Collision partners drawn at random.

    Examples
    --------
    >>> import gaspart as gp
    >>> gp.TimeStepped(time_step=0.01, precision="float32").passes
    4
    """

    def bias(self, scene: Scene, kind: str) -> float:
        """Bound the relative error of a quantity due to missed contacts and their order, and for "walls" and
        "fluxes" also of transfers to walls (docs/time-stepped.md).
        """
        from gaspart.engines.step.limits import bias

        return bias(self, scene, kind)

    def predictions(self, scene: Scene) -> dict[str, float]:
        """Return bounds on relative errors that are known before a run: `error` of rates, and with walls
        `error_of_wall_pressures` and `error_of_the_density_at_walls`.
        """
        from gaspart.engines.step.limits import wall_density_error

        found = {"error": self.bias(scene, "rates")}
        if scene.walled_axes:
            found["error_of_wall_pressures"] = self.bias(scene, "walls")
            found["error_of_the_density_at_walls"] = wall_density_error(self, scene)
        return found

    def remarks(self, scene: Scene) -> list[str]:
        from gaspart.engines.step.limits import NOTABLE, wall_density_error

        error = wall_density_error(self, scene)
        if error <= NOTABLE:
            return []
        step = float(f"{self.time_step * NOTABLE / error:.2g}")
        return [
            f"time_step = {self.time_step:g}: wall hits precede the collisions of their step, which changes"
            f" the density at walls by up to {100.0 * error:.2g} %; with {step:g} by {100.0 * NOTABLE:g} %"
        ]

    def start(
        self,
        scene: Scene,
        state: State,
        seed: int | tuple[int, ...] = 0,
        tallies: Sequence[OptionalTally] = (),
    ) -> StepDynamics:
        from gaspart.engines.step.dynamics import StepDynamics

        return StepDynamics(self, scene, state, seed, tallies)
