"""The event-driven engine (Spencer 2021 and 2022; Lubachevsky, J. Comput. Phys. 94, 255 (1991))."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

from gaspart.engines.engine import Engine, register
from gaspart.errors import SceneError
from gaspart.keys import choice, declared, per_side
from gaspart.scene.features import FEATURES
from gaspart.state.optional_tallies import TALLIES

if TYPE_CHECKING:
    from gaspart.engines.event.dynamics import EventDynamics
    from gaspart.scene.scene import Scene
    from gaspart.state.optional_tallies import OptionalTally
    from gaspart.state.state import State

SEARCHES = ("automatic", "boxes", "lists", "direct", "pairs")


@register
@dataclass(frozen=True)
class EventDriven(Engine):
    """From one event to the next, exactly.

    search: "boxes", with one next event per particle in a queue; "lists", the same with neighbour lists;
    "automatic", the one of these that is faster at the density of the scene; "direct", with a single box,
    each search over all particles; "pairs", all pairs before every event (Spencer 2021, section 3.1), the
    referee. All give the same bits. boxes_per_side: a number, or one per axis; by default 0.5 to 1.5 a
    particle.

    No box is narrower than the diameters of the particles in it. A few oversized particles can be left out of
    the boxes, each of them tested by every small one near it: by default the largest of all, if that saves a
    quarter of what a search examines (`state.boxes`); with `boxes_per_side`, those that are wider than a
    box, which must be fewer than the others.
    """

    search: str = field(
        default="automatic", metadata=declared(choice("how the next event is found", *SEARCHES))
    )
    boxes_per_side: int | tuple[int, ...] | None = field(
        default=None,
        metadata=declared(per_side("number of boxes, or one for each axis; by default chosen")),
    )

    name: ClassVar[str] = "event"
    title: ClassVar[str] = "event-driven"
    records_events: ClassVar[bool] = True
    tallies: ClassVar[frozenset[str]] = frozenset(tally.name for tally in TALLIES)
    models: ClassVar[frozenset[str]] = frozenset(FEATURES)
    neutral_settings: ClassVar[tuple[str, ...]] = ("search", "boxes_per_side")
    first_segment: ClassVar[int] = 256  # events with crossings and predictions
    reference: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.search not in ("automatic", "boxes") and self.boxes_per_side is not None:
            raise SceneError("boxes_per_side", self.boxes_per_side, 'needs search "boxes"')

    def _search(self, scene: Scene) -> str:
        from gaspart.engines.event.search import chosen_search

        return chosen_search(scene, self.search, self.boxes_per_side is not None)

    def describe(self) -> str:
        """With its precision."""
        return f"{self.name}, {self.precision}"

    def notes(self, scene: Scene, observable: str, paths: bool) -> dict[str, str]:
        """How it finds pairs."""
        return {"boxes": "automatic, about one per particle"}

    def variant(self, scene: Scene) -> str:
        """The search; of "direct" that of boxes, of which it has one."""
        search = self._search(scene)
        return "boxes" if search == "direct" else search

    def for_small_scene(self, scene: Scene) -> EventDriven:
        """With the search for this scene, not the one for a few particles, and one box if there are any."""
        boxes = None if self.boxes_per_side is None else 1
        return EventDriven(search=self._search(scene), boxes_per_side=boxes)

    def start(
        self,
        scene: Scene,
        state: State,
        seed: int | tuple[int, ...] = 0,
        tallies: Sequence[OptionalTally] = (),
    ) -> EventDynamics:
        """Set the engine up for a scene in a given state; `seed` is that of thermal walls and kicks."""
        from gaspart.engines.event.dynamics import EventDynamics

        return EventDynamics(scene, state, seed, self.search, self.boxes_per_side, tallies)
