"""Settings of the time-stepped engine, for the modules that carry them out."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, ClassVar, Self

from gaspart.engines.engine import Engine
from gaspart.errors import SceneError
from gaspart.keys import choice, count, declare, flag, per_side, positive
from gaspart.scene.faces import FACE_KINDS

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene

PRECISIONS = ("float64", "float32")


@dataclass(frozen=True)
class StepSettings(Engine):
    """Settings of `TimeStepped`, which describes them."""

    time_step: float = field(metadata=declare(positive("duration of a step [time]")))
    boxes_per_side: int | tuple[int, ...] | None = field(
        default=None,
        metadata=declare(per_side("number of boxes, or one for each axis; by default a neighbour list")),
    )
    precision: str = field(
        default="float64", metadata=declare(choice("floating-point type of the state", *PRECISIONS))
    )
    rewind: bool = field(
        default=True,
        metadata=declare(
            flag(
                "overlapping pairs are moved back to their contact before they collide; without it "
                "the effect of rewinding shows"
            )
        ),
    )
    passes: int = field(
        default=4,
        metadata=declare(
            count(
                "most searches for overlaps in a step, which ends after the first that finds none; 1 "
                "is the original method"
            )
        ),
    )
    skin: float | None = field(
        default=None,
        metadata=declare(
            positive(
                "distance by which a neighbour list reaches farther than a contact [length]; by "
                "default chosen"
            )
        ),
    )
    near_boxes: bool = field(
        default=False, metadata=declare(flag("with boxes: search only the boxes within reach of a contact"))
    )
    threads: int = field(
        default=1,
        metadata=declare(
            count(
                "number of threads that share the work; only a search with a neighbour list uses "
                "several, faster above 5e4 particles"
            )
        ),
    )

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

    tallies: ClassVar[frozenset[str]] = frozenset(("impulses", "fixed_collisions", "per_area"))

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.skin is not None and self.boxes_per_side is not None:
            raise SceneError("skin", self.skin, "excludes boxes_per_side")
        if self.near_boxes and self.boxes_per_side is None:
            raise SceneError("near_boxes", True, "needs boxes_per_side")

    @property
    def quantum(self) -> float:
        return self.time_step

    def with_step(self, step: float) -> Self:
        """Return a copy with this time step."""
        return replace(self, time_step=step)

    def variant(self, scene: Scene) -> str:
        search = "list" if self.boxes_per_side is None else "boxes"
        return f"{search}-{self.precision}" + ("-threads" if self.threads > 1 else "")

    def for_small_scene(self, scene: Scene) -> Self:
        return self if self.boxes_per_side is None else replace(self, boxes_per_side=1)
