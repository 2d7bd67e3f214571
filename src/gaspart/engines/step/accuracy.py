"""The time step for an accuracy, and the bound on its error: contacts that a step misses."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gaspart.engines.asked import Asked, Candidate
from gaspart.engines.step.limits import missed_contacts
from gaspart.errors import SceneError
from gaspart.state.state import State

if TYPE_CHECKING:
    from gaspart.engines.step.settings import TimeStepped

_SHARE = 0.125
"""Part of an accuracy that the contacts which time steps miss may take."""
_SAFE = 2.0
"""Error of a pressure or a rate over the part of contacts that are missed, at most."""
_LONGEST = 0.2
"""Of the mean time between a particle's collisions."""


def candidate(engine: TimeStepped, asked: Asked) -> Candidate:
    """The engine with the longest step that is accurate enough. Raises SceneError for a gas in which nothing
    collides."""
    conditions, initial = asked.conditions, asked.initial
    hot = _as_hot(initial, float(conditions.temperature.max())) if initial else None
    missed = missed_contacts(1.0, True, hot) if hot else 0.0
    free = float((conditions.path / np.maximum(conditions.speed, 1e-300)).min())
    if not missed > 0.0 or not math.isfinite(free):
        raise SceneError("time_step", None, "follows from contacts, which particles at rest do not have")
    longest = min(math.sqrt(_SHARE * asked.accuracy / (_SAFE * missed)), _LONGEST * free)
    step = float(f"{0.95 * longest:.2g}")  # not above the longest, however it is rounded
    return Candidate(engine.with_step(step), discretisation=_SAFE * missed * step**2)


def _as_hot(state: State, temperature: float) -> State:
    """A state whose particles have the mean squares of velocities at a temperature."""
    moving = np.isfinite(state.masses)
    mean = np.where(moving, np.sqrt(temperature / np.where(moving, state.masses, 1.0)), 0.0)
    return replace(state, velocities=np.repeat(mean[:, None], state.dimension, axis=1))
