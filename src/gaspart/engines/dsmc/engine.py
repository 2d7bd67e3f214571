"""DSMC engine (Bird 1994)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gaspart.engines.dsmc.settings import DsmcSettings
from gaspart.engines.engine import register
from gaspart.keys import documented

if TYPE_CHECKING:
    from gaspart.engines.dsmc.cells import Errors, Medium
    from gaspart.engines.dsmc.dynamics import DsmcDynamics
    from gaspart.scene.scene import Scene
    from gaspart.state.optional_tallies import OptionalTally
    from gaspart.state.state import State


@documented
@register
@dataclass(frozen=True)
class DSMC(DsmcSettings):
    """Direct simulation Monte Carlo engine: collision partners are drawn at random within a cell.

    In each step all particles move freely, and then pairs in the same cell collide. The result is bitwise
    identical for any number of threads.

    In the model "enskog" the centres of collision partners are one diameter apart, and the collision rate is
    multiplied by the contact value. With `adapt` "steps" are divided if speeds rise, and "cells" become
    narrower if the gas becomes denser somewhere.

    The errors are described in docs/dsmc.md.

    Literature: G. A. Bird, Molecular Gas Dynamics and the Direct Simulation of Gas Flows (1994).

    Literature: M. S. Ivanov and S. V. Rogasinsky, Sov. J. Numer. Anal. Math. Modelling 3, 453 (1988).

    Literature: J. M. Montanero and A. Santos, Phys. Rev. E 54, 438 (1996); Phys. Fluids 9, 2057 (1997).

    See Also
    --------
    EventDriven : Exact collisions of hard particles.
    TimeStepped : Time steps with overlap resolution.

    Examples
    --------
    >>> import gaspart as gp
    >>> gp.DSMC(model="enskog").equation
    'enskog'
    """

    def for_scene(self, scene: Scene, interval: float | None = None) -> DSMC:
        """Return a copy with cells and time step, a fraction of `interval`, for a scene. Raises SceneError if
        nothing moves, or `cells_per_side` does not fit the dimension.
        """
        _, cells, step = self._chosen(scene)
        if self.time_step is None and interval is not None:
            step = interval / math.ceil(interval / step * (1.0 - 1e-9))
        return self._with(time_step=step, cells_per_side=cells, adapts=(self.adapts_steps, self.adapts_cells))

    def predictions(self, scene: Scene) -> dict[str, float]:
        """Return the relative error of the shear viscosity due to cells and steps, and of other fluxes.
        Raises SceneError if nothing moves, or `cells_per_side` does not fit the dimension.
        """
        return {"viscosity_error": self.bias(scene, "fluxes")}

    def cells_along(self, scene: Scene) -> int:
        return max(self._chosen(scene)[1])

    def added_bulk_viscosity(self, scene: Scene) -> float:
        """Return the bulk viscosity of the Boltzmann model, which is due to its cells alone: (A / d^2) n m nu
        times the sum of the squared sides of a cell, with the number density n, the collision rate nu, and A
        = 1/18 for spheres and 1/12 for discs [mass length^(2-d)/time].
        """
        medium, cells, _ = self._chosen(scene)
        return medium.bulk_viscosity(cells)

    def bias(self, scene: Scene, kind: str) -> float:
        """Bound the relative error of a quantity due to cells, steps and lost collisions (docs/dsmc.md)."""
        return self.errors(scene).of(kind)

    def errors(self, scene: Scene) -> Errors:
        """Return the parts of the relative errors due to cells and steps (docs/dsmc.md)."""
        medium, cells, step = self._chosen(scene)
        return medium.errors(cells, step)

    def remarks(self, scene: Scene) -> list[str]:
        from gaspart.engines.dsmc.cells import neglected, remarks

        text = neglected(self, scene)
        return [*([text] if text else []), *remarks(self, *self._chosen(scene)).values()]

    def _chosen(self, scene: Scene) -> tuple[Medium, tuple[int, ...], float]:
        """Return the gas of a scene, and the number of cells along each axis and the step for it."""
        from gaspart.engines.dsmc.cells import cells_for, medium_for
        from gaspart.engines.dsmc.defaults import step_for

        medium = medium_for(self, scene)
        step = step_for(self, scene, medium.gas_rates)
        return medium, cells_for(self, medium, step), step

    def variant(self, scene: Scene) -> str:
        from gaspart.engines.dsmc.defaults import may_speed_up

        paced = "-paced" if may_speed_up(scene) else ""
        return self.model + paced + ("-threads" if self.threads > 1 else "")

    def for_small_scene(self, scene: Scene) -> DSMC:
        return self.for_scene(scene)._with(cells_per_side=1, adapts=(self.adapts_steps, False))

    def start(
        self,
        scene: Scene,
        state: State,
        seed: int | tuple[int, ...] = 0,
        tallies: Sequence[OptionalTally] = (),
    ) -> DsmcDynamics:
        from gaspart.engines.dsmc.dynamics import DsmcDynamics

        return DsmcDynamics(self, scene, state, seed, tallies)
