"""The event-driven engine (Spencer 2021 and 2022; Lubachevsky, J. Comput. Phys. 94, 255 (1991))."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from gaspart.engines.event.dynamics import EventDynamics
from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.scene.validation import choice
from gaspart.state.boxes import check_boxes_per_side
from gaspart.state.state import State

SEARCHES = ("automatic", "boxes", "lists", "direct", "pairs")


@dataclass(frozen=True)
class EventDriven:
    """From one event to the next, exactly.

    search: "boxes", with one next event per particle in a queue; "lists", the same with neighbour lists;
    "automatic", the one of these that is faster at the density of the scene; "direct", with a single box,
    each search over all particles; "pairs", all pairs before every event (Spencer 2021, section 3.1), the
    referee. All give the same bits. boxes_per_side: a number, or one per axis; by default 0.5 to 1.5 a
    particle.

    No box is narrower than the diameters of the particles in it. A few oversized particles can be left out of
    the boxes, each of them tested by every small one near it: by default the largest of all, if that saves a
    quarter of what a search examines (`state.oversized`); with `boxes_per_side`, those that are wider than a
    box, which must be fewer than the others.
    """

    search: str = "automatic"
    boxes_per_side: int | tuple[int, ...] | None = None

    name: ClassVar[Literal["event"]] = "event"

    def __post_init__(self) -> None:
        choice("search", self.search, SEARCHES)
        if self.search not in ("automatic", "boxes") and self.boxes_per_side is not None:
            raise SceneError("boxes_per_side", self.boxes_per_side, 'needs search "boxes"')
        if self.boxes_per_side is not None:
            check_boxes_per_side(self.boxes_per_side)

    def start(self, scene: Scene, state: State, seed: int | tuple[int, ...] = 0) -> EventDynamics:
        """Set the engine up for a scene in a given state; `seed` is that of thermal walls and kicks."""
        return EventDynamics(scene, state, seed, self.search, self.boxes_per_side)
