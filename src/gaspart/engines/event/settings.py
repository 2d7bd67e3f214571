"""Event-driven engine (Spencer 2021 and 2022; Lubachevsky, J. Comput. Phys. 94, 255 (1991))."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

from gaspart.engines.engine import Engine, register
from gaspart.errors import SceneError
from gaspart.keys import choice, declare, documented, per_side
from gaspart.scene.features import FEATURES
from gaspart.state.tally import TALLIES

if TYPE_CHECKING:
    from gaspart.engines.event.dynamics import EventDynamics
    from gaspart.scene.scene import Scene
    from gaspart.state.optional_tallies import OptionalTally
    from gaspart.state.state import State

SEARCHES = ("automatic", "boxes", "lists", "direct", "pairs")


@documented
@register
@dataclass(frozen=True)
class EventDriven(Engine):
    """Event-driven engine: exact collisions of hard particles, from one event to the next.

    The results of all searches are bitwise identical. The method is described in (Spencer (2021 and 2022))
    and (B. D. Lubachevsky, J. Comput. Phys. 94, 255 (1991)).

    With `search` "boxes" a queue contains the next event of each particle, which is searched in neighbouring
    boxes; "lists" searches neighbour lists instead; "automatic" is the faster of these two at the density of
    the scene. "direct" is a single box, so that each search tests all particles; with "pairs" all pairs are
    tested before every event, as a reference.

    A box is at least as wide as the diameter of the largest particle in the boxes. A few oversized particles
    can be excluded from the boxes. The search of a small particle near an oversized particle then tests this
    particle separately. By default the largest particles are excluded if this reduces the number of particles
    examined in a search by a quarter (`state.boxes`). With `boxes_per_side`, particles wider than a box are
    excluded; they must be fewer than the other particles.

    Raises
    ------
    SceneError
        If a setting is invalid, or if boxes are passed for a search without boxes.

    See Also
    --------
    TimeStepped : Time steps with overlap resolution.
    DSMC : Collision partners drawn at random.

    Examples
    --------
    >>> import gaspart as gp
    >>> gp.EventDriven(search="lists").search
    'lists'
    """

    search: str = field(
        default="automatic", metadata=declare(choice("how the next event is found", *SEARCHES))
    )
    boxes_per_side: int | tuple[int, ...] | None = field(
        default=None,
        metadata=declare(
            per_side("number of boxes, or one for each axis; by default 0.5 to 1.5 boxes per particle")
        ),
    )

    name: ClassVar[str] = "event"
    title: ClassVar[str] = "event-driven"
    records_events: ClassVar[bool] = True
    tallies: ClassVar[frozenset[str]] = frozenset(TALLIES)
    models: ClassVar[frozenset[str]] = frozenset(FEATURES)
    neutral_settings: ClassVar[tuple[str, ...]] = ("search", "boxes_per_side")
    first_segment: ClassVar[int] = 256  # events including crossings and predictions
    reference: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.search not in ("automatic", "boxes") and self.boxes_per_side is not None:
            raise SceneError("boxes_per_side", self.boxes_per_side, 'needs search "boxes"')

    def _search(self, scene: Scene) -> str:
        from gaspart.engines.event.search import chosen_search

        return chosen_search(scene, self.search, self.boxes_per_side is not None)

    def variant(self, scene: Scene) -> str:
        search = self._search(scene)
        return "boxes" if search == "direct" else search

    def for_small_scene(self, scene: Scene) -> EventDriven:
        boxes = None if self.boxes_per_side is None else 1
        return EventDriven(search=self._search(scene), boxes_per_side=boxes)

    def start(
        self,
        scene: Scene,
        state: State,
        seed: int | tuple[int, ...] = 0,
        tallies: Sequence[OptionalTally] = (),
    ) -> EventDynamics:
        from gaspart.engines.event.dynamics import EventDynamics

        return EventDynamics(scene, state, seed, self.search, self.boxes_per_side, tallies)
