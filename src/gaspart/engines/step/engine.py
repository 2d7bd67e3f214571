"""Time-stepped engine (Frederickx & Meerts 2010), with corrected contacts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gaspart.engines.engine import register
from gaspart.engines.step.settings import StepSettings

if TYPE_CHECKING:
    from gaspart.engines.step.dynamics import StepDynamics
    from gaspart.scene.scene import Scene
    from gaspart.state.optional_tallies import OptionalTally
    from gaspart.state.state import State


@register
@dataclass(frozen=True)
class TimeStepped(StepSettings):
    """Time-stepped engine: after each step, pairs that overlap are moved back to their contact, and collide.

    After the collision, the pair moves for the rest of the step. The result is bitwise identical for any
    `boxes_per_side`, `near_boxes`, `skin` and `threads`.

    Parameters
    ----------
    time_step : float, [time]
        Length of a step.
    boxes_per_side : int or (d,) sequence of int, optional
        Number of boxes along each axis. With boxes, pairs are searched in neighbouring boxes; with 1 box, all
        pairs are tested. Default: a neighbour list instead of boxes.
    precision : {"float64", "float32"}, default "float64"
        Floating-point type of the state.
    rewind : bool, default True
        Move pairs back to their contact before they collide. If False, pairs collide at their positions after
        the step, which shows the effect of rewinding.
    passes : int, default 4
        Maximum number of searches for overlaps per step. The step ends after the first search that finds no
        overlap. With more than one search, overlapping pairs that touched within the step but already
        separate are resolved, too. A single search is the original method [1]_.
    skin : float, [length], optional
        Distance beyond the contact distance up to which pairs are in the neighbour list. Default: the engine
        chooses the distance.
    near_boxes : bool, default False
        Search only neighbouring boxes that are closer to the particle than the contact distance.
    threads : int, default 1
        Number of threads that share the work. Only a search with a neighbour list uses several threads, which
        are faster only above about 5e4 particles (docs/performance.md).

    Raises
    ------
    SceneError
        If a setting is invalid.

    See Also
    --------
    EventDriven : Exact collisions of hard particles.
    DSMC : Collision partners drawn at random.

    Notes
    -----
    docs/time-stepped.md describes the measured effect of each setting.

    References
    ----------
    .. [1] Frederickx and Meerts (2010).

    Examples
    --------
    >>> import gaspart as gp
    >>> gp.TimeStepped(time_step=0.01, precision="float32").passes
    4
    """

    def bias(self, scene: Scene, kind: str) -> float:
        """Bound the relative error of a quantity due to missed contacts and their order.

        Parameters
        ----------
        scene : Scene
            The scene.
        kind : {"rates", "paths", "fluxes", "walls"}
            Transfers to walls, which are "walls" and "fluxes", have an additional error.

        Returns
        -------
        float, [1]
            The bound; see docs/time-stepped.md for its parts.

        Examples
        --------
        >>> import gaspart as gp
        >>> box = gp.Container((40.0, 40.0, 40.0), boundary="periodic")
        >>> scene = gp.Scene(box, [gp.Species(2000, 0.5, temperature=1.0)])
        >>> round(gp.TimeStepped(time_step=0.1).bias(scene, "rates"), 4)
        0.0133
        """
        from gaspart.engines.step.limits import bias

        return bias(self, scene, kind)

    def predictions(self, scene: Scene) -> dict[str, float]:
        """Return bounds on relative errors that are known before a run.

        Parameters
        ----------
        scene : Scene
            The scene.

        Returns
        -------
        dict of str to float
            ``error``: of rates. With walls also ``error_of_wall_pressures`` and
            ``error_of_the_density_at_walls``.

        Examples
        --------
        >>> import gaspart as gp
        >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)])
        >>> {key: round(error, 4) for key, error in gp.TimeStepped(time_step=0.02).predictions(scene).items()}
        {'error': 0.0013, 'error_of_wall_pressures': 0.0015, 'error_of_the_density_at_walls': 0.0044}
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
