"""The DSMC engine (Bird 1994)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar

from gaspart.engines.engine import Engine, register
from gaspart.keys import choice, count, declared, per_side, positive

if TYPE_CHECKING:
    from gaspart.engines.dsmc.dynamics import DsmcDynamics
    from gaspart.engines.engine import Asked, Candidate
    from gaspart.scene.scene import Scene
    from gaspart.state.optional_tallies import OptionalTally
    from gaspart.state.state import State

MODELS = ("boltzmann", "enskog")
ADAPTED = ("nothing", "steps", "cells", "both")


@register
@dataclass(frozen=True)
class DSMC(Engine):
    """Small steps, in which particles first fly and then collide with partners drawn in their cell.

    time_step: in the scene's time unit; cells_per_side: a number of cells or one per axis. By default both
    follow from the mean free time and path of the scene. model: "boltzmann", a dilute gas; or "enskog", a
    dense one, in which partners are a diameter apart and meet the more often the denser the gas. adapt: what
    follows the gas where speeds or densities change: "nothing", "steps", which are divided, "cells" or
    "both"; by default what is not given. threads: how many share the work.

    The result is the same, bit for bit, for any number of threads. Errors: docs/dsmc.md.
    """

    time_step: float | None = field(
        default=None,
        metadata=declared(positive("duration of a step; by default a fifth of a mean free time, at most")),
    )
    cells_per_side: int | tuple[int, ...] | None = field(
        default=None,
        metadata=declared(
            per_side("number of cells, or one for each axis; by default a third of a mean free path wide")
        ),
    )
    model: str = field(
        default="boltzmann",
        metadata=declared(choice("`boltzmann`, a dilute gas, or `enskog`, a dense one", *MODELS)),
    )
    adapt: str | None = field(
        default=None,
        metadata=declared(
            choice(
                "what follows a gas whose speeds or densities change: `nothing`, `steps`, which are divided,"
                " `cells`, or `both`; by default what is not given",
                *ADAPTED,
            )
        ),
    )
    threads: int = field(default=1, metadata=declared(count("number of threads that share a run's work")))

    name: ClassVar[str] = "dsmc"
    title: ClassVar[str] = "DSMC"
    neutral_settings: ClassVar[tuple[str, ...]] = ("threads",)
    forbids_overlap: ClassVar[bool] = False
    tallies: ClassVar[frozenset[str]] = frozenset(("stress", "wall_shear", "per_area"))
    models: ClassVar[frozenset[str]] = frozenset(
        ("gravity", "restitution", "roughness", "viscoelasticity", "thermostat")
    ) | {"centres_to_walls", "thermal", "sliding", "accommodation", "ramp"}
    counters: ClassVar[tuple[str, ...]] = ("steps",)
    timed_at: ClassVar[tuple[float, float]] = (0.01, 1.0)
    advised: ClassVar[tuple[str, ...]] = ("model",)

    @property
    def equation(self) -> str:
        """The model."""
        return self.model

    @property
    def adapts_steps(self) -> bool:
        """Whether steps are divided where speeds rise."""
        return self.time_step is None if self.adapt is None else self.adapt in ("steps", "both")

    @property
    def adapts_cells(self) -> bool:
        """Whether cells become narrower where particles gather."""
        return self.cells_per_side is None if self.adapt is None else self.adapt in ("cells", "both")

    @property
    def quantum(self) -> float | None:
        """A step, once it is known."""
        return self.time_step

    def resolved(self, scene: Scene, interval: float | None = None) -> DSMC:
        """With the cells and the step for a scene, of which an interval has a whole number."""
        from gaspart.engines.dsmc.defaults import cells_for, rates, step_for

        found = rates(scene, self.model == "enskog")
        step = step_for(self, scene, found)
        if self.time_step is None and interval is not None:
            step = interval / math.ceil(interval / step * (1.0 - 1e-9))
        cells = cells_for(self, scene, found)
        return self._with(time_step=step, cells_per_side=cells, adapts=(self.adapts_steps, self.adapts_cells))

    def with_step(self, step: float) -> DSMC:
        """With steps of this length, which are not divided."""
        return self._with(time_step=step, adapts=(False, self.adapts_cells))

    def _with(self, adapts: tuple[bool, bool], **settings: Any) -> DSMC:
        """With these settings; adapts: whether steps and cells do, which is stated unless it follows."""
        plain = replace(self, **settings, adapt=None)
        if adapts == (plain.adapts_steps, plain.adapts_cells):
            return plain
        return replace(plain, adapt=ADAPTED[adapts[0] + 2 * adapts[1]])

    def predictions(self, scene: Scene) -> dict[str, float]:
        """By how much its cells and steps make the shear viscosity too high, relatively."""
        from gaspart.engines.dsmc.defaults import cells_for, predicted_error, rates, step_for

        found = rates(scene, self.model == "enskog")
        cells, step = cells_for(self, scene, found), step_for(self, scene, found)
        return {"viscosity_error": predicted_error(cells, step, scene, found)}

    def cells_along(self, scene: Scene) -> int:
        """The cells along the axis with the most."""
        from gaspart.engines.dsmc.defaults import cells_for, rates

        return max(cells_for(self, scene, rates(scene, self.model == "enskog")))

    def bias(self, scene: Scene, kind: str) -> float:
        """The bias of its cells and steps, by the literature, and of the collisions that the Enskog model
        loses."""
        from gaspart.engines.dsmc import defaults
        from gaspart.engines.dsmc.defaults import rates

        found = rates(scene, self.model == "enskog")
        cells, step = defaults.cells_for(self, scene, found), defaults.step_for(self, scene, found)
        lost = defaults.lost_collisions(self, cells, scene)
        if kind == "fluxes":
            return lost + defaults.predicted_error(cells, step, scene, found)
        return lost + (defaults.diffusion_error(step, scene, found) if kind == "paths" else 0.0)

    @classmethod
    def offered(cls) -> tuple[DSMC, ...]:
        """One for each model."""
        return tuple(cls(model=model) for model in MODELS)

    def candidate(self, asked: Asked) -> Candidate:
        """With its own cells and step."""
        from gaspart.engines.dsmc.accuracy import candidate

        return candidate(self, asked)

    @property
    def timed_as(self) -> str:
        """With the model, if it is that of a dense gas."""
        return self.name if self.model == MODELS[0] else f"{self.name} {self.model}"

    def timed_step(self, scene: Scene) -> float:
        """In its own step."""
        return (self.resolved(scene).time_step or 0.0) / self._own_step(scene)

    def at_step(self, scene: Scene, step: float, precision: str) -> DSMC:
        """In its own step."""
        return self.resolved(scene).with_step(step * self._own_step(scene))

    def _own_step(self, scene: Scene) -> float:
        return replace(self, time_step=None).resolved(scene).time_step or math.inf

    @property
    def limitations(self) -> str:
        """What its model lacks, and what no model has that draws partners."""
        lacks = {"boltzmann": "excluded volume", "enskog": "correlated collisions"}
        return f"{lacks[self.model]}, positions of pairs"

    def describe(self) -> str:
        """With its model, and its step once it is known."""
        step = "" if self.time_step is None else f", time_step {self.time_step:.4g}"
        return f"{self.name}, model {self.model}{step}"

    def notes(self, scene: Scene, observable: str, paths: bool) -> dict[str, str]:
        """How it finds pairs, and what steps do that are longer than its own, of which the run warns."""
        found = {"boxes": "cells, whose particles collide by chance: positions of pairs are given up"}
        longer = 1.0 if self.time_step is None else self.time_step / self._own_step(scene)
        if longer >= 1.5:
            effect = "which the bias includes" if paths else f"on which {observable} does not depend"
            found["time step"] = f"{longer:.2g} times the engine's own, {effect}"
        return found

    def variant(self, scene: Scene) -> str:
        """The model, and whether threads share the work."""
        from gaspart.engines.dsmc.defaults import may_speed_up

        paced = "-paced" if may_speed_up(scene) else ""
        return self.model + paced + ("-threads" if self.threads > 1 else "")

    def for_small_scene(self, scene: Scene) -> DSMC:
        """With one cell, and the step for the full scene."""
        return self.resolved(scene)._with(cells_per_side=1, adapts=(self.adapts_steps, False))

    def start(
        self,
        scene: Scene,
        state: State,
        seed: int | tuple[int, ...] = 0,
        tallies: Sequence[OptionalTally] = (),
    ) -> DsmcDynamics:
        """Set the engine up for a scene in a given state; `seed` is that of collisions and thermal walls."""
        from gaspart.engines.dsmc.dynamics import DsmcDynamics

        return DsmcDynamics(self, scene, state, seed, tallies)
