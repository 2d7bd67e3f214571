"""The time-stepped engine (Frederickx & Meerts 2010), with the contact corrected."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, ClassVar

from gaspart.engines.engine import Engine, register
from gaspart.errors import SceneError
from gaspart.keys import choice, count, declared, flag, per_side, positive
from gaspart.scene.faces import FACE_KINDS
from gaspart.scene.gas import plain_gas

if TYPE_CHECKING:
    from gaspart.engines.engine import Asked, Candidate
    from gaspart.engines.step.dynamics import StepDynamics
    from gaspart.scene.scene import Scene
    from gaspart.state.optional_tallies import OptionalTally
    from gaspart.state.state import State

PRECISIONS = ("float64", "float32")


@register
@dataclass(frozen=True)
class TimeStepped(Engine):
    """Small steps; pairs that overlap after a step collide as they were at their contact.

    time_step: in the scene's time unit. boxes_per_side: search the boxes of a grid, a number of them or one
    per axis, down to 1 (all pairs); by default a neighbour list is used instead, with a `skin` (a length)
    that the engine chooses unless it is given. near_boxes: look only into boxes within reach of a contact.
    precision: "float64" or "float32". rewind: collide pairs as they were at their contact (off: as they lie
    after the step, to measure what rewinding buys). passes: how often a step may look for overlaps; it ends
    with the first pass that finds none. With more than one, overlaps that grew and shrank within the step
    count too; one is the rule of Frederickx & Meerts. See docs/time-stepped.md for what each of these buys.

    threads: how many share the work of a list; not worth it below some 5e4 particles (docs/performance.md).

    The result is the same, bit for bit, for any boxes_per_side, near_boxes, skin and threads.
    """

    time_step: float = field(metadata=declared(positive("duration of a step")))
    boxes_per_side: int | tuple[int, ...] | None = field(
        default=None,
        metadata=declared(per_side("number of boxes, or one for each axis; by default a neighbour list")),
    )
    precision: str = field(
        default="float64", metadata=declared(choice("floating-point type of the state", *PRECISIONS))
    )
    rewind: bool = field(
        default=True,
        metadata=declared(flag("overlapping particles are moved back to the time of their contact")),
    )
    passes: int = field(
        default=4, metadata=declared(count("how often a step searches for overlaps, at most"))
    )
    skin: float | None = field(
        default=None,
        metadata=declared(
            positive("distance by which a neighbour list reaches farther than a contact; by default chosen")
        ),
    )
    near_boxes: bool = field(
        default=False, metadata=declared(flag("with boxes: search only the boxes within reach of a contact"))
    )
    threads: int = field(default=1, metadata=declared(count("number of threads that share a run's work")))

    name: ClassVar[str] = "step"
    title: ClassVar[str] = "time-stepped"
    models: ClassVar[frozenset[str]] = frozenset(
        ("gravity", "restitution", "roughness", "fixed", "vibrations", "centres_to_walls", "polydispersity")
    ) | {"accommodation", "ramp", *(kind for kind, face in FACE_KINDS.items() if not face.moves)} - {"open"}
    excludes: ClassVar[tuple[tuple[str, str], ...]] = (("restitution", "gravity"), ("fixed", "gravity"))
    neutral_settings: ClassVar[tuple[str, ...]] = ("boxes_per_side", "near_boxes", "skin", "threads")
    counters: ClassVar[tuple[str, ...]] = (
        "steps",
        "overlaps_left",
        "deepest_overlap",
        "multiple_contacts",
        "rebuilds",
    )

    timed_at: ClassVar[tuple[float, float]] = (0.1, 0.08)
    advised: ClassVar[tuple[str, ...]] = ("time_step", "precision")
    tallies: ClassVar[frozenset[str]] = frozenset(("impulses", "fixed_collisions", "per_area"))

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.skin is not None and self.boxes_per_side is not None:
            raise SceneError("skin", self.skin, "excludes boxes_per_side")
        if self.near_boxes and self.boxes_per_side is None:
            raise SceneError("near_boxes", True, "needs boxes_per_side")

    @property
    def quantum(self) -> float:
        """A step."""
        return self.time_step

    def with_step(self, step: float) -> TimeStepped:
        """With steps of this length."""
        return replace(self, time_step=step)

    @classmethod
    def offered(cls) -> tuple[TimeStepped, ...]:
        """One, whose step is still to be chosen."""
        return (cls(1.0),)

    def candidate(self, asked: Asked) -> Candidate:
        """With the longest step that is accurate enough."""
        from gaspart.engines.step.limits import candidate

        return candidate(self, asked)

    def timed_step(self, scene: Scene) -> float:
        """In diameters over the thermal speed of a plain gas. Raises SceneError for other scenes."""
        return self.time_step / _unit(scene)

    def at_step(self, scene: Scene, step: float, precision: str) -> TimeStepped:
        """In that unit."""
        return replace(self, time_step=step * _unit(scene), precision=precision)

    @property
    def limitations(self) -> str:
        """Pairs that touch and part within a step are missed."""
        return "exact contacts"

    def describe(self) -> str:
        """With its step and its passes."""
        return f"{self.name}, time_step {self.time_step:.4g}, {self.precision}, {self.passes} passes"

    def notes(self, scene: Scene, observable: str, paths: bool) -> dict[str, str]:
        """How it finds pairs."""
        return {"boxes": "none: a neighbour list"}

    def variant(self, scene: Scene) -> str:
        """The search, the precision, and whether threads share the work."""
        search = "list" if self.boxes_per_side is None else "boxes"
        return f"{search}-{self.precision}" + ("-threads" if self.threads > 1 else "")

    def for_small_scene(self, scene: Scene) -> TimeStepped:
        """With one box, if there are any."""
        return self if self.boxes_per_side is None else replace(self, boxes_per_side=1)

    def start(
        self,
        scene: Scene,
        state: State,
        seed: int | tuple[int, ...] = 0,
        tallies: Sequence[OptionalTally] = (),
    ) -> StepDynamics:
        """Set the engine up for a scene in a given state; `seed` is that of thermal walls."""
        from gaspart.engines.step.dynamics import StepDynamics

        return StepDynamics(self, scene, state, seed, tallies)


def _unit(scene: Scene) -> float:
    """The time that a diameter takes at the thermal speed of a plain gas."""
    gas = plain_gas(scene)
    return gas.diameter / gas.thermal_speed
