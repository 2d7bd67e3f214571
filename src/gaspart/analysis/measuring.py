"""An observable of a trajectory, by its name."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gaspart import analysis
from gaspart.analysis.names import OBSERVABLES, SELECTIONS, known
from gaspart.errors import SceneError

if TYPE_CHECKING:
    from gaspart.analysis.observable import Observable
    from gaspart.analysis.run import Source


def measure(name: str, trajectory: Source, start: float | None = None, **selection: Any) -> Observable:
    """An observable of a trajectory or a simulation; start, and what `selection` states (see SELECTIONS): as
    of the functions of `gaspart.analysis`. Raises SceneError for an unknown name, a selection that the
    observable does not have, and as that function does."""
    function, arguments, _ = OBSERVABLES[known(name)]
    for key, value in selection.items():
        if name not in SELECTIONS[key]:
            rule = f"cannot be chosen for {name}, only for {', '.join(SELECTIONS[key])}"
            raise SceneError(key, value, rule)
    found: Observable = getattr(analysis, function)(trajectory, start=start, **arguments, **selection)
    return found
