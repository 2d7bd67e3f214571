"""An observable of a trajectory, by its name."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gaspart import analysis
from gaspart.analysis.observables import OBSERVABLES, known, require_selection

if TYPE_CHECKING:
    from gaspart.analysis.observable import Observable
    from gaspart.analysis.run import Source


def measure(name: str, trajectory: Source, start: float | None = None, **selection: Any) -> Observable:
    """An observable of a trajectory or a simulation; start, and what `selection` states (see
    `Named.selections`): as of the functions of `gaspart.analysis`. Raises SceneError for an unknown name, a
    selection that the observable does not have, and as that function does."""
    one = OBSERVABLES[known(name)]
    require_selection(name, selection)
    function = getattr(analysis, one.function)
    found: Observable = function(trajectory, start=start, **one.arguments, **selection)
    return found
