"""Adviser of the time-stepped engine: the longest step for an accuracy, and a bound on its error."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import ClassVar

import numpy as np

from gaspart.accuracy.of_engine import AccuracyRequest, Adviser, Candidate
from gaspart.engines.step.engine import TimeStepped
from gaspart.engines.step.limits import LATER, at_walls, contacts_per_step, rate_error
from gaspart.errors import SceneError
from gaspart.scene.facts import plain_gas
from gaspart.scene.scene import Scene
from gaspart.state.state import State

_SHARE = 0.125
"""Maximum error due to missed contacts, as a fraction of the requested accuracy."""
_LONGEST = 0.2
"""Longest step, as a fraction of the mean time between collisions of a particle."""
_AT_WALLS = ("pressure", "force", "heat_flux", "wall_shear", "density")
"""Observables at walls, where a wall hit is processed before all collisions of its step."""


class StepAdviser(Adviser[TimeStepped]):
    """Adviser of the time-stepped engine."""

    timed_at: ClassVar[tuple[float, float]] = (0.1, 0.08)
    advised: ClassVar[tuple[str, ...]] = ("time_step", "precision")
    pairs: ClassVar[str] = "none: a neighbour list"
    limitations = "exact contacts"  # contacts that begin and end within a step are missed

    @staticmethod
    def variants(kind: type[TimeStepped]) -> tuple[TimeStepped, ...]:
        return (kind(1.0),)

    def candidate(self, request: AccuracyRequest) -> Candidate:
        conditions, initial = request.conditions, request.initial
        hot = _as_hot(initial, float(conditions.temperature.max())) if initial else None
        square = rate_error(1.0, True, hot) if hot else 0.0
        free = float((conditions.path / np.maximum(conditions.speed, 1e-300)).min())
        if not square > 0.0 or not math.isfinite(free):
            raise SceneError("time_step", None, "follows from contacts, which particles at rest do not have")
        assert hot is not None
        linear = 0.0
        if request.observable in _AT_WALLS:
            at_face = LATER if request.observable == "density" else at_walls(request.scene)
            linear = at_face * contacts_per_step(1.0, hot)
        most = _SHARE * request.accuracy
        longest = min(2.0 * most / (linear + math.sqrt(linear**2 + 4.0 * square * most)), _LONGEST * free)
        step = float(f"{0.95 * longest:.2g}")  # never above the longest step, for any rounding
        return Candidate(self.engine.with_step(step), discretisation=(linear + square * step) * step)

    def timed_step(self, scene: Scene) -> float:
        return self.engine.time_step / _unit(scene)

    def at_step(self, scene: Scene, step: float, precision: str) -> TimeStepped:
        return replace(self.engine, time_step=step * _unit(scene), precision=precision)

    def describe(self) -> str:
        engine = self.engine
        return f"{engine.name}, time_step {engine.time_step:.4g}, {engine.precision}, {engine.passes} passes"


def _unit(scene: Scene) -> float:
    """Return the time to cross a diameter at the thermal speed of a plain gas."""
    gas = plain_gas(scene)
    return gas.diameter / gas.thermal_speed


def _as_hot(state: State, temperature: float) -> State:
    """Return a state in which each velocity component of a moving particle is sqrt(kT/m)."""
    moving = np.isfinite(state.masses)
    mean = np.where(moving, np.sqrt(temperature / np.where(moving, state.masses, 1.0)), 0.0)
    return replace(state, velocities=np.repeat(mean[:, None], state.dimension, axis=1))
