"""The engines that could run a scene, each with bounds on its errors from theory.

A bound is relative and names what makes the error: the model (pairs drawn in cells instead of pairs that
touch) or the discretisation (time step, cells).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from gaspart.accuracy.bounds import DENSEST, boltzmann_error, cell_error, enskog_error, require_resolved
from gaspart.accuracy.conditions import Conditions
from gaspart.accuracy.target import Target
from gaspart.analysis.observables import require_modelled
from gaspart.engines import DSMC, Engine, EventDriven, TimeStepped
from gaspart.engines.step.limits import missed_contacts
from gaspart.errors import SceneError
from gaspart.state.state import State

_SHARE = 0.125
"""Part of an accuracy that the contacts which time steps miss may take."""
_SAFE = 2.0
"""Error of a pressure or a rate over the part of contacts that are missed, at most."""
_LONGEST_STEP = 0.2
"""Of the mean time between a particle's collisions."""


@dataclass(frozen=True)
class Candidate:
    """An engine with its settings for a scene. model, discretisation: bounds on its relative errors;
    gives_up: what it does not have, in words."""

    engine: Engine
    model: float = 0.0
    discretisation: float = 0.0
    gives_up: str = "nothing"

    @property
    def name(self) -> str:
        """That of the engine, with its model if it is not the engine's own."""
        model = getattr(self.engine, "model", "")
        return f"{self.engine.name} {model}" if model == "enskog" else self.engine.name

    @property
    def bias(self) -> float:
        """The bound on its systematic error."""
        return self.model + self.discretisation


def suited(target: Target) -> tuple[list[str], dict[str, str]]:
    """The names of the engines that model a scene and an observable, the event-driven one first, and why each
    other does not."""
    made, refused = [], {}
    for name, (engine, _) in _ENGINES.items():
        try:
            engine.check_features(target.scene)
            require_modelled(target.observable, target.scene, engine)
            made.append(name)
        except SceneError as error:
            refused[name] = f"{error.key}: {error.rule}"
    return made, refused


def candidates(
    target: Target, accuracy: float, conditions: Conditions
) -> tuple[list[Candidate], dict[str, str]]:
    """The `suited` engines with their settings, and why each other is none. accuracy: of the observable, for
    which time steps are chosen; conditions: of the steady scene."""
    names, refused = suited(target)
    made = []
    for name in names:
        try:
            made.append(_ENGINES[name][1](target, accuracy, conditions))
        except SceneError as error:
            refused[name] = f"{error.key}: {error.rule}"
    return made, refused


def exact_candidate() -> Candidate:
    """The event-driven engine, which has no settings and no error."""
    return Candidate(EventDriven())


def _event(target: Target, accuracy: float, conditions: Conditions) -> Candidate:
    return exact_candidate()


def _step(target: Target, accuracy: float, conditions: Conditions) -> Candidate:
    missed = missed_contacts(1.0, True, _as_hot(target.initial, float(conditions.temperature.max())))
    free = float((conditions.path / np.maximum(conditions.speed, 1e-300)).min())
    if not missed > 0.0 or not math.isfinite(free):
        raise SceneError("time_step", None, "follows from contacts, which particles at rest do not have")
    longest = min(math.sqrt(_SHARE * accuracy / (_SAFE * missed)), _LONGEST_STEP * free)
    step = float(f"{0.95 * longest:.2g}")  # not above the longest, however it is rounded
    return Candidate(TimeStepped(step), discretisation=_SAFE * missed * step**2, gives_up="exact contacts")


def _as_hot(state: State, temperature: float) -> State:
    """A state whose particles have the mean squares of velocities at a temperature."""
    moving = np.isfinite(state.masses)
    mean = np.where(moving, np.sqrt(temperature / np.where(moving, state.masses, 1.0)), 0.0)
    return replace(state, velocities=np.repeat(mean[:, None], state.dimension, axis=1))


def _boltzmann(target: Target, accuracy: float, conditions: Conditions) -> Candidate:
    """Pairs in a cell collide as if they were points: without the excluded volume."""
    observable = target.observable
    engine = _resolved(DSMC(), target, conditions)
    model = boltzmann_error(conditions, observable, target.face)
    gives_up = "excluded volume, positions of pairs"
    return Candidate(DSMC(), model, cell_error(engine, conditions, observable), gives_up)


def _enskog(target: Target, accuracy: float, conditions: Conditions) -> Candidate:
    """Pairs collide a diameter apart, with the contact value of their density."""
    observable, filled = target.observable, float(conditions.filled.max())
    if filled > DENSEST:
        rule = f"the Enskog model is known up to {DENSEST:g}, also where the gas is densest"
        raise SceneError("packing_fraction", round(filled, 4), rule)
    engine = _resolved(DSMC(model="enskog"), target, conditions)
    cells = tuple(np.broadcast_to(np.array(engine.cells_per_side), conditions.free.shape).tolist())
    model = enskog_error(conditions, observable, cells)
    gives_up = "correlated collisions, positions of pairs"
    return Candidate(DSMC(model="enskog"), model, cell_error(engine, conditions, observable), gives_up)


def _resolved(engine: DSMC, target: Target, conditions: Conditions) -> DSMC:
    """With its cells and step. Raises SceneError where these are too coarse for the local conditions."""
    resolved = engine.resolved(target.scene)
    require_resolved(resolved, conditions)
    return resolved


_Maker = Callable[[Target, float, Conditions], Candidate]
_ENGINES: dict[str, tuple[Engine, _Maker]] = {
    "event": (EventDriven(), _event),
    "step": (TimeStepped(1.0), _step),
    "dsmc": (DSMC(), _boltzmann),
    "dsmc enskog": (DSMC(model="enskog"), _enskog),
}
