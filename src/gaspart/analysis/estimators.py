"""How an observable was estimated, and what a run must keep for a better estimate."""

from __future__ import annotations

import json

from gaspart.analysis.run import Run
from gaspart.engines import ENGINES, Engine
from gaspart.errors import SceneError
from gaspart.scene.impulses import shares_energy_evenly
from gaspart.scene.scene import Scene
from gaspart.state.optional_tallies import OptionalTally, option_of


def engine_class(run: Run) -> type[Engine]:
    """The engine of a run; the base of all, which can do nothing, of a file that does not state it."""
    return ENGINES.get(json.loads(run.data.attrs.get("engine", "{}")).get("name"), Engine)


def engine_tallies(run: Run) -> frozenset[str]:
    """The names of the optional tallies that the engine of a run can make."""
    return engine_class(run).tallies


def knows_energies(engine: Engine | type[Engine], scene: Scene) -> bool:
    """Whether the mean energy of motion along each axis is known exactly: by an engine without a systematic
    error, of a scene that shares it evenly. Steps take some from that across a wall, near it."""
    return engine.reference and shares_energy_evenly(scene)


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
