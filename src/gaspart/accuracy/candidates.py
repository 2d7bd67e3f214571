"""The engines that could run a scene, each with bounds on its errors from theory, which it states itself.

A bound is relative and names what makes the error: the model (pairs drawn in cells instead of pairs that
touch) or the discretisation (time step, cells).
"""

from __future__ import annotations

from gaspart.accuracy.conditions import Conditions
from gaspart.accuracy.target import Target
from gaspart.analysis.observables import OBSERVABLES, require_modelled
from gaspart.engines import Engine, offered
from gaspart.engines.asked import Asked, Candidate
from gaspart.errors import SceneError
from gaspart.scene.scene import Scene


def suited(target: Target) -> tuple[list[Engine], dict[str, str]]:
    """The engines that model a scene and an observable, the reference first, and why each other does not, by
    its name in the table."""
    made, refused = [], {}
    for engine in offered():
        try:
            engine.check_features(target.scene)
            require_modelled(target.observable, target.scene, engine)
            made.append(engine)
        except SceneError as error:
            refused[engine.timed_as] = f"{error.key}: {error.rule}"
    return made, refused


def candidates(
    target: Target, accuracy: float, conditions: Conditions
) -> tuple[list[Candidate], dict[str, str]]:
    """The `suited` engines with their settings, and why each other is none. accuracy: of the observable, for
    which time steps are chosen; conditions: of the steady scene."""
    engines, refused = suited(target)
    asked, made = asked_of(target, accuracy, conditions), []
    for engine in engines:
        try:
            made.append(engine.candidate(asked))
        except SceneError as error:
            refused[engine.timed_as] = f"{error.key}: {error.rule}"
    return made, refused


def asked_of(target: Target, accuracy: float, conditions: Conditions) -> Asked:
    """What engines are asked for."""
    governed = transported(target.scene, target.observable)
    presses = target.declared.of_impulses  # a force has the relative errors of a pressure
    observable = "pressure" if presses else target.observable
    return Asked(observable, accuracy, conditions, target.face, governed, target.initial)


def transported(scene: Scene, observable: str) -> bool:
    """Whether transport coefficients govern an observable: those of lags, and any where something drives a
    flow of heat or of momentum."""
    lost = scene.dissipates
    flows = len(scene.face_temperatures) > 1 or lost or bool(scene.sliding_faces)
    return OBSERVABLES[observable].memory or flows
