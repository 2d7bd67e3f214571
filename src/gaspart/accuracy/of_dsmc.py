"""Adviser of the DSMC engine: bounds on its errors in a steady scene, from local conditions.

The Boltzmann model neglects the excluded volume: it sets the contact value to 1, and the virial and the
distance between collision partners to 0. The Enskog model uses the contact value at the local density. It
neglects correlations between collisions, the effect of a finite number of particles on the contact value, and
the layers of particles at walls. Both models average over the variations of the gas within a cell.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import ClassVar

import numpy as np

from gaspart.accuracy.of_engine import AccuracyRequest, Adviser, Candidate
from gaspart.engines.dsmc.engine import DSMC
from gaspart.engines.dsmc.settings import MODELS
from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.theory.conditions import Conditions

DENSEST = 0.4
"""Maximum packing fraction up to which the errors of the Enskog model are known."""
_STATIC = 3e-3
"""Bound on the error of the Enskog model in Z, the collision rate and the pressures of a homogeneous gas
(`dsmc_convergence`).
"""
_NORMAL = {2: 2.0 / math.pi, 3: 0.5}
"""Mean of |e_z| for the unit vector e of a contact, by dimension."""
_AT_WALLS = 2.5
"""Error of the Enskog model's collision rate between two walls, divided by a product.

This product is the packing fraction times the ratio of the diameter to the distance between the walls. The
largest measured value is 2.1, in slits of 4, 8 and 16 diameters at packing fractions of 0.05 to 0.3.
"""
_ON_PROFILES = 2.0
"""Maximum error of collision rates due to cells in the Enskog model, divided by the Boltzmann model's error.

The error is larger in the Enskog model, because it also evaluates the contact value at the mean density of a
cell.
"""


class DsmcAdviser(Adviser[DSMC]):
    """Adviser of the DSMC engine."""

    timed_at: ClassVar[tuple[float, float]] = (0.01, 1.0)
    advised: ClassVar[tuple[str, ...]] = ("model",)
    pairs: ClassVar[str] = "cells, whose particles collide by chance: positions of pairs are given up"

    @staticmethod
    def variants(kind: type[DSMC]) -> tuple[DSMC, ...]:
        return tuple(kind(model=model) for model in MODELS)

    def candidate(self, request: AccuracyRequest) -> Candidate:
        """Return the engine with default cells and step and bounds on its errors; SceneError if it does not
        suit.
        """
        conditions, dense = request.conditions, self.engine.model == "enskog"
        filled = float(conditions.filled.max())
        if dense and filled > DENSEST:
            rule = f"the Enskog model is known up to {DENSEST:g}, also where the gas is densest"
            raise SceneError("packing_fraction", round(filled, 4), rule)
        resolved = self.engine.for_scene(request.scene)
        require_resolved(resolved, conditions)
        model = enskog_error(request, cells_of(resolved, conditions)) if dense else boltzmann_error(request)
        return Candidate(self.engine, model, cell_error(resolved, request))

    @property
    def timed_as(self) -> str:
        model = self.engine.model
        return self.engine.name if model == "boltzmann" else f"{self.engine.name} {model}"

    def timed_step(self, scene: Scene) -> float:
        return (self.engine.for_scene(scene).time_step or 0.0) / self._own_step(scene)

    def at_step(self, scene: Scene, step: float, precision: str) -> DSMC:
        return self.engine.for_scene(scene).with_step(step * self._own_step(scene))

    def _own_step(self, scene: Scene) -> float:
        return replace(self.engine, time_step=None).for_scene(scene).time_step or math.inf

    @property
    def limitations(self) -> str:
        lacks = {"boltzmann": "excluded volume", "enskog": "correlated collisions"}
        return f"{lacks[self.engine.model]}, positions of pairs"

    def describe(self) -> str:
        step = "" if self.engine.time_step is None else f", time_step {self.engine.time_step:.4g}"
        return f"{self.engine.name}, model {self.engine.model}{step}"

    def notes(self, scene: Scene, observable: str, paths: bool) -> dict[str, str]:
        remarks, step = super().notes(scene, observable, paths), self.engine.time_step
        longer = 1.0 if step is None else step / self._own_step(scene)
        if longer >= 1.5:
            effect = "which the bias includes" if paths else f"on which {observable} does not depend"
            remarks["time step"] = f"{longer:.2g} times the engine's own, {effect}"
        return remarks


def boltzmann_error(request: AccuracyRequest) -> float:
    """Bound the relative error of the Boltzmann equation, in which particles are points."""
    conditions, scene = request.conditions, request.scene
    error = (conditions.memory if request.transported else 0.0) + _layers(request)
    if request.observable != "pressure":
        lost = _NORMAL[scene.dimension] * conditions.surfaces
        error += lost / (1.0 - lost) if lost < 1.0 else math.inf
    few = float((conditions.contact_of_few / conditions.contact).max()) - 1.0
    points = conditions.of_points(request.observable, request.face)
    if points is not None:
        return float(error + few + points)
    virial = float(conditions.virial.max())
    if math.isinf(virial):
        return math.inf
    excess = float(conditions.contact_of_few.max()) - 1.0
    return float(error + max(excess, virial if scene.gravity else virial / (1.0 + virial)))


def enskog_error(request: AccuracyRequest, cells: tuple[int, ...] | None = None) -> float:
    """Bound the relative error of the Enskog equation. `cells`: number of cells along each axis. Default:
    cells so narrow that they cause no error.
    """
    conditions = request.conditions
    error = _STATIC + _layers(request)
    if request.transported:
        error += conditions.memory
    error += float((conditions.contact_of_few / conditions.contact).max()) - 1.0
    error += _AT_WALLS * float(conditions.filled.max()) * conditions.surfaces
    if request.observable == "pressure" and cells is not None:
        virial = float(conditions.virial.max())
        periodic = request.scene.container.periodic
        walled = [n for n, around in zip(cells, periodic, strict=True) if not around]
        error += sum(virial / (1.0 + virial) / n for n in walled)
    return float(error)


def cell_error(engine: DSMC, request: AccuracyRequest) -> float:
    """Bound the relative error due to cells and steps. The error of the viscosity, and of observables that
    depend on it, is computed for the shortest mean free path. The error of a rate is the error of averaging
    over a cell for a density that changes by a factor e over the shortest length scale. The fraction of
    repeated or lost collisions is added, which is smaller where cells contain more particles.
    """
    conditions, errors = request.conditions, engine.errors(request.scene)
    error = (errors.width + errors.step) * conditions.contrast**2 if request.transported else 0.0
    if conditions.axis is not None:
        half = 0.5 * cell_widths(engine, conditions)[conditions.axis] / conditions.scale
        averaged = 1.0 - math.tanh(half) / half if half > 1e-6 else 0.0
        error += averaged * (_ON_PROFILES if engine.model == "enskog" else 1.0)
    weights = conditions.share * conditions.contact
    fewer = float(weights.sum() / (weights * conditions.crowding).sum())
    return float(error + (errors.repeats if request.transported else errors.lost) * fewer)


def require_resolved(engine: DSMC, conditions: Conditions) -> None:
    """Raise SceneError if cells or steps are too coarse for an inhomogeneous gas. Cells and steps must not
    exceed the length or time over which the gas changes, the shortest mean free path, or the shortest mean
    free time.
    """
    if conditions.axis is None:
        return
    widths = cell_widths(engine, conditions)
    path, time = float(conditions.path.min()), float((conditions.path / conditions.speed).min())
    cells, step = engine.cells_per_side, engine.time_step or 0.0
    widest, along = float(widths.max()), float(widths[conditions.axis])
    moved = step * float(conditions.speed.max())
    scale = "the length over which the gas changes by e"
    for key, value, size, limit, name in (
        ("cells_per_side", cells, along, conditions.scale, scale),
        ("cells_per_side", cells, widest, path, "the shortest local free path"),
        ("time_step", step, moved, conditions.scale, scale),
        ("time_step", step, step, time, "the shortest local free time"),
    ):
        if size > limit:
            text = "cells are" if key == "cells_per_side" else "particles move" if size is moved else "is"
            raise SceneError(key, value, f"{text} {size:.2g}, more than {limit:.2g}, {name}")


def cell_widths(engine: DSMC, conditions: Conditions) -> np.ndarray:
    """Return the sides (d,) of a cell, 0 for an axis with periodic faces and a single cell."""
    cells = np.array(cells_of(engine, conditions))
    around = np.array(conditions.scene.container.periodic)
    flat = (cells == 1) & around
    if conditions.axis is not None:
        flat[conditions.axis] = False
    return np.where(flat, 0.0, conditions.free / cells)


def cells_of(engine: DSMC, conditions: Conditions) -> tuple[int, ...]:
    """Return the number of cells along each axis (d,); 1 if cells are not prescribed."""
    return tuple(np.broadcast_to(np.array(engine.cells_per_side or 1), conditions.free.shape).tolist())


def _layers(request: AccuracyRequest) -> float:
    """Return the relative error of a density by layers at walls, a diameter thick, Z times as dense."""
    conditions, scene = request.conditions, request.scene
    if request.observable != "density" or scene.container.periodic[-1]:
        return 0.0
    sigma, free = 2.0 * scene.largest_radius, float(conditions.free[-1])
    length = min(free, conditions.scale) if conditions.axis == scene.dimension - 1 else free
    return float(conditions.virial.max()) * math.sqrt(sigma / max(length, sigma))
