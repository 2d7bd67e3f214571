"""The engines that could run a scene, each with bounds on its errors from theory.

A bound is relative and names what makes the error: the model (pairs drawn in cells instead of pairs that
touch) or the discretisation (time step, cells).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gaspart import theory
from gaspart.analysis.observables import OBSERVABLES, require_told
from gaspart.engines import DSMC, Engine, EventDriven, TimeStepped
from gaspart.engines.dsmc.rates import contact_values, rates
from gaspart.engines.step.limits import missed_contacts
from gaspart.errors import SceneError
from gaspart.scene.faces import sliding_faces
from gaspart.scene.scene import Scene
from gaspart.state.initial import initial_state
from gaspart.tradeoff.models import cell_loss
from gaspart.tradeoff.target import SEED, Target

_STATIC = 3e-3
"""Bound on the error of the Enskog model in Z, the collision rate and pressures (figure
`dsmc_convergence`)."""
_DENSEST = 0.4
"""Packing fraction up to which that is known."""
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


def candidates(target: Target, accuracy: float) -> tuple[list[Candidate], dict[str, str]]:
    """The engines that model a scene, the event-driven one first, and why each other does not. accuracy: of
    the observable, for which time steps are chosen."""
    scene, observable = target.scene, target.observable
    makers = {"event": _event, "step": _step, "dsmc": _boltzmann, "dsmc enskog": _enskog}
    made, refused = [], {}
    for name, maker in makers.items():
        try:
            one = maker(target, accuracy)
            one.engine.check_features(scene)
            require_told(observable, scene, one.engine)
            made.append(one)
        except SceneError as error:
            refused[name] = f"{error.key}: {error.rule}"
    return made, refused


def _event(target: Target, accuracy: float) -> Candidate:
    return Candidate(EventDriven())


def _step(target: Target, accuracy: float) -> Candidate:
    TimeStepped(1.0).check_features(target.scene)
    missed = missed_contacts(1.0, True, target.start or initial_state(target.scene, SEED))
    met = rates(target.scene, dense=True).frequency
    if not missed > 0.0 or not met > 0.0:
        raise SceneError("time_step", None, "follows from contacts, which particles at rest do not have")
    longest = min(math.sqrt(_SHARE * accuracy / (_SAFE * missed)), _LONGEST_STEP / met)
    step = float(f"{0.95 * longest:.2g}")  # not above the longest, however it is rounded
    return Candidate(TimeStepped(step), discretisation=_SAFE * missed * step**2, gives_up="exact contacts")


def _boltzmann(target: Target, accuracy: float) -> Candidate:
    """Pairs in a cell collide as if they were points: without the excluded volume."""
    scene, observable = target.scene, target.observable
    engine, model = DSMC(), boltzmann_error(scene)
    gives_up = "excluded volume, positions of pairs"
    return Candidate(engine, model, _discretisation(engine, scene, observable), gives_up)


def _enskog(target: Target, accuracy: float) -> Candidate:
    """Pairs collide a diameter apart, with the contact value of their density."""
    scene, observable = target.scene, target.observable
    filled = scene.packing_fraction
    if filled > _DENSEST:
        rule = f"the Enskog model is known up to {_DENSEST:g}"
        raise SceneError("packing_fraction", round(filled, 4), rule)
    engine, model = DSMC(model="enskog"), enskog_error(scene, observable)
    gives_up = "correlated collisions, positions of pairs"
    discretisation = _discretisation(engine, scene, observable) + cell_loss(engine, scene)
    return Candidate(engine, model, discretisation, gives_up)


def boltzmann_error(scene: Scene) -> float:
    """Bound on the relative error of the Boltzmann equation: what it lacks of the collision rate or of the
    pressure, whichever is more."""
    excess, virial = _excess(scene)
    return max(excess, virial / (1.0 + virial))


def enskog_error(scene: Scene, observable: str) -> float:
    """Bound on the relative error of the Enskog equation in an observable."""
    transported = OBSERVABLES[observable].memory or _flows(scene)
    return _STATIC + (_memory(scene.packing_fraction, scene.dimension) if transported else 0.0)


def _flows(scene: Scene) -> bool:
    """Whether something drives a flow of heat or of momentum, which transport coefficients govern."""
    hot = {getattr(face, "temperature", None) for face in scene.faces.values()} - {None}
    lost = scene.restitution is not None and scene.restitution.dissipative
    return len(hot) > 1 or lost or bool(sliding_faces(scene))


def _discretisation(engine: DSMC, scene: Scene, observable: str) -> float:
    """The error of cells and steps: in the viscosity, and in what depends on it. Rates and pressures of an
    even gas have none."""
    if not OBSERVABLES[observable].memory and not _flows(scene):
        return 0.0
    return engine.predictions(scene)["viscosity_error"]


def _excess(scene: Scene) -> tuple[float, float]:
    """(chi - 1, Z - 1) of a gas that fills the container evenly, chi the largest contact value."""
    kinds = [kind for kind in scene.kinds if kind.count]
    radius = np.array([kind.radius for kind in kinds])
    number = np.array([float(kind.count) for kind in kinds]) / scene.container.volume
    chi = float(contact_values(number, radius, scene.dimension).max())
    return chi - 1.0, 2.0 ** (scene.dimension - 1) * scene.packing_fraction * chi


def _memory(packing_fraction: float, dimension: int) -> float:
    """|D / Enskog's - 1| of spheres, by which correlated collisions change transport; of discs, whose
    coefficients grow with the size of the system, the same at this packing fraction, an estimate."""
    if packing_fraction <= 0.0:
        return 0.0
    return abs(float(theory.erpenbeck_wood_ratio(packing_fraction)) - 1.0)
