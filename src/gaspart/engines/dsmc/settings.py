"""Settings of the DSMC engine, for the modules that carry them out."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar, Self

from gaspart.engines.engine import Engine
from gaspart.keys import choice, count, declare, per_side, positive
from gaspart.scene.boundaries import refuse_open

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene

MODELS = ("boltzmann", "enskog")
_DILUTE = 'needs the "event" engine, or the "boltzmann" model of this one'
ADAPTED = ("nothing", "steps", "cells", "both")


@dataclass(frozen=True)
class DsmcSettings(Engine):
    """Settings of `DSMC`, which describes them."""

    time_step: float | None = field(
        default=None,
        metadata=declare(
            positive("duration of a step [time]; by default a fifth of a mean free time, at most")
        ),
    )
    cells_per_side: int | tuple[int, ...] | None = field(
        default=None,
        metadata=declare(
            per_side(
                "number of cells, or one for each axis; by default those with the smallest error, a "
                "single one along periodic axes on which the gas does not vary"
            )
        ),
    )
    model: str = field(
        default="boltzmann",
        metadata=declare(choice("`boltzmann`, a dilute gas, or `enskog`, a dense one", *MODELS)),
    )
    adapt: str | None = field(
        default=None,
        metadata=declare(
            choice(
                "what follows a gas whose speeds or densities change: `nothing`, `steps`, which are divided,"
                " `cells`, or `both`; by default what is not given",
                *ADAPTED,
            )
        ),
    )
    threads: int = field(default=1, metadata=declare(count("number of threads that share a run's work")))

    name: ClassVar[str] = "dsmc"
    title: ClassVar[str] = "DSMC"
    neutral_settings: ClassVar[tuple[str, ...]] = ("threads",)
    forbids_overlap: ClassVar[bool] = False
    tallies: ClassVar[frozenset[str]] = frozenset(("stress", "wall_shear", "per_area", "entries"))
    models: ClassVar[frozenset[str]] = frozenset(
        ("gravity", "restitution", "roughness", "viscoelasticity", "thermostat")
    ) | {"centres_to_walls", "thermal", "sliding", "accommodation", "ramp", "open"}
    counters: ClassVar[tuple[str, ...]] = ("steps",)

    @property
    def equation(self) -> str:
        return self.model

    @property
    def adapts_steps(self) -> bool:
        """True if steps are divided when speeds rise."""
        return self.time_step is None if self.adapt is None else self.adapt in ("steps", "both")

    @property
    def adapts_cells(self) -> bool:
        """True if cells become narrower when the gas becomes denser somewhere."""
        return self.cells_per_side is None if self.adapt is None else self.adapt in ("cells", "both")

    @property
    def quantum(self) -> float | None:
        return self.time_step

    def check_features(self, scene: Scene) -> None:
        super().check_features(scene)
        if self.model == "enskog":
            refuse_open(scene, f"{_DILUTE}: the particles of its reservoirs have no excluded volume")

    def with_step(self, step: float) -> Self:
        """Return a copy with this fixed time step."""
        return self._with(time_step=step, adapts=(False, self.adapts_cells))

    def _with(self, adapts: tuple[bool, bool], **settings: Any) -> Self:
        """Return a copy with these settings changed. `adapts`: True if steps and cells are adapted; `adapt`
        is set only if this does not follow from the other settings.
        """
        plain = replace(self, **settings, adapt=None)
        if adapts == (plain.adapts_steps, plain.adapts_cells):
            return plain
        return replace(plain, adapt=ADAPTED[adapts[0] + 2 * adapts[1]])
