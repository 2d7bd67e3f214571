"""Bounds on the errors of the DSMC engine in a steady scene, from its local conditions.

The Boltzmann model lacks the excluded volume: in the contact value, in the virial, and in contacts, which
have no extent. The Enskog model is given the contact value of the local density; what it does not have is the
memory of collisions, that of a pair among few particles, and the layers of particles at a wall. Cells average
over what changes within them.
"""

from __future__ import annotations

import math

import numpy as np

from gaspart import theory
from gaspart.accuracy.column import Column
from gaspart.accuracy.conditions import Conditions
from gaspart.accuracy.models import cell_loss
from gaspart.accuracy.steady import face_temperatures
from gaspart.analysis.observables import OBSERVABLES
from gaspart.engines import DSMC
from gaspart.errors import SceneError
from gaspart.scene.faces import sliding_faces
from gaspart.scene.scene import Scene

DENSEST = 0.4
"""Packing fraction up to which the Enskog model is known."""
_STATIC = 3e-3
"""Bound on its error in Z, the collision rate and pressures of an even gas (figure `dsmc_convergence`)."""
_NORMAL = {2: 2.0 / math.pi, 3: 0.5}
"""Mean of |e_z| of a contact, by dimension."""
_AT_WALLS = 2.5
"""Error of the Enskog model's collision rate over the packing fraction and the diameter over the distance of
two walls: 2.1 at most in slits of 4, 8 and 16 diameters, at packing fractions of 0.05 to 0.3."""
_ON_PROFILES = 2.0
"""What cells change in the collision rate of the Enskog model over that of the Boltzmann model, at most: the
contact value too is that of the mean density."""


def boltzmann_error(conditions: Conditions, observable: str, face: str | None = None) -> float:
    """Bound on the relative error of the Boltzmann equation in an observable; face: of the pressure."""
    scene = conditions.scene
    memory = _memory(conditions) if _transported(scene, observable) else 0.0
    error = memory + _layers(conditions, observable)
    if observable != "pressure":
        lost = _NORMAL[scene.dimension] * conditions.surfaces
        error += lost / (1.0 - lost) if lost < 1.0 else math.inf
    few = float((conditions.contact_of_few / conditions.contact).max()) - 1.0
    if conditions.columns:
        return float(error + few + _between(*conditions.columns, observable, _top(conditions, face)))
    virial = float(conditions.virial.max())
    if math.isinf(virial):
        return math.inf
    excess = float(conditions.contact_of_few.max()) - 1.0
    return float(error + max(excess, virial if scene.gravity else virial / (1.0 + virial)))


def enskog_error(conditions: Conditions, observable: str, cells: tuple[int, ...] | None = None) -> float:
    """Bound on the relative error of the Enskog equation in an observable; cells: along each axis, by default
    narrow ones."""
    scene, error = conditions.scene, _STATIC + _layers(conditions, observable)
    if _transported(scene, observable):
        error += _memory(conditions)
    error += float((conditions.contact_of_few / conditions.contact).max()) - 1.0
    error += _AT_WALLS * float(conditions.filled.max()) * conditions.surfaces
    if observable == "pressure" and cells is not None:
        virial = float(conditions.virial.max())
        walled = [n for n, around in zip(cells, scene.container.periodic, strict=True) if not around]
        error += sum(virial / (1.0 + virial) / n for n in walled)
    return float(error)


def cell_error(engine: DSMC, conditions: Conditions, observable: str) -> float:
    """Bound on what cells and steps change: in the viscosity, and in what depends on it, by the shortest free
    path; in a rate by the mean over a cell, of a density that changes by e over the scale; in the Enskog
    model by the collisions that are lost among few in a cell."""
    scene, error = conditions.scene, 0.0
    if _transported(scene, observable):
        error += engine.predictions(scene)["viscosity_error"] * conditions.contrast**2
    dense = engine.model == "enskog"
    if conditions.axis is not None:
        widths = cell_widths(engine, conditions)
        half = 0.5 * widths[conditions.axis] / conditions.scale
        averaged = 1.0 - math.tanh(half) / half if half > 1e-6 else 0.0
        error += averaged * (_ON_PROFILES if dense else 1.0)
    return float(error + (_lost(engine, conditions) if dense else 0.0))


def require_resolved(engine: DSMC, conditions: Conditions) -> None:
    """Raise SceneError for cells or steps that are longer than a length or a time over which an uneven gas
    changes, or than its shortest free path or time. What an even gas is like does not depend on them."""
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
            what = "cells are" if key == "cells_per_side" else "particles move" if size is moved else "is"
            raise SceneError(key, value, f"{what} {size:.2g}, more than {limit:.2g}, {name}")


def cell_widths(engine: DSMC, conditions: Conditions) -> np.ndarray:
    """(d,) the sides of a cell, 0 along an axis that has one cell between periodic faces and no profile."""
    cells = np.broadcast_to(np.array(engine.cells_per_side or 1), conditions.free.shape)
    around = np.array(conditions.scene.container.periodic)
    flat = (cells == 1) & around
    if conditions.axis is not None:
        flat[conditions.axis] = False
    return np.where(flat, 0.0, conditions.free / cells)


def _transported(scene: Scene, observable: str) -> bool:
    """Whether transport coefficients govern an observable: those of lags, and any where something drives a
    flow of heat or of momentum."""
    lost = scene.restitution is not None and scene.restitution.dissipative
    flows = len(face_temperatures(scene)) > 1 or lost or bool(sliding_faces(scene))
    return OBSERVABLES[observable].memory or flows


def _memory(conditions: Conditions) -> float:
    """|D / Enskog's - 1| of spheres, by which correlated collisions change transport; of discs, whose
    coefficients grow with the size of the system, the same at this packing fraction, an estimate."""
    densest = min(float(conditions.filled.max()), theory.ERPENBECK_WOOD_HIGHEST)
    return abs(float(theory.erpenbeck_wood_ratio(densest)) - 1.0) if densest > 0.0 else 0.0


def _layers(conditions: Conditions, observable: str) -> float:
    """What the layers of particles at walls are of a density: they have Z times the density of the middle, in
    about a diameter."""
    if observable != "density" or conditions.scene.container.periodic[-1]:
        return 0.0
    sigma, free = 2.0 * conditions.scene.largest_radius, float(conditions.free[-1])
    length = min(free, conditions.scale) if conditions.axis == conditions.scene.dimension - 1 else free
    return float(conditions.virial.max()) * math.sqrt(sigma / max(length, sigma))


def _top(conditions: Conditions, face: str | None) -> bool | None:
    """Whether a face of the container is at the top of a column, None of any that is not across it."""
    scene, axis = conditions.scene, conditions.axis
    if face is None or axis is None or face[0] != "xyz"[axis] or scene.gravity is None:
        return None
    return (scene.gravity[axis] < 0.0) == face.endswith("high")


def _between(real: Column, ideal: Column, observable: str, top: bool | None) -> float:
    """By how much a column of points differs from one of particles, relatively."""
    differences = {
        "collision_rate": abs(ideal.collisions / real.collisions - 1.0),
        "temperature": abs(ideal.temperature / real.temperature - 1.0),
        "density": _of_profiles(real, ideal),
    }
    if observable == "pressure" and top is not None:
        exact = real.pressure(top)
        return abs(ideal.pressure(top) / exact - 1.0) if exact > 0.0 else math.inf
    return differences.get(observable, max(differences.values()))


def _of_profiles(real: Column, ideal: Column) -> float:
    """Root mean square of the difference of two densities over that of the first."""
    exact = real.numbers.sum(axis=0)
    other = np.interp(real.heights, ideal.heights, ideal.numbers.sum(axis=0), right=0.0)
    return float(np.sqrt(((other - exact) ** 2).sum() / (exact**2).sum()))


def _lost(engine: DSMC, conditions: Conditions) -> float:
    """`cell_loss` where fewer particles are in a cell than in the mean, weighted by collisions."""
    weights = conditions.share * conditions.contact
    fewer = float(weights.sum() / (weights * conditions.crowding).sum())
    return cell_loss(engine, conditions.scene) * fewer
