"""DSMC engine (Bird 1994)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gaspart.engines.dsmc.settings import DsmcSettings
from gaspart.engines.engine import register

if TYPE_CHECKING:
    from gaspart.engines.dsmc.cells import Errors, Medium
    from gaspart.engines.dsmc.dynamics import DsmcDynamics
    from gaspart.scene.scene import Scene
    from gaspart.state.optional_tallies import OptionalTally
    from gaspart.state.state import State


@register
@dataclass(frozen=True)
class DSMC(DsmcSettings):
    """Direct simulation Monte Carlo engine: collision partners are drawn at random within a cell.

    In each step all particles move freely, and then pairs in the same cell collide. The result is bitwise
    identical for any number of threads.

    Parameters
    ----------
    time_step : float, [time], optional
        Length of a step. Default: a step of at most a fifth of the scene's mean free time.
    cells_per_side : int or (d,) sequence of int, optional
        Number of cells along each axis. Default: the cells with the smallest error; a single cell along
        periodic axes on which the gas does not vary.
    model : {"boltzmann", "enskog"}, default "boltzmann"
        Collision model. "boltzmann": a dilute gas [1]_ [2]_. "enskog": a dense gas [3]_, in which the centres
        of collision partners are one diameter apart, and the collision rate is multiplied by the contact
        value.
    adapt : {"nothing", "steps", "cells", "both"}, optional
        Settings that the engine adapts during a run. "steps": steps are divided if speeds rise. "cells":
        cells become narrower if the gas becomes denser somewhere. Default: all settings that are not
        prescribed.
    threads : int, default 1
        Number of threads that share the work.

    Raises
    ------
    SceneError
        If a setting is invalid.

    See Also
    --------
    EventDriven : Exact collisions of hard particles.
    TimeStepped : Time steps with overlap resolution.

    Notes
    -----
    The errors are described in docs/dsmc.md.

    References
    ----------
    .. [1] G. A. Bird, Molecular Gas Dynamics and the Direct Simulation of Gas Flows (1994).
    .. [2] M. S. Ivanov and S. V. Rogasinsky, Sov. J. Numer. Anal. Math. Modelling 3, 453 (1988).
    .. [3] J. M. Montanero and A. Santos, Phys. Rev. E 54, 438 (1996); Phys. Fluids 9, 2057 (1997).

    Examples
    --------
    >>> import gaspart as gp
    >>> gp.DSMC(model="enskog").equation
    'enskog'
    """

    def for_scene(self, scene: Scene, interval: float | None = None) -> DSMC:
        """Return a copy with cells and time step chosen for a scene.

        Parameters
        ----------
        scene : Scene
            The scene.
        interval : float, [time], optional
            Time interval that must be an integer number of steps.

        Returns
        -------
        DSMC
            The engine.

        Raises
        ------
        SceneError
            If nothing moves, or `cells_per_side` does not fit the dimension.

        Examples
        --------
        >>> import gaspart as gp
        >>> box = gp.Container((40.0, 40.0, 40.0), boundary="periodic")
        >>> scene = gp.Scene(box, [gp.Species(2000, 0.5, temperature=1.0)])
        >>> engine = gp.DSMC().for_scene(scene, interval=1.0)
        >>> engine.time_step, engine.cells_per_side
        (0.5, (7, 7, 7))
        """
        _, cells, step = self._chosen(scene)
        if self.time_step is None and interval is not None:
            step = interval / math.ceil(interval / step * (1.0 - 1e-9))
        return self._with(time_step=step, cells_per_side=cells, adapts=(self.adapts_steps, self.adapts_cells))

    def predictions(self, scene: Scene) -> dict[str, float]:
        """Return the relative error of the shear viscosity due to cells and steps, and of other fluxes.

        Parameters
        ----------
        scene : Scene
            The scene.

        Returns
        -------
        dict of str to float
            ``viscosity_error``: relative excess of the viscosity.

        Raises
        ------
        SceneError
            If nothing moves, or `cells_per_side` does not fit the dimension.

        Examples
        --------
        >>> import gaspart as gp
        >>> box = gp.Container((40.0, 40.0, 40.0), boundary="periodic")
        >>> scene = gp.Scene(box, [gp.Species(2000, 0.5, temperature=1.0)])
        >>> round(gp.DSMC().predictions(scene)["viscosity_error"], 3)
        0.105
        """
        return {"viscosity_error": self.bias(scene, "fluxes")}

    def cells_along(self, scene: Scene) -> int:
        return max(self._chosen(scene)[1])

    def added_bulk_viscosity(self, scene: Scene) -> float:
        """Return the bulk viscosity of the Boltzmann model, which is due to its cells alone.

        Parameters
        ----------
        scene : Scene
            Scene of particles with one mass.

        Returns
        -------
        float, [mass length^(2-d)/time]
            (A / d^2) n m nu times the sum of the squared sides of a cell, where n is the number density, nu
            the collision rate, and A = 1/18 for spheres and 1/12 for discs.

        Examples
        --------
        >>> import gaspart as gp
        >>> box = gp.Container((40.0, 40.0, 40.0), boundary="periodic")
        >>> scene = gp.Scene(box, [gp.Species(2000, 0.5, temperature=1.0)])
        >>> round(gp.DSMC().added_bulk_viscosity(scene), 4)
        0.0042
        """
        medium, cells, _ = self._chosen(scene)
        return medium.bulk_viscosity(cells)

    def bias(self, scene: Scene, kind: str) -> float:
        """Bound the relative error of a quantity due to cells, steps and lost collisions.

        Parameters
        ----------
        scene : Scene
            The scene.
        kind : {"rates", "paths", "fluxes", "walls"}
            Quantities on which the observable depends: rates of collisions, paths of particles, or fluxes of
            momentum and heat.

        Returns
        -------
        float, [1]
            The bias; see docs/dsmc.md for its parts.

        Examples
        --------
        >>> import gaspart as gp
        >>> box = gp.Container((40.0, 40.0, 40.0), boundary="periodic")
        >>> scene = gp.Scene(box, [gp.Species(2000, 0.5, temperature=1.0)])
        >>> [round(gp.DSMC().bias(scene, kind), 4) for kind in ("rates", "paths", "fluxes")]
        [0.0, 0.0334, 0.1052]
        """
        return self.errors(scene).of(kind)

    def errors(self, scene: Scene) -> Errors:
        """Return the parts of the errors due to cells and steps.

        Parameters
        ----------
        scene : Scene
            The scene.

        Returns
        -------
        Errors
            Relative errors, see docs/dsmc.md.

        Examples
        --------
        >>> import gaspart as gp
        >>> box = gp.Container((40.0, 40.0, 40.0), boundary="periodic")
        >>> round(gp.DSMC().errors(gp.Scene(box, [gp.Species(2000, 0.5, temperature=1.0)])).step, 4)
        0.0021
        """
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
