"""How an observable was estimated, and what a run must keep for a better estimate."""

from __future__ import annotations

import json

from gaspart.analysis.run import Run
from gaspart.engines import ENGINES
from gaspart.errors import SceneError
from gaspart.state.optional_tallies import OptionalTally, option_of


def engine_tallies(run: Run) -> frozenset[str]:
    """The names of the optional tallies that the engine of a run can make."""
    engine = json.loads(run.data.attrs.get("engine", "{}")).get("name")
    return ENGINES[engine].tallies if engine in ENGINES else frozenset()


def estimator(
    run: Run, usual: str, better: str, used: bool, asked: OptionalTally | None, lacks: str = ""
) -> dict[str, str]:
    """Attributes of an observable: of what it was estimated, which is `usual`, or `better` if that was used;
    and of the former, where the scene and the engine allow to keep what is asked for, how a run does so, or
    else what that of this run lacks."""
    if used:
        return {"estimator": better}
    found = {"estimator": usual}
    if asked is None or asked.name not in engine_tallies(run):
        return found
    try:
        asked.check(run.scene)
    except SceneError:
        return found
    advice = f"a run with {' '.join(option_of(asked))} makes it more accurate"
    return {**found, "note": f"by {usual}; {lacks or advice}"}
